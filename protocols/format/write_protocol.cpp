#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "protocols/design/sha256.hpp"
#include "protocols/format/keys.hpp"
#include "protocols/format/protocol_file.hpp"

namespace palpate::protocols {
namespace {

/// The shortest number y, in the file's unit, that the reader turns into `si` by y / per_si.
std::string text_of(double si, double per_si) {
    constexpr int kNeighbours = 2;  // si * per_si is at most one rounding away from y
    const double product = si * per_si;
    std::string best;
    double y = product;
    for (int i = 0; i < kNeighbours; ++i) {
        y = std::nextafter(y, -std::numeric_limits<double>::infinity());
    }
    for (int i = -kNeighbours; i <= kNeighbours; ++i) {
        const std::string text = fmt::format("{}", y + 0.0);
        if (y / per_si == si && (best.empty() || text.size() < best.size())) {
            best = text;
        }
        y = std::nextafter(y, std::numeric_limits<double>::infinity());
    }
    return best.empty() ? fmt::format("{}", product) : best;
}

std::string text_of(const std::string& text, double /*per_si*/) {
    std::string quoted = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            quoted += '\\';
            quoted += c;
        } else if (byte < 0x20 || byte == 0x7f) {
            quoted += fmt::format("\\u{:04x}", byte);
        } else {
            quoted += c;
        }
    }
    return quoted + '"';
}

std::string text_of(std::uint64_t value, double /*per_si*/) {
    return fmt::format("{}", value);
}
std::string text_of(bool value, double /*per_si*/) {
    return value ? "true" : "false";
}
std::string text_of(const engine::Vec2& value, double per_si) {
    return fmt::format("[{}, {}]", text_of(value.x, per_si), text_of(value.y, per_si));
}

template <class Record>
void append(std::string& text,
            std::string_view heading,
            const Record& record,
            bool coefficients = true) {
    text += fmt::format("\n{}\n", heading);
    for (const Key<Record>& key : keys_of<Record>()) {
        if (!coefficients && (key.need == Need::gos || key.need == Need::gos_optional)) {
            continue;
        }
        const std::string value = std::visit(
            [&](auto member) { return text_of(record.*member, key.per_si); }, key.member);
        text += fmt::format("{} = {}\n", key.name, value);
    }
}

}  // namespace

std::string to_toml(const Protocol& protocol) {
    std::string text = fmt::format("format = {}\n", kFormat);
    append(text, "[study]", protocol);
    append(text, "[apparatus]", protocol.apparatus);
    append(text, "[outline]", protocol.outline);
    for (const ObjectSpec& object : protocol.objects) {
        append(text, "[[object]]", object);
    }
    for (const FrictionSpec& friction : protocol.frictions) {
        append(text, "[[friction]]", friction, friction.law != "frictionless");
    }
    if (protocol.safety != SafetySpec{}) {  // studies are older than this table: their hashes stay
        append(text, "[safety]", protocol.safety);
    }
    append(text, "[design]", protocol.design);
    append(text, "[timing]", protocol.timing);
    append(text, "[observer]", protocol.observer);
    return text;
}

std::string protocol_hash(const Protocol& protocol) {
    return sha256_hex(to_toml(protocol));
}

}  // namespace palpate::protocols
