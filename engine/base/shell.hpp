#pragma once

#include <array>
#include <cstdio>
#include <string>
#include <utility>

namespace palpate {

/// What a command of the shell says on standard output, and how it ended, as waitpid() has it; < 0:
/// it could not be run. No word of it comes from outside unless it is quoted.
[[nodiscard]] inline std::pair<std::string, int> output_of(const std::string& command) {
    std::FILE* const pipe = popen(command.c_str(), "re");
    std::string out;
    std::array<char, 4096> buffer{};
    while (pipe != nullptr && std::feof(pipe) == 0 && std::ferror(pipe) == 0) {
        out.append(buffer.data(), std::fread(buffer.data(), 1, buffer.size(), pipe));
    }
    return {std::move(out), pipe == nullptr ? -1 : pclose(pipe)};
}

}  // namespace palpate
