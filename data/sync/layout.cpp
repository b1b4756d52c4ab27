#include "data/sync/layout.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

namespace palpate::data {
namespace {

using Names = std::vector<std::string>;

Names names(Database& database, std::string_view sql, std::string_view table = {}) {
    Names all;
    Statement row = database.prepare(sql);
    if (!table.empty()) {
        row.bind(1, table);
    }
    while (row.step()) {
        all.push_back(row.text(0));
    }
    return all;
}

OwnedTable without(Database& database, const std::string& name, const std::set<std::string>& left) {
    OwnedTable table{.name = name,
                     .columns = names(database, "SELECT name FROM pragma_table_info(?1)", name)};
    std::erase_if(table.columns, [&](const std::string& column) { return left.contains(column); });
    return table;
}

void require_known_references(Database& database, const std::string& table) {
    static const std::set<std::string> known{"study", "participant", "session",
                                             "trial", "plan",        "secret"};
    for (const std::string& to :
         names(database, "SELECT \"table\" FROM pragma_foreign_key_list(?1)", table)) {
        if (!known.contains(to)) {
            throw StoreError(
                fmt::format("{}: {} refers to {}, which cannot be merged; update palpate",
                            database.file(), table, to));
        }
    }
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

Layout read_layout(Database& database) {
    static const std::set<std::string> own{"study", "participant", "session", "trial", "event"};
    Layout layout;
    const std::set<std::string> at_end{"finished", "finished_utc", "seal", "seal_events"};
    const std::set<std::string> repaired{"session_number", "run_code", "run_number",
                                         "withdrawn_reason"};
    layout.session =
        without(database, "session", {"session_id", "study_id", "participant_id", "newest_seal"});
    layout.session_end = layout.session_repairs = layout.session;
    std::erase_if(layout.session.columns,
                  [&](const auto& c) { return at_end.contains(c) || repaired.contains(c); });
    std::erase_if(layout.session_repairs.columns,
                  [&](const auto& c) { return !repaired.contains(c); });
    std::erase_if(layout.session_end.columns, [&](const auto& c) { return !at_end.contains(c); });
    layout.trial = without(database, "trial", {"trial_id", "session_id", "invalid_reason"});
    layout.event = without(database, "event", {"event_id", "session_id", "trial_id"});
    for (const std::string& table :
         names(database,
               "SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite_%'"
               " ORDER BY name")) {
        require_known_references(database, table);
        const auto columns = names(database, "SELECT name FROM pragma_table_info(?1)", table);
        const auto has = [&columns](const char* name) {
            return std::find(columns.begin(), columns.end(), name) != columns.end();
        };
        if (own.contains(table)) {
            continue;
        }
        if (has("trial_id")) {
            layout.of_trial.push_back(without(database, table, {"trial_id"}));
        } else if (has("session_id")) {
            layout.of_session.push_back(without(database, table, {"session_id"}));
        } else if (has("participant_id")) {
            layout.of_participant.push_back(without(database, table, {"participant_id"}));
        } else {
            layout.of_file.push_back(without(database, table, {}));
        }
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
