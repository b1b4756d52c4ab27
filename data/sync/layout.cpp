#include "data/sync/layout.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "data/schema/catalogue.hpp"

namespace palpate::data {
namespace {

OwnedTable without(const TableManual& table, const std::set<std::string>& left) {
    OwnedTable owned{.name = table.name, .columns = {}};
    for (const ColumnManual& column : table.columns) {
        if (!left.contains(column.name)) {
            owned.columns.push_back(column.name);
        }
    }
    return owned;
}

OwnedTable without(const std::string& name, const std::set<std::string>& left) {
    return without(*std::ranges::find(catalogue(), name, &TableManual::name), left);
}

bool has(const TableManual& table, std::string_view column) {
    return std::ranges::find(table.columns, column, &ColumnManual::name) != table.columns.end();
}

/// Columns of a session by when they are set.
void split_session(Layout& layout) {
    const std::set<std::string> at_end{"finished", "finished_utc", "seal", "seal_events"};
    const std::set<std::string> repaired{"session_number", "run_code", "run_number",
                                         "withdrawn_reason"};
    layout.session =
        without("session", {"session_id", "study_id", "participant_id", "newest_seal"});
    layout.session_end = layout.session_repairs = layout.session;
    std::erase_if(layout.session.columns,
                  [&](const auto& c) { return at_end.contains(c) || repaired.contains(c); });
    std::erase_if(layout.session_repairs.columns,
                  [&](const auto& c) { return !repaired.contains(c); });
    std::erase_if(layout.session_end.columns, [&](const auto& c) { return !at_end.contains(c); });
}

}  // namespace

std::string OwnedTable::list() const {
    return fmt::format("{}", fmt::join(columns, ", "));
}

std::string OwnedTable::select(std::string_view owner) const {
    std::string order;
    for (std::size_t i = 1; i <= columns.size(); ++i) {
        order += fmt::format("{}{}", i == 1 ? "" : ", ", i);
    }
    return fmt::format("SELECT {} FROM {} WHERE {} = ?1 ORDER BY {}", list(), name, owner, order);
}

std::string OwnedTable::insert(std::string_view owner) const {
    std::string places = "?1";
    for (std::size_t i = 0; i < columns.size(); ++i) {
        places += fmt::format(", ?{}", i + 2);
    }
    return fmt::format("INSERT INTO {} ({}, {}) VALUES ({})", name, owner, list(), places);
}

Layout catalogue_layout() {
    static const std::set<std::string> own{"study", "participant", "session", "trial", "event"};
    Layout layout;
    split_session(layout);
    layout.trial = without("trial", {"trial_id", "session_id", "invalid_reason"});
    layout.event = without("event", {"event_id", "session_id", "trial_id"});
    for (const TableManual& table : catalogue()) {
        if (table.view || own.contains(table.name)) {
            continue;
        }
        if (has(table, "trial_id")) {
            layout.of_trial.push_back(without(table, {"trial_id"}));
        } else if (has(table, "session_id")) {
            layout.of_session.push_back(without(table, {"session_id"}));
        } else if (!has(table, "participant_id")) {  // PeopleMerge has these
            layout.of_file.push_back(without(table, {}));
        }
    }
    for (auto* part : {&layout.of_trial, &layout.of_session, &layout.of_file}) {
        std::ranges::sort(*part, {}, &OwnedTable::name);
    }
    return layout;
}

void bind_row(const Statement& from, Statement& to, int first) {
    for (int column = 0; column < from.columns(); ++column) {
        switch (from.type(column)) {
            case 1:
                to.bind(first + column, from.integer(column));
                break;
            case 2:
                to.bind(first + column, from.real(column));
                break;
            case 3:
                to.bind(first + column, std::string_view(from.text(column)));
                break;
            case 4:
                to.bind(first + column, from.blob(column));
                break;
            default:
                to.bind_null(first + column);
        }
    }
}

}  // namespace palpate::data
