#include "data/sync/push_shared.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "data/store/study_row.hpp"

namespace palpate::data {

PostgresRow with_row(PostgresRow before, const Statement& row) {
    for (int column = 0; column < row.columns(); ++column) {
        before.push_back(row.value(column));
    }
    return before;
}

std::int64_t push_shared(Database& database,
                         Postgres& server,
                         const std::map<std::string, PostgresRows>& sql,
                         std::vector<std::string>& conflicts) {
    std::int64_t added = 0;
    const auto push = [&](const std::string& table, Statement from, const std::string& called) {
        const auto rows = from.all([](const Statement& row) { return with_row({}, row); });
        server.send(std::string(kOneAtATime), {});
        for (const PostgresRow& row : rows) {
            server.send(sql.at(table).insert, row);
        }
        added += server.flush();
        if (std::ranges::any_of(rows, [&](const auto& row) {
                return server.rows(sql.at(table).same, row).empty();
            })) {
            conflicts.push_back(
                fmt::format("{}: the server has it otherwise in palpate.{}: an administrator "
                            "deletes that there, and pushes again",
                            called, table));
        }
    };
    for (const Statement& study : database.prepare(
             "SELECT study_id, study_name || '@' || substr(protocol_sha256, 1, 8) FROM study")) {
        if (study_breaks(database, study.integer(0)).empty()) {
            push("study",
                 database.prepare("SELECT protocol_sha256, study_name, study_title, protocol_toml "
                                  "FROM study WHERE study_id = ?1",
                                  study.integer(0)),
                 "study " + study.text(1));
        }
    }
    push(
        "trace_column",
        database.prepare(
            "SELECT codec, column_position, name, type, unit, scale, rule, part FROM trace_column"),
        "trace_column");
    return added;
}

}  // namespace palpate::data
