#include <string_view>

#include "protocols/file/protocol_file.hpp"
#include "tests/fuzz/entries.hpp"
#include "tests/fuzz/law.hpp"

namespace palpate::fuzz {

void read_protocol(Bytes bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    protocols::Protocol protocol;
    try {
        protocol = protocols::parse_protocol(text, "fuzz.toml");
    } catch (const protocols::ProtocolError& refusal) {
        demand(*refusal.what() != '\0', "a refusal says why");
        return;
    }
    const std::string canonical = protocols::to_toml(protocol);
    demand(protocols::parse_protocol(canonical, "canonical.toml") == protocol,
           "the canonical text reads back as the same protocol");
}

}  // namespace palpate::fuzz
