#include "data/verify/verify.hpp"

#include <algorithm>
#include <exception>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "protocols/design/counted.hpp"
#include "data/store/schema.hpp"
#include "data/store/schema_manual.hpp"
#include "data/store/views.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/codec.hpp"
#include "data/trace/columns.hpp"
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

/// One row as trace_column has it, by position.
struct Described {
    std::string name, type, unit;
    double scale = 1.0;
    std::string rule = "exact";
    std::string part{};
};

std::vector<Described> described(std::int64_t codec) {
    std::vector<Described> all;
    if (codec == kTraceCodec) {
        for (const TraceColumn& c : trace_columns()) {
            all.push_back({std::string(c.name), std::string(c.type), std::string(c.unit)});
        }
    } else {
        for (const StoredColumn& c : stored_columns()) {
            all.push_back({std::string(c.name), std::string(c.type), std::string(c.unit), c.scale,
                           std::string(to_string(c.rule)), std::string(part_name(c.part))});
        }
    }
    return all;
}

/// A codec is described where a session of the present schema was made, or an older one was brought up to it.
void check_columns(Database& database, Findings& findings) {
    const bool before_5 = database.schema() < 5;
    std::size_t known = 0;
    for (const std::int64_t codec : {kTraceCodec, kTraceCodec2}) {
        const auto columns = described(codec);
        const auto rows = rows_of(
            database, "SELECT * FROM trace_column WHERE codec = ?1 ORDER BY position", codec);
        known += rows.size();
        const bool used =
            !rows_of(database, "SELECT 1 AS n FROM trace_chunk WHERE codec = ?1 LIMIT 1", codec)
                 .empty();
        if (rows.size() != columns.size() && (used || !rows.empty())) {
            findings.differs("trace_column", protocols::counted(rows.size(), "row"),
                             protocols::counted(columns.size(), "row"));
        }
        for (std::size_t i = 0; i < std::min(rows.size(), columns.size()); ++i) {
            findings.expect("trace_column", "position", rows[i], static_cast<std::int64_t>(i));
            findings.expect("trace_column", "name", rows[i], columns[i].name);
            findings.expect("trace_column", "type", rows[i], columns[i].type);
            findings.expect("trace_column", "unit", rows[i], columns[i].unit);
            if (!before_5) {
                findings.expect("trace_column", "scale", rows[i], columns[i].scale);
                findings.expect("trace_column", "rule", rows[i], columns[i].rule);
                findings.expect("trace_column", "part", rows[i], columns[i].part);
            }
        }
    }
    const auto all =
        rows_of(database, "SELECT count(*) AS n FROM trace_column").front().integer("n");
    if (all == 0 || all != static_cast<std::int64_t>(known)) {
        findings.differs("trace_column", protocols::counted(all, "row"),
                         all == 0 ? "the columns of a codec" : "rows of known codecs alone");
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
    if (database.schema() == kSchemaVersion) {
        try_to(findings, "view", [&] { check_views(database, findings); });
    }
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
