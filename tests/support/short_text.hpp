#pragma once

#include "protocols/file/protocol_file.hpp"
#include "protocols/library/shipped.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/slurp.hpp"

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
    return edited(std::move(text), edits);
}

/// Why this text is no protocol, or "accepted".
inline std::string refusal(const std::string& text) {
    try {
        static_cast<void>(protocols::parse_protocol(text, "p.toml"));
    } catch (const protocols::ProtocolError& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace palpate::tests
