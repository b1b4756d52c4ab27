#include "data/verify/verify.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <sqlite3.h>

#include "engine/base/text.hpp"
#include "data/schema/catalogue.hpp"
#include "data/schema/manual.hpp"
#include "data/store/people.hpp"
#include "data/store/secret.hpp"
#include "data/trace/chunk.hpp"
#include "data/verify/findings.hpp"
#include "data/verify/session_check.hpp"

namespace palpate::data {
namespace {

void ask_sqlite(Database& database, Findings& findings) {
    for (const StoredRow& row : rows_of(database, "PRAGMA integrity_check")) {
        if (row.text("integrity_check") != "ok") {
            findings.differs("integrity_check", row.text("integrity_check"), "ok");
        }
    }
    for (const StoredRow& row : rows_of(database, "PRAGMA foreign_key_check")) {
        findings.differs("foreign_key_check",
                         fmt::format("{} row {}", row.text("table"), row.integer("rowid")),
                         fmt::format("its row in {} is not there", row.text("parent")));
    }
}

void check_columns(Database& database, Findings& findings) {
    const auto columns = stored_columns();
    const auto rows =
        rows_of(database, "SELECT * FROM trace_column ORDER BY codec, column_position");
    if (rows.size() != columns.size()) {
        findings.differs("trace_column", counted(rows.size(), "row"),
                         counted(columns.size(), "row"));
    }
    for (std::size_t i = 0; i < std::min(rows.size(), columns.size()); ++i) {
        const auto expect = [&](std::string_view column, const Value& value) {
            findings.expect("trace_column", column, rows[i], value);
        };
        expect("codec", kTraceCodec);
        expect("column_position", static_cast<std::int64_t>(i));
        expect("name", std::string(columns[i].name));
        expect("type", std::string(columns[i].type));
        expect("unit", std::string(columns[i].unit));
        expect("scale", columns[i].scale);
        expect("rule", std::string(to_string(columns[i].rule)));
        expect("part", std::string(part_name(columns[i].part)));
    }
}

/// One secret is made with the file; foreign_key_check says where a session's own is gone. The number of a
/// person in exports was drawn with one of them.
void check_secrets(Database& database, Findings& findings) {
    constexpr int kDraws = 10;
    const auto secrets = rows_of(database, "SELECT hex FROM secret");
    if (secrets.empty()) {
        findings.differs("secret", "no row", "the one that was made with the file");
    }
    for (const StoredRow& person :
         rows_of(database, "SELECT participant_code, subject FROM participant")) {
        const std::int64_t stored = person.integer("subject");
        const bool drawn = std::ranges::any_of(secrets, [&](const StoredRow& secret) {
            int draw = 0;
            while (draw < kDraws && subject_of(person.text("participant_code"), secret.text("hex"),
                                               draw) != stored) {
                ++draw;
            }
            return draw < kDraws;
        });
        if (!drawn) {
            findings.differs("participant.subject", fmt::format("{}", stored),
                             "a number drawn with a secret of the file");
        }
    }
}

/// SQLite's own list of what a database holds.
using Schema = std::map<std::pair<std::string, std::string>, std::string>;  // type, name: its SQL

Schema schema_of(Database& database, sqlite3* handle) {
    sqlite3_stmt* row = nullptr;
    if (sqlite3_prepare_v2(handle, "SELECT type, name, tbl_name, sql FROM sqlite_schema", -1, &row,
                           nullptr) != SQLITE_OK) {
        database.fail("reading the schema");
    }
    const auto text = [&row](int column) {
        const auto* words = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
        return std::string(words == nullptr ? "" : words);
    };
    Schema all;
    while (sqlite3_step(row) == SQLITE_ROW) {
        all[{text(0), text(1)}] = text(3).empty() ? "of " + text(2) : text(3);
    }
    sqlite3_finalize(row);
    return all;
}

/// What a database that this palpate makes holds.
Schema shipped_schema(Database& database) {
    sqlite3* empty = nullptr;
    sqlite3_open(":memory:", &empty);
    const bool made = sqlite3_exec(empty, std::string(schema_sql()).c_str(), nullptr, nullptr,
                                   nullptr) == SQLITE_OK;
    Schema all = made ? schema_of(database, empty) : Schema{};
    sqlite3_close(empty);
    return all;
}

/// Tables, indexes and views word by word: without its CHECK a table takes what it should not, and a query of
/// an edited view says something else. What somebody added is theirs.
void check_schema(Database& database, Findings& findings) {
    const Schema stored = schema_of(database, database.handle());
    for (const auto& [object, sql] : shipped_schema(database)) {
        const auto there = stored.find(object);
        if (there == stored.end() || there->second != sql) {
            findings.differs(object.first + ' ' + object.second,
                             there == stored.end() ? "it is not there" : there->second,
                             "as this palpate makes it");
        }
    }
}

/// Handedness and consent against the events that noted them.
void check_people(Database& database, Findings& findings) {
    for (const NoteBreak& at : note_breaks(database)) {
        findings.differs(at.what, at.stored, at.noted + ", as an event of the session says");
    }
}

/// A trigger changes what a program writes, and a table called sample hides the ticks from every query.
/// palpate makes neither.
void check_strangers(Database& database, Findings& findings) {
    const std::vector<TableManual> ours = schema_manual(schema_sql());
    for (const StoredRow& row :
         rows_of(database,
                 "SELECT type, lower(name) AS name, lower(tbl_name) AS of FROM sqlite_schema")) {
        const bool trigger =
            row.text("type") == "trigger" &&
            std::ranges::find(ours, row.text("of"), &TableManual::name) != ours.end();
        if (trigger || row.text("name") == "sample") {
            findings.differs(
                row.text("type") + ' ' + row.text("name"), "it is there",
                trigger ? fmt::format("no trigger on {}: what was written since may be its doing",
                                      row.text("of"))
                        : "another name: it stands before the ticks");
        }
    }
}

/// What a damaged file does not let happen is a finding too.
template <class Check>
void try_to(Findings& findings, const char* what, const Check& check) {
    try {
        check();
    } catch (const std::exception& e) {
        findings.differs(what, e.what(), "a file that can be read");
    }
}

constexpr const char* kSessions =
    "SELECT session.*, study_name, study_title, protocol_sha256, protocol_toml, participant_code, "
    "coalesce(run_code, participant_code) AS run_as, coalesce(run_number, session_number) AS "
    "run_as_number FROM "
    "session LEFT JOIN study USING (study_id) LEFT JOIN participant USING (participant_id) ORDER "
    "BY session.session_id";

}  // namespace

Verification verify(Database& database) {
    const Snapshot now(database);
    Verification found;
    Findings findings(found.file);
    try_to(findings, "integrity_check", [&] { ask_sqlite(database, findings); });
    try_to(findings, "sqlite_schema", [&] { check_schema(database, findings); });
    try_to(findings, "secret", [&] { check_secrets(database, findings); });
    try_to(findings, "sqlite_schema", [&] { check_strangers(database, findings); });
    try_to(findings, "session", [&] {
        for (const StoredRow& session : rows_of(database, kSessions)) {
            found.sessions.push_back(check_session(database, session));
        }
    });
    try_to(findings, "participant", [&] { check_people(database, findings); });
    if (!found.sessions.empty()) {
        try_to(findings, "trace_column", [&] { check_columns(database, findings); });
    }
    return found;
}

}  // namespace palpate::data
