#include "protocols/file/section.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "protocols/psychometric/exact_math.hpp"

namespace palpate::protocols {
namespace {

constexpr std::string_view kAxisForms =
    "a number, a list, { from, to, count } or { from, to, step }";
constexpr double kMostValues = 100'000.0;

bool is_name(std::string_view text) {
    return !text.empty() && text.size() <= 64 && std::all_of(text.begin(), text.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
}

bool is_text(std::string_view text) {
    return text.size() <= 200 && std::all_of(text.begin(), text.end(), [](char c) {
               return static_cast<unsigned char>(c) >= 0x20 && c != 0x7f;
           });
}

}  // namespace

const Entry* Section::find(std::string_view name) const {
    const auto entry = std::find_if(table_->begin(), table_->end(),
                                    [name](const Entry& e) { return e.key == name; });
    return entry == table_->end() ? nullptr : &*entry;
}

const ProcedureKey& Section::row(std::string_view name) const {
    for (const ProcedureKey& key : procedure_keys()) {
        if (key.table == key_ && key.name == name) {
            return key;
        }
    }
    throw std::logic_error(fmt::format("there is no row for {}.{}", key_, name));
}

void Section::refuse(std::string_view name, std::string what) {
    const Entry* entry = find(name);
    broken_ = true;
    problems_->add(entry == nullptr ? at_ : entry->value.at, std::move(what));
}

void Section::wrong_kind(const Entry& entry, std::string_view wanted) {
    refuse(entry.key, fmt::format("{} is {}, {}: give {}", entry.key, shown(entry.value),
                                  kind_of(entry.value), wanted));
}

double Section::number(std::string_view name) {
    const ProcedureKey& key = row(name);
    return key.required ? view_.required_number(name, key.range)
                        : view_.number(name, key.range, key.otherwise.value_or(0.0));
}

std::optional<double> Section::number_if(std::string_view name) {
    return has(name) ? std::optional(number(name)) : std::nullopt;
}

std::size_t Section::count(std::string_view name) {
    const ProcedureKey& key = row(name);
    return static_cast<std::size_t>(
        view_.integer(name, key.range, static_cast<std::int64_t>(key.otherwise.value_or(0.0))));
}

std::uint64_t Section::seed(std::string_view name) {
    const Entry* entry = find(name);
    if (entry == nullptr) {
        return 0;
    }
    const auto* value = std::get_if<std::int64_t>(&entry->value.data);
    if (value == nullptr || *value < 0) {
        wrong_kind(*entry, "an integer from 0 to 9223372036854775807");
        return 0;
    }
    return static_cast<std::uint64_t>(*value);
}

bool Section::flag(std::string_view name) {
    const Entry* entry = find(name);
    if (entry == nullptr) {
        return row(name).otherwise.value_or(0.0) != 0.0;
    }
    const auto* value = std::get_if<bool>(&entry->value.data);
    if (value == nullptr) {
        wrong_kind(*entry, "true or false");
        return false;
    }
    return *value;
}

std::size_t Section::word(std::string_view name) {
    const ProcedureKey& key = row(name);
    return view_.choice(
        name, key.words,
        key.otherwise ? std::optional(static_cast<std::size_t>(*key.otherwise)) : std::nullopt);
}

std::string Section::text(std::string_view name) {
    const Entry* entry = find(name);
    if (entry == nullptr) {
        return {};
    }
    const bool strict = row(name).kind == KeyKind::name;
    const auto* value = std::get_if<std::string>(&entry->value.data);
    if (value == nullptr || !(strict ? is_name(*value) : is_text(*value))) {
        wrong_kind(*entry, strict ? "1 to 64 letters a-z, digits and _, in quotes"
                                  : "up to 200 printable characters in quotes");
        return {};
    }
    return *value;
}

std::vector<std::string> Section::names(std::string_view name) {
    std::vector<std::string> names;
    const Entry* entry = find(name);
    if (entry == nullptr) {
        return names;
    }
    const auto* array = std::get_if<Array>(&entry->value.data);
    if (array == nullptr) {
        wrong_kind(*entry, "a list of names");
        return names;
    }
    for (const Value& value : *array) {
        const auto* text = std::get_if<std::string>(&value.data);
        if (text == nullptr || !is_name(*text)) {
            broken_ = true;
            problems_->add(value.at,
                           fmt::format("{} holds {}: give names in quotes", name, shown(value)));
            continue;
        }
        names.push_back(*text);
    }
    return names;
}

void Section::check_range(const Entry& entry,
                          const std::vector<double>& values,
                          const Range& range) {
    for (const double value : values) {
        const bool low = range.above ? value > range.lowest : value >= range.lowest;
        if (!low || value > range.highest) {
            refuse(entry.key, fmt::format("{} holds {}: give numbers {}", entry.key, value,
                                          range_words(range)));
            return;
        }
    }
}

std::vector<double> Section::numbers(std::string_view name) {
    const ProcedureKey& key = row(name);
    const Entry* entry = find(name);
    if (entry == nullptr || std::holds_alternative<Array>(entry->value.data)) {
        std::vector<double> values =
            key.required ? view_.numbers(name) : view_.numbers_or_none(name);
        if (entry != nullptr) {
            check_range(*entry, values, key.range);
        }
        return values;
    }
    if (key.kind == KeyKind::numbers) {
        wrong_kind(*entry, "a list of numbers");
        return {};
    }
    return {view_.required_number(name, key.range)};
}

std::vector<double> Section::spread(const Entry& entry, const Table& table) {
    TableView view(table, entry.key, entry.value.at, *problems_);
    const double from = view.required_number("from", {});
    const double to = view.required_number("to", {});
    const bool by_step =
        std::any_of(table.begin(), table.end(), [](const Entry& e) { return e.key == "step"; });
    double count = 0.0;
    if (by_step) {
        count =
            std::round((to - from) / view.required_number("step", {.lowest = 0.0, .above = true}));
    } else {
        count = static_cast<double>(
                    view.required_integer("count", {.lowest = 1.0, .highest = kMostValues})) -
                1.0;
    }
    view.refuse_unknown();
    if (view.broken()) {
        broken_ = true;
        return {};
    }
    if (!(to >= from) || !(count < kMostValues) || (count == 0.0) != (to == from)) {
        refuse(entry.key,
               fmt::format("{} goes from {} to {} in {} steps: give from < to and a step or "
                           "count that fits, at most {} values",
                           entry.key, from, to, count, kMostValues));
        return {};
    }
    if (by_step) {
        const double step = view.required_number("step", {});
        if (std::fabs((to - from) / step - count) > 1e-6) {
            refuse(entry.key,
                   fmt::format("{} goes from {} to {} by {}, which does not end there: give "
                               "another step, or a count",
                               entry.key, from, to, step));
        }
    }
    return evenly(from, to, static_cast<std::size_t>(count) + 1);
}

Axis Section::axis(std::string_view name) {
    const ProcedureKey& key = row(name);
    Axis axis{std::string(name), {}};
    const Entry* entry = find(name);
    if (entry == nullptr) {
        refuse(name, fmt::format("{} needs the key {}: add it ({})", shown_, name, kAxisForms));
        return axis;
    }
    const bool one = std::holds_alternative<double>(entry->value.data) ||
                     std::holds_alternative<std::int64_t>(entry->value.data);
    if (one) {
        axis.values = {view_.required_number(name, key.range)};
        return axis;
    }
    if (const auto* table = std::get_if<Table>(&entry->value.data)) {
        axis.values = spread(*entry, *table);
    } else if (std::holds_alternative<Array>(entry->value.data)) {
        axis.values = view_.numbers(name);
    } else {
        wrong_kind(*entry, kAxisForms);
        return axis;
    }
    check_range(*entry, axis.values, key.range);
    if (!broken() && axis.values.empty()) {
        refuse(name, fmt::format("{} has no values: give {}", name, kAxisForms));
    }
    return axis;
}

std::vector<double> Section::prior(const Axis& axis) {
    const Entry* entry = find(axis.name);
    if (entry == nullptr) {
        return {};
    }
    const auto* table = std::get_if<Table>(&entry->value.data);
    if (table == nullptr) {
        std::vector<double> weights = view_.numbers(axis.name);
        check_range(*entry, weights, {.lowest = 0.0});
        if (!broken() && weights.size() != axis.values.size()) {
            refuse(axis.name,
                   fmt::format("the prior of {} has {} weights: give {}, one for each value",
                               axis.name, weights.size(), axis.values.size()));
        }
        return weights;
    }
    TableView view(*table, entry->key, entry->value.at, *problems_);
    const double mean = view.required_number("mean", {});
    const double sd = view.required_number("sd", {.lowest = 0.0, .above = true});
    view.refuse_unknown();
    broken_ = broken_ || view.broken();
    std::vector<double> weights;
    for (const double value : axis.values) {
        const double z = (value - mean) / sd;
        weights.push_back(exponential(-0.5 * z * z));
    }
    return weights;
}

void Section::refuse_unknown(std::span<const std::string_view> known) {
    for (const Entry& entry : *table_) {
        if (std::find(known.begin(), known.end(), entry.key) == known.end()) {
            broken_ = true;
            problems_->add(entry.at, fmt::format("{} has no key {}{}", shown_, shown(entry.key),
                                                 suggestion(entry.key, known)));
        }
    }
}

void Section::refuse_unknown() {
    std::vector<std::string_view> known;
    for (const ProcedureKey& key : procedure_keys()) {
        if (key.table == key_) {
            known.push_back(key.name);
        }
    }
    refuse_unknown(known);
}

}  // namespace palpate::protocols
