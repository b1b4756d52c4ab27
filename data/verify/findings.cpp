#include "data/verify/findings.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>

#include "engine/base/text.hpp"

namespace palpate::data {
namespace {

template <class T>
T as(const Value& value) {
    const T* found = std::get_if<T>(&value);
    return found == nullptr ? T{} : *found;
}

/// Bytes are none: chunks are checked as ticks.
Value value_of(const ColumnValue& made) {
    return std::visit(
        [](const auto& value) {
            if constexpr (std::is_constructible_v<Value, decltype(value)>) {
                return Value(value);
            } else {
                return Value();
            }
        },
        made);
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
            const bool bytes = row.type(column) == 4;  // where no palpate writes some
            stored.set(row.name(column),
                       bytes ? Value(row.text(column)) : value_of(row.value(column)));
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

std::size_t Verification::count(FindingKind kind) const noexcept {
    auto found = std::ranges::count(file, kind, &Finding::kind);
    for (const SessionReport& session : sessions) {
        found += std::ranges::count(session.findings, kind, &Finding::kind);
    }
    return static_cast<std::size_t>(found);
}

void Findings::differs(std::string_view what,
                       std::string stored,
                       std::string recomputed,
                       std::optional<std::int64_t> tick) {
    add({.tick = tick,
         .what = std::string(what),
         .stored = std::move(stored),
         .recomputed = std::move(recomputed)});
}

void Findings::missing(std::string_view what, std::string why) {
    add({.kind = FindingKind::missing, .what = std::string(what), .recomputed = std::move(why)});
}

void Findings::expect(std::string_view table,
                      std::string_view column,
                      const StoredRow& row,
                      const Value& recomputed) {
    if (!same(row.at(column), recomputed)) {
        differs(fmt::format("{}.{}", table, column), to_text(row.at(column)), to_text(recomputed));
    }
}

void Findings::expect(const Row& made,
                      const StoredRow& row,
                      std::string_view name,
                      std::optional<std::int64_t> tick) {
    for (const auto& [column, value] : made.values()) {
        if (const Value wanted = value_of(value); !same(row.at(column), wanted)) {
            differs(fmt::format("{}.{}", name.empty() ? made.table() : name, column),
                    to_text(row.at(column)), to_text(wanted), tick);
        }
    }
}

void Findings::expect(std::string_view table,
                      std::span<const Row> made,
                      std::span<const StoredRow> rows,
                      std::string_view key) {
    if (rows.size() != made.size()) {
        differs(table, counted(rows.size(), "row"), counted(made.size(), "row"));
    }
    for (std::size_t i = 0; i < std::min(rows.size(), made.size()); ++i) {
        const std::string at = to_text(value_of(made[i].values().front().second));
        expect(made[i], rows[i], key.empty() ? "" : fmt::format("{} at {} {}", table, key, at));
    }
}

void Findings::add(Finding finding) {
    if (!finding.trial) {
        finding.trial = trial_;
    }
    all_.push_back(std::move(finding));
}

}  // namespace palpate::data
