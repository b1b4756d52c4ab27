#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// Between two `mark`s, each `mark` of its own twice: as SQL and CSV take whatever a text holds.
[[nodiscard]] inline std::string in_quotes(std::string_view text, char mark = '"') {
    std::string out(1, mark);
    for (const char c : text) {
        out.append(c == mark ? 2 : 1, c);
    }
    return out + mark;
}

}  // namespace palpate
