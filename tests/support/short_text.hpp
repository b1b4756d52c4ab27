#pragma once

#include "protocols/library/shipped.hpp"
#include "tests/support/catch.hpp"

namespace palpate::tests {

/// A shipped protocol made short.
inline std::string short_text(std::string_view name,
                              const std::vector<std::pair<std::string, std::string>>& edits) {
    std::string text;
    for (const auto& shipped : protocols::shipped_protocols()) {
        if (shipped.name == name) {
            text = shipped.text;
        }
    }
    for (const auto& [from, to] : edits) {
        const std::size_t at = text.find(from);
        CAPTURE(from);
        REQUIRE(at != std::string::npos);
        text.replace(at, from.size(), to);
    }
    return text;
}

}  // namespace palpate::tests
