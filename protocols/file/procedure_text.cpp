#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "protocols/file/procedure_keys.hpp"
#include "protocols/file/procedure_tables.hpp"
#include "protocols/file/toml_text.hpp"

namespace palpate::protocols {
namespace {

/// How tables follow each other; [prior] has keys of its own.
constexpr std::array<std::string_view, 8> kOrder{"procedure", "constant", "staircase",  "quest",
                                                 "model",     "stimuli",  "parameters", "prior"};

const Entry* find(const Table& table, std::string_view key) {
    const auto entry =
        std::find_if(table.begin(), table.end(), [key](const Entry& e) { return e.key == key; });
    return entry == table.end() ? nullptr : &*entry;
}

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

void append(std::string& text, std::string_view name, const Table& table) {
    for (const ProcedureKey& key : procedure_keys()) {
        // Parameters of a prior are named as those of the model.
        const bool of_table = key.table == name || (name == "prior" && key.table == "parameters");
        const Entry* entry = of_table ? find(table, key.name) : nullptr;
        if (entry != nullptr) {
            text += fmt::format("{} = {}\n", key.name,
                                value_text(entry->value, key.kind == KeyKind::integer));
        }
    }
}

}  // namespace

std::string procedure_text(const Table& file) {
    std::string text = fmt::format("format = {}\n", kProcedureFormat);
    for (const std::string_view name : kOrder) {
        const Entry* entry = find(file, name);
        if (entry == nullptr) {
            continue;
        }
        if (const auto* table = std::get_if<Table>(&entry->value.data)) {
            text += fmt::format("\n[{}]\n", name);
            append(text, name, *table);
        } else if (const auto* array = std::get_if<Array>(&entry->value.data)) {
            for (const Value& value : *array) {
                text += fmt::format("\n[[{}]]\n", name);
                append(text, name, std::get<Table>(value.data));
            }
        }
    }
    return text;
}

std::string nested_in_protocol(std::string_view procedure_text) {
    std::istringstream lines{std::string(procedure_text)};
    std::string text;
    bool begun = false;
    for (std::string line; std::getline(lines, line);) {
        if (line == "[procedure]") {
            begun = true;
            continue;
        }
        if (!begun) {
            continue;  // the format and the empty line after it
        }
        const std::size_t name = line.find_first_not_of('[');
        if (name != 0 && name != std::string::npos) {
            line.insert(name, "procedure.");
        }
        text += line + '\n';
    }
    return text;
}

}  // namespace palpate::protocols
