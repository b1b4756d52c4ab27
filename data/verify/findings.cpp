#include "data/verify/findings.hpp"

#include <algorithm>
#include <type_traits>

#include <fmt/format.h>

#include "engine/base/text.hpp"

namespace palpate::data {
namespace {

/// Bytes are none: chunks are checked as ticks.
Value value_of(const Row::Value& made) {
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

std::size_t Verification::count(FindingKind kind) const noexcept {
    std::size_t found = 0;
    const auto add = [&](const std::vector<Finding>& findings) {
        for (const Finding& finding : findings) {
            found += finding.kind == kind ? 1 : 0;
        }
    };
    add(file);
    for (const SessionReport& session : sessions) {
        add(session.findings);
    }
    return found;
}

void Findings::differs(std::string_view what, std::string stored, std::string recomputed) {
    add({.kind = FindingKind::differs,
         .trial = {},
         .tick = {},
         .what = std::string(what),
         .stored = std::move(stored),
         .recomputed = std::move(recomputed)});
}

void Findings::missing(std::string_view what, std::string why) {
    add({.kind = FindingKind::missing,
         .trial = {},
         .tick = {},
         .what = std::string(what),
         .stored = {},
         .recomputed = std::move(why)});
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
            add({.kind = FindingKind::differs,
                 .trial = {},
                 .tick = tick,
                 .what = fmt::format("{}.{}", name.empty() ? made.table() : name, column),
                 .stored = to_text(row.at(column)),
                 .recomputed = to_text(wanted)});
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
