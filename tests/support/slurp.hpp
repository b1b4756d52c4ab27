#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace palpate::tests {

/// All bytes of a file; none where there is no such file.
inline std::string slurp(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return std::move(text).str();
}

/// `text` with the first `from` replaced. @throws std::logic_error if it is not there
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    if (at == std::string::npos) {
        throw std::logic_error("not in the text: " + from);
    }
    return text.replace(at, from.size(), to);
}

}  // namespace palpate::tests
