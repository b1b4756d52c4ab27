#include <type_traits>

#include <fmt/format.h>

#include "engine/base/sha256.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/file/object_tables.hpp"
#include "protocols/file/procedure_tables.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/file/toml_text.hpp"

namespace palpate::protocols {
namespace {

std::string text_of(double si, double per_si) {
    return toml_text(si, per_si);
}
std::string text_of(const std::string& text, double /*per_si*/) {
    return toml_text(text);
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

template <class Enumeration>
requires std::is_enum_v<Enumeration> std::string text_of(Enumeration value, double /*per_si*/) {
    return toml_text(std::string(word_of(value)));
}

template <class Record>
void append(std::string& text,
            std::string_view heading,
            const Record& record,
            bool described = true) {
    text += fmt::format("\n{}\n", heading);
    for (const Key<Record>& key : keys_of<Record>()) {
        if (!described && (key.need == Need::gos || key.need == Need::gos_optional ||
                           key.need == Need::two_curve)) {
            continue;
        }
        if (left_out(key, record)) {
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
        append(text, "[[object]]", object, object.segments.empty());
        text += segments_toml(object);
    }
    for (const FrictionSpec& friction : protocol.frictions) {
        append(text, "[[friction]]", friction, friction.law != "frictionless");
    }
    if (protocol.safety != SafetySpec{}) {  // studies are older than this table: their hashes stay
        append(text, "[safety]", protocol.safety);
    }
    if (protocol.invalid != InvalidSpec{}) {
        append(text, "[invalid]", protocol.invalid);
    }
    if (protocol.exclusion != ExclusionSpec{}) {
        append(text, "[exclusion]", protocol.exclusion);
    }
    if (protocol.procedure) {  // which decides all but the breaks
        text += fmt::format("\n[design]\nbreak_every = {}\n", protocol.design.break_every);
    } else {
        append(text, "[design]", protocol.design);
    }
    append(text, "[timing]", protocol.timing);
    if (protocol.response != ResponseSpec{}) {
        append(text, "[response]", protocol.response);
    }
    if (protocol.procedure) {
        append(text, "[procedure]", *protocol.procedure);
        text += nested_in_protocol(protocol.procedure->rule);
        for (const RunSpec& run : protocol.runs) {
            append(text, "[[run]]", run);
        }
    }
    append(text, "[observer]", protocol.observer);
    if (protocol.masking != MaskingSpec{}) {
        append(text, "[masking]", protocol.masking);
    }
    for (std::size_t i = 0; i < kLanguageCount; ++i) {
        if (protocol.instructions[i] != InstructionTexts{}) {
            append(text, fmt::format("[instructions.{}]", kLanguages[i]), protocol.instructions[i]);
        }
    }
    return text;
}

std::string protocol_hash(const Protocol& protocol) {
    return sha256_hex(to_toml(protocol));
}

}  // namespace palpate::protocols
