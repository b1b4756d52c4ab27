#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <ranges>
#include <set>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "data/schema/catalogue.hpp"
#include "data/store/chain.hpp"
#include "data/sync/postgres.hpp"

namespace palpate::data {
namespace {

std::string type_of(const std::string& sqlite) {
    return sqlite == "INTEGER" ? "bigint"
         : sqlite == "REAL"    ? "double precision"
         : sqlite == "BLOB"    ? "bytea"
                               : "text";
}

std::string quoted(const std::vector<std::string>& names) {
    return fmt::format("{}", fmt::join(std::views::transform(names, quoted_name), ", "));
}

/// The columns of `from` after those of its owner, and the part of its key that is not the owner.
PostgresTable owned(Database& database,
                    const OwnedTable& from,
                    PostgresTable to,
                    const std::string& owner) {
    to.name = from.name;
    std::ranges::copy(
        texts(database.prepare("SELECT name FROM pragma_table_info(?1) WHERE pk > 0 AND name NOT "
                               "IN (?2, ?3) ORDER BY pk",
                               from.name, owner, from.name + "_id")),
        std::back_inserter(to.key));
    for (const std::string& column : from.columns) {
        to.columns.emplace_back(column, type_of(find_table(from.name)->find(column)->type));
    }
    return to;
}

/// What a file of SQLite has in other tables, or by other keys.
std::vector<PostgresTable> tables_of_no_file() {
    return {{"study",
             {{"protocol_sha256", "text"},
              {"study_name", "text"},
              {"study_title", "text"},
              {"protocol_toml", "text"}},
             {"protocol_sha256"}},
            {"participant_note",
             {{"participant_code", "text"}, {"key", "text"}, {"value", "text"}},
             {"participant_code", "key", "value"}},
            {"trial_invalid",
             {{"session_uuid", "uuid"}, {"trial_number", "bigint"}, {"invalid_reason", "text"}},
             {"session_uuid", "trial_number"}}};
}

/// Whether every table is there. @throws PostgresError for one without a column: added now, it
/// would be empty beside the rows that had it
bool has_all(Postgres& server, const std::vector<PostgresTable>& tables) {
    std::map<std::string, std::set<std::string>> there;
    for (const auto& row : server.rows(
             "SELECT relname, attname FROM pg_attribute JOIN pg_class ON pg_class.oid = attrelid "
             "JOIN pg_namespace ON pg_namespace.oid = relnamespace WHERE nspname = 'palpate' AND "
             "attnum > 0 AND NOT attisdropped")) {
        there[*row[0]].insert(*row[1]);
    }
    bool all = true;
    for (const PostgresTable& table : tables) {
        const auto found = there.find(table.name);
        all = all && found != there.end();
        for (const auto& [column, type] : table.columns) {
            refuse_if<PostgresError>(
                found != there.end() && !found->second.contains(column),
                "the server's table palpate.{} has no column {}: an administrator restores it from "
                "a backup, or drops the table; then push makes it, and adds the rows of each file "
                "that is pushed again",
                table.name, column);
        }
    }
    return all;
}

constexpr const char* kTheirSession = "session";

/// How often the session became another's; what was destroyed says no more than that it is the
/// last.
std::int64_t moves_of(const SessionVersion& session) {
    return session.destroyed
             ? std::numeric_limits<std::int64_t>::max()
             : session.database
                   ->first("SELECT count(*) FROM event WHERE session_id = ?1 AND key = ?2",
                           session.id, kIsReally)
                   .integer(0);
}

}  // namespace

Layout pushed_layout() {
    Layout layout = catalogue_layout();
    std::erase(layout.session.columns, "secret");
    return layout;
}

std::vector<PostgresTable> postgres_tables(const Layout& layout) {
    Database database("the catalogue", Access::memory);  // for its keys
    const PostgresTable of_session{{}, {{"session_uuid", "uuid"}}, {"session_uuid"}};
    const PostgresTable of_trial{{},
                                 {{"session_uuid", "uuid"}, {"trial_number", "bigint"}},
                                 {"session_uuid", "trial_number"}};
    const PostgresTable of_event{
        {},
        {{"session_uuid", "uuid"}, {"event_number", "bigint"}, {"trial_number", "bigint"}},
        {"session_uuid", "event_number"}};
    std::vector<PostgresTable> tables = tables_of_no_file();
    const auto add = [&](const OwnedTable& from, const PostgresTable& to, const auto& more) {
        PostgresTable& made = tables.emplace_back(owned(database, from, to, ""));
        made.columns.insert(made.columns.end(), more.begin(), more.end());
    };
    using Columns = decltype(PostgresTable::columns);
    add(layout.event, of_event, Columns{{"content", "text"}});
    add(layout.session, of_session,
        Columns{{"protocol_sha256", "text"},
                {"participant_code", "text"},
                {"session_number", "bigint"},
                {"began_sha256", "text"},
                {"file_schema", "bigint"}});
    add(layout.session_end, of_session, Columns{});
    tables.back().name = "session_end";
    add(layout.trial, of_trial, Columns{{"content", "text"}, {"file_schema", "bigint"}});
    for (const OwnedTable& table : layout.of_session) {
        tables.push_back(owned(database, table, of_session, "session_id"));
    }
    for (const OwnedTable& table : layout.of_trial) {
        tables.push_back(owned(database, table, of_trial, "trial_id"));
    }
    tables.push_back(owned(database, layout.trace_column, {}, ""));
    return tables;
}

std::string postgres_schema(const std::vector<PostgresTable>& tables) {
    std::string sql = "CREATE SCHEMA IF NOT EXISTS palpate;\n";
    for (const PostgresTable& table : tables) {
        const std::string name = "palpate." + quoted_name(table.name);
        std::string columns;
        std::string later;
        for (const auto& [column, type] : table.columns) {
            columns += fmt::format("    {} {},\n", quoted_name(column), type);
            later += type == "bytea"
                       ? fmt::format("ALTER TABLE {} ALTER COLUMN {} SET STORAGE EXTERNAL;\n", name,
                                     quoted_name(column))
                       : "";
        }
        sql += fmt::format("CREATE TABLE IF NOT EXISTS {} (\n{}    PRIMARY KEY ({})\n);\n{}", name,
                           columns, quoted(table.key), later);
    }
    return sql;
}

void require_schema(Postgres& server, const std::vector<PostgresTable>& tables) {
    if (has_all(server, tables)) {
        return;
    }
    try {
        // One who makes it waits for another. Made again it would wait for those who already add
        // rows, and they for it.
        server.run("BEGIN; SELECT pg_advisory_xact_lock(1885432944)");
        server.run((has_all(server, tables) ? "" : postgres_schema(tables)) + "COMMIT");
    } catch (const PostgresError& e) {
        throw PostgresError(
            fmt::format("{}; the schema palpate is not there or not whole: an administrator makes "
                        "it with the SQL of palpate push --roles",
                        e.what()));
    }
}

std::string postgres_roles() {
    std::string sql =
        "-- Least privilege. GRANT palpate_writer TO a login of a rig, palpate_reader TO one of an "
        "analyst.\n";
    for (const char* role : {"palpate_writer", "palpate_reader"}) {
        sql += fmt::format(
            "DO $$ BEGIN\n    IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = '{0}') THEN\n"
            "        CREATE ROLE {0} NOLOGIN;\n    END IF;\nEND $$;\n"
            "GRANT USAGE ON SCHEMA palpate TO {0};\n"
            "GRANT SELECT ON ALL TABLES IN SCHEMA palpate TO {0};\n"
            "ALTER DEFAULT PRIVILEGES IN SCHEMA palpate GRANT SELECT ON TABLES TO {0};\n",
            role);
    }
    return sql +
           "GRANT INSERT ON ALL TABLES IN SCHEMA palpate TO palpate_writer;\n"
           "ALTER DEFAULT PRIVILEGES IN SCHEMA palpate GRANT INSERT ON TABLES TO palpate_writer;\n"
           "REVOKE ALL ON SCHEMA palpate FROM PUBLIC;\n";
}

PostgresRows postgres_rows(const PostgresTable& table) {
    std::vector<std::string> names;
    std::string places;
    for (const auto& [column, type] : table.columns) {
        names.push_back(column);
        places += fmt::format("{}${}", names.size() == 1 ? "" : ", ", names.size());
    }
    const std::string name = "palpate." + quoted_name(table.name);
    return {.insert = fmt::format("INSERT INTO {} ({}) VALUES ({}) ON CONFLICT DO NOTHING", name,
                                  quoted(names), places),
            .same = fmt::format("SELECT 1 FROM {} WHERE ({}) = ({})", name, quoted(names), places)};
}

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

void Refusals::read(Postgres& server) {
    for (const auto& row : server.rows(
             "SELECT participant_code FROM palpate.participant_note WHERE key = 'consent' AND "
             "value = '0'")) {
        codes_.insert(*row[0]);
    }
    for (const auto& row : server.rows(
             "SELECT participant_code, max(value) FROM palpate.participant_note WHERE key = "
             "'destroyed' GROUP BY 1")) {
        destroyed_[*row[0]] = *row[1];
    }
    for (const auto& row : server.rows(
             "SELECT split_part(value, ' ', 1), max(split_part(value, ' ', 2)::bigint) FROM "
             "palpate.participant_note AS theirs WHERE key = $1 AND EXISTS (SELECT FROM "
             "palpate.participant_note AS no WHERE no.participant_code = theirs.participant_code "
             "AND no.key = 'consent' AND no.value = '0') GROUP BY 1",
             {kTheirSession})) {
        moves_[*row[0]] = std::stoll(*row[1]);
    }
}

bool Refusals::hold(const SessionVersion& session) const {
    const auto theirs = moves_.find(session.uuid);
    return hold(session.participant) ||
           (theirs != moves_.end() && moves_of(session) <= theirs->second);
}

PostgresRow Refusals::note(const SessionVersion& session) {
    return {session.participant, kTheirSession,
            fmt::format("{} {}", session.uuid, moves_of(session))};
}

}  // namespace palpate::data
