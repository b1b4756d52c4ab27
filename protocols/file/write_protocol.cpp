#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "engine/base/sha256.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/file/object_tables.hpp"
#include "protocols/file/procedure_file.hpp"
#include "protocols/file/protocol_file.hpp"

namespace palpate::protocols {
namespace {

/// @param has  of a key, whether the record has it
template <class Record>
void append(
    std::string& text,
    std::string_view heading,
    const Record& record,
    const std::function<bool(const Key&)>& has = [](const Key&) { return true; }) {
    std::string lines;
    for (const Key& key : keys_of<Record>()) {
        lines += has(key) ? toml_lines({&key, 1}, &record) : "";
    }
    if (!lines.empty()) {
        text += fmt::format("\n{}\n{}", heading, lines);
    }
}

/// How tables follow each other; [prior] has keys of its own.
constexpr std::array<std::string_view, 8> kOrder{"procedure", "constant", "staircase",  "quest",
                                                 "model",     "stimuli",  "parameters", "prior"};

/// @param whole  the key takes an integer
std::string value_text(const Value& value, bool whole) {
    if (const auto* flag = std::get_if<bool>(&value.data)) {
        return *flag ? "true" : "false";
    }
    if (const auto* integer = std::get_if<std::int64_t>(&value.data)) {
        return whole ? fmt::format("{}", *integer) : toml_text(static_cast<double>(*integer), 1.0);
    }
    if (const auto* number = std::get_if<double>(&value.data)) {
        return toml_text(*number + 0.0, 1.0);
    }
    if (const auto* text = std::get_if<std::string>(&value.data)) {
        return toml_text(*text);
    }
    std::string text;
    if (const auto* array = std::get_if<Array>(&value.data)) {
        for (const Value& one : *array) {
            text += (text.empty() ? "" : ", ") + value_text(one, whole);
        }
        return '[' + text + ']';
    }
    if (const auto* table = std::get_if<Table>(&value.data)) {
        for (const std::string_view key : {"from", "to", "count", "step", "mean", "sd"}) {
            if (const Entry* entry = find(*table, key)) {
                text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", key,
                                    value_text(entry->value, key == "count"));
            }
        }
    }
    return "{ " + text + " }";
}

void append_given(std::string& text, std::string_view name, const Table& table) {
    for (const Key& key : procedure_keys(name)) {
        if (const Entry* entry = find(table, key.name)) {
            const bool whole = std::holds_alternative<Whole>(key.slot(nullptr));
            text += fmt::format("{} = {}\n", key.name, value_text(entry->value, whole));
        }
    }
}

/// The tables of a rule as a procedure file has them.
/// @param around  of a protocol: "procedure.", whose own heading stands already
std::string rule_text(const Table& file, std::string_view around = "") {
    std::string text;
    for (const std::string_view name : kOrder) {
        const Entry* entry = find(file, name);
        if (entry == nullptr) {
            continue;
        }
        if (const auto* table = std::get_if<Table>(&entry->value.data)) {
            const bool stands = !around.empty() && name == "procedure";
            text += stands ? "" : fmt::format("\n[{}{}]\n", around, name);
            append_given(text, name, *table);
        } else if (const auto* array = std::get_if<Array>(&entry->value.data)) {
            for (const Value& value : *array) {
                text += fmt::format("\n[[{}{}]]\n", around, name);
                append_given(text, name, std::get<Table>(value.data));
            }
        }
    }
    return text;
}

/// What is felt: the outline or surface, the objects and the frictions.
void append_objects(std::string& text, const Protocol& protocol) {
    if (protocol.surface) {
        append(text, "[surface]", *protocol.surface);
    } else {
        append(text, "[outline]", protocol.outline);
    }
    for (const ObjectSpec& object : protocol.objects) {
        const bool free = !object.segments.empty();
        append(text, "[[object]]", object,
               [free](const Key& key) { return !free || key.need != Need::two_curve; });
        text += segments_toml(object);
    }
    for (const FrictionSpec& friction : protocol.frictions) {
        const LawKeys* law = keys_of_law(friction.law);
        append(text, "[[friction]]", friction,
               [law](const Key& key) { return law == nullptr || law->reads(key); });
    }
}

using Entries = std::vector<std::pair<std::string, std::string>>;  // "friction.rough mu_d", "0.4"

/// All that a table says. Tables of a list are known by their name, else by their number.
/// @param called  what the table is; empty: the file
void add_entries(const Table& table, const std::string& called, Entries& entries) {
    for (const Entry& entry : table) {
        const std::string inner = called.empty() ? entry.key : called + '.' + entry.key;
        const auto* array = std::get_if<Array>(&entry.value.data);
        if (const auto* one = std::get_if<Table>(&entry.value.data)) {
            add_entries(*one, inner, entries);
        } else if (array != nullptr && !array->empty() &&
                   std::holds_alternative<Table>(array->front().data)) {
            for (std::size_t i = 0; i < array->size(); ++i) {
                const auto& item = std::get<Table>((*array)[i].data);
                const Entry* name = find(item, "name");
                add_entries(item,
                            fmt::format("{}.{}", inner,
                                        name == nullptr ? std::to_string(i + 1)
                                                        : std::get<std::string>(name->value.data)),
                            entries);
            }
        } else {
            entries.emplace_back(called.empty() ? entry.key : called + ' ' + entry.key,
                                 value_text(entry.value, true));
        }
    }
}

Entries entries_of(std::string_view text) {
    Entries entries;
    add_entries(parse_document(text, "study.protocol_toml"), "", entries);
    return entries;
}

}  // namespace

