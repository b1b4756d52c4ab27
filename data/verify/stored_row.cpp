#include "data/verify/stored_row.hpp"

#include <cmath>

#include <fmt/format.h>

namespace palpate::data {
namespace {

Value value_of(const Statement& row, int column) {
    switch (row.type(column)) {
        case 1:
            return row.integer(column);
        case 2:
            return row.real(column);
        case 5:
            return {};
        default:
            return row.text(column);
    }
}

template <class T>
T as(const Value& value) {
    const T* found = std::get_if<T>(&value);
    return found == nullptr ? T{} : *found;
}

}  // namespace

const Value& StoredRow::at(std::string_view column) const {
    static const Value none;
    const auto found = values_.find(column);
    return found == values_.end() ? none : found->second;
}

bool StoredRow::null(std::string_view column) const {
    return std::holds_alternative<std::monostate>(at(column));
}
std::int64_t StoredRow::integer(std::string_view column) const {
    return as<std::int64_t>(at(column));
}
double StoredRow::real(std::string_view column) const {
    return as<double>(at(column));
}
std::string StoredRow::text(std::string_view column) const {
    return as<std::string>(at(column));
}

std::vector<StoredRow> rows_of(Database& database,
                               std::string_view sql,
                               std::optional<std::int64_t> id) {
    std::vector<StoredRow> rows;
    for (const Statement& row : id ? database.prepare(sql, *id) : database.prepare(sql)) {
        StoredRow& stored = rows.emplace_back();
        for (int column = 0; column < row.columns(); ++column) {
            stored.set(row.name(column), value_of(row, column));
        }
    }
    return rows;
}

std::string to_text(const Value& value) {
    if (const auto* integer = std::get_if<std::int64_t>(&value)) {
        return fmt::format("{}", *integer);
    }
    if (const auto* real = std::get_if<double>(&value)) {
        return fmt::format("{}", *real);
    }
    if (const auto* text = std::get_if<std::string>(&value)) {
        return fmt::format("\"{}\"", *text);
    }
    return "NULL";
}

bool same(const Value& stored, const Value& recomputed) noexcept {
    if (const auto* real = std::get_if<double>(&recomputed); real != nullptr && std::isnan(*real)) {
        return std::holds_alternative<std::monostate>(stored);
    }
    return stored == recomputed;
}

}  // namespace palpate::data
