#include "data/verify/verify.hpp"

#include <algorithm>
#include <exception>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "protocols/design/counted.hpp"
#include "data/store/schema.hpp"
#include "data/store/schema_manual.hpp"
#include "data/store/secret.hpp"
#include "data/store/views.hpp"
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
    const auto rows = rows_of(database, "SELECT * FROM trace_column ORDER BY codec, position");
    if (rows.size() != columns.size()) {
        findings.differs("trace_column", protocols::counted(rows.size(), "row"),
                         protocols::counted(columns.size(), "row"));
    }
    for (std::size_t i = 0; i < std::min(rows.size(), columns.size()); ++i) {
        const auto expect = [&](std::string_view column, const Value& value) {
            findings.expect("trace_column", column, rows[i], value);
        };
        expect("codec", kTraceCodec);
        expect("position", static_cast<std::int64_t>(i));
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
    for (const StoredRow& person : rows_of(database, "SELECT code, subject FROM participant")) {
        const std::int64_t stored = person.integer("subject");
        const bool drawn = std::ranges::any_of(secrets, [&](const StoredRow& secret) {
            int draw = 0;
            while (draw < kDraws &&
                   subject_of(person.text("code"), secret.text("hex"), draw) != stored) {
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

/// The views of this palpate, word by word: a query of an edited one says something else. Those that
/// somebody added are theirs.
void check_views(Database& database, Findings& findings) {
    constexpr std::string_view kCreate = "CREATE VIEW ";
    const std::string_view text = views_sql();
    for (std::size_t at = text.find(kCreate); at != std::string_view::npos;
         at = text.find(kCreate, at + 1)) {
        const std::size_t from = at + kCreate.size();
        const std::string name(text.substr(from, text.find(' ', from) - from));
        Statement row =
            database.prepare("SELECT sql FROM sqlite_schema WHERE type = 'view' AND name = ?1");
        const std::string stored =
            row.bind(1, std::string_view(name)).step() ? row.text(0) : std::string();
        if (stored.empty() || !text.substr(at).starts_with(stored + ';')) {
            findings.differs("view " + name, stored.empty() ? "it is not there" : stored,
                             "as this palpate makes it");
        }
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
    "SELECT session.*, name, title, protocol_sha256, protocol_toml, code FROM session"
    " LEFT JOIN study ON study.id = study LEFT JOIN participant ON participant.id = participant"
    " ORDER BY session.id";

}  // namespace

Verification verify(Database& database) {
    const Snapshot now(database);
    Verification found;
    Findings findings(found.file);
    try_to(findings, "integrity_check", [&] { ask_sqlite(database, findings); });
    try_to(findings, "secret", [&] { check_secrets(database, findings); });
    try_to(findings, "view", [&] { check_views(database, findings); });
    try_to(findings, "sqlite_schema", [&] { check_strangers(database, findings); });
    try_to(findings, "session", [&] {
        for (const StoredRow& session : rows_of(database, kSessions)) {
            found.sessions.push_back(check_session(database, session));
        }
    });
    if (!found.sessions.empty()) {
        try_to(findings, "trace_column", [&] { check_columns(database, findings); });
    }
    return found;
}

}  // namespace palpate::data
