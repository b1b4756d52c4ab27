#pragma once

#include "protocols/file/protocol_file.hpp"
#include "protocols/library/shipped.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/slurp.hpp"

namespace palpate::tests {

/// A shipped protocol made short.
inline std::string short_text(std::string_view name,
                              const std::vector<std::pair<std::string, std::string>>& edits = {}) {
    return edited(std::string(protocols::shipped_protocol(name).text), edits);
}

/// Why this text is no protocol, or "accepted".
inline std::string refusal(const std::string& text) {
    return refusal_of<protocols::ProtocolError>(
        [&] { return protocols::parse_protocol(text, "p.toml"); });
}

/// How a refusal begins that points at the first `at` of a text: "p.toml:LINE:COLUMN: ".
inline std::string place_of(const std::string& text, const std::string& at) {
    const std::size_t offset = text.find(at);
    REQUIRE(offset != std::string::npos);
    const auto before = text.begin() + static_cast<std::ptrdiff_t>(offset);
    const auto line = 1 + std::count(text.begin(), before, '\n');
    const std::size_t start = text.rfind('\n', offset);
    const std::size_t column = start == std::string::npos ? offset + 1 : offset - start;
    return fmt::format("p.toml:{}:{}: ", line, column);
}

}  // namespace palpate::tests
