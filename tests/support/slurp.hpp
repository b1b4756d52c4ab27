#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace palpate::tests {

/// All bytes of a file; none where there is no such file.
inline std::string slurp(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace palpate::tests