std::string procedure_text(const Table& file) {
    return fmt::format("format = {}\n", kProcedureFormat) + rule_text(file);
}

std::string to_toml(const Protocol& protocol) {
    std::string text = fmt::format("format = {}\n", kFormat);
    append(text, "[study]", protocol);
    append(text, "[apparatus]", protocol.apparatus);
    append_objects(text, protocol);
    append(text, "[safety]", protocol.safety);
    append(text, "[invalid]", protocol.invalid);
    append(text, "[exclusion]", protocol.exclusion);
    append(text, "[analysis]", protocol.analysis);
    if (protocol.procedure) {  // which decides all but the breaks
        text += fmt::format("\n[design]\nbreak_every = {}\n", protocol.design.break_every);
    } else {
        append(text, "[design]", protocol.design);
    }
    append(text, "[timing]", protocol.timing);
    append(text, "[response]", protocol.response);
    if (protocol.procedure) {
        append(text, "[procedure]", *protocol.procedure);
        text += rule_text(parse_document(protocol.procedure->rule.text, "procedure"), "procedure.");
        for (const RunSpec& run : protocol.runs) {
            append(text, "[[run]]", run);
        }
    }
    append(text, "[observer]", protocol.observer);
    append(text, "[masking]", protocol.masking);
    for (std::size_t i = 0; i < kLanguageCount; ++i) {
        append(text, fmt::format("[instructions.{}]", kLanguages[i]), protocol.instructions[i]);
    }
    return text;
}

std::string protocol_hash(const Protocol& protocol) {
    return sha256_hex(to_toml(protocol));
}

std::vector<std::string> differences(std::string_view there, std::string_view here) {
    const Entries before = entries_of(there);
    const Entries now = entries_of(here);
    const auto value_in = [](const Entries& all, const std::string& key) {
        const auto found = std::ranges::find(all, key, &Entries::value_type::first);
        return found == all.end() ? std::string() : found->second;
    };
    std::vector<std::string> found;
    for (const auto& [key, value] : before) {
        const std::string other = value_in(now, key);
        if (other.empty()) {
            found.push_back(fmt::format("{} {} there, nothing here", key, value));
        } else if (other != value) {
            found.push_back(fmt::format("{} {} there, {} here", key, value, other));
        }
    }
    for (const auto& [key, value] : now) {
        if (value_in(before, key).empty()) {
            found.push_back(fmt::format("{} nothing there, {} here", key, value));
        }
    }
    return found;
}

std::string differences_text(std::string_view there, std::string_view here) {
    constexpr std::size_t kShown = 6;
    std::vector<std::string> differ = differences(there, here);
    if (differ.size() > kShown) {
        const std::string more = fmt::format("and {} more", differ.size() - kShown);
        differ.resize(kShown);
        differ.push_back(more);
    }
    return fmt::format("{}", fmt::join(differ, "; "));
}

}  // namespace palpate::protocols
