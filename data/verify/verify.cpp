#include "data/verify/verify.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <type_traits>

#include <fmt/format.h>
#include <nettle/version.h>
#include <sqlite3.h>
#include <zlib.h>

#include "engine/base/text.hpp"
#include "data/schema/catalogue.hpp"
#include "data/store/own_schema.hpp"
#include "data/store/people.hpp"
#include "data/store/secret.hpp"
#include "data/store/written_rows.hpp"
#include "data/verify/findings.hpp"
#include "data/verify/trial_check.hpp"

namespace palpate::data {
namespace {

void ask_sqlite(Database& database, Findings& findings) {
    const auto check = [&](const std::string& ask) {
        for (const StoredRow& row : rows_of(database, ask)) {
            if (row.text("integrity_check") != "ok") {
                findings.differs("integrity_check", row.text("integrity_check"), "ok");
            }
        }
    };
    const bool whole = ordered_elsewhere(database.connection()).empty();
    if (whole) {
        check("PRAGMA integrity_check");
    }
    for (const TableManual& table : catalogue()) {  // another program's rule is in the way
        if (!whole && !table.view) {
            check(fmt::format("PRAGMA integrity_check({})", table.name));
        }
    }
    for (const TableManual& table : catalogue()) {
        const std::string ask = fmt::format("PRAGMA foreign_key_check({})", table.name);
        for (const StoredRow& row :
             table.view ? std::vector<StoredRow>() : rows_of(database, ask)) {
            findings.differs("foreign_key_check",
                             fmt::format("{} row {}", row.text("table"), row.integer("rowid")),
                             fmt::format("its row in {} is not there", row.text("parent")));
        }
    }
}

/// One secret is made with the file; foreign_key_check says where a session's own is gone. The
/// number of a person in exports was drawn with one of them.
void check_secrets(Database& database, Findings& findings) {
    const auto secrets = rows_of(database, "SELECT hex FROM secret");
    if (secrets.empty()) {
        findings.differs("secret", "no row", "the one that was made with the file");
    }
    if (const std::size_t strange = strange_secrets(database).size(); strange > 0) {
        findings.differs("secret", counted(strange, "row") + " with which nothing was drawn",
                         "the one that was made with the file, and those of merged files");
    }
    for (const StoredRow& person :
         rows_of(database, "SELECT participant_code, subject FROM participant")) {
        const std::int64_t stored = person.integer("subject");
        if (std::ranges::none_of(secrets, [&](const StoredRow& secret) {
                return drawn_with(secret.text("hex"), person.text("participant_code"), stored);
            })) {
            findings.differs("participant.subject", fmt::format("{}", stored),
                             "a number drawn with a secret of the file");
        }
    }
}

/// Handedness, consent and that something was destroyed against the events that say so, and that
/// they were noted at some time: a connection that only reads asks no CHECK of the schema. A
/// session that became another's was with somebody else then.
void check_people(Database& database, Findings& findings) {
    for (const NoteBreak& at : note_breaks(database)) {
        const std::string says = at.noted + ", as an event of the session says";
        if (at.later) {
            findings.missing(at.what, fmt::format("{}, and not {}: it was noted later in a file "
                                                  "that was merged, or edited with its time",
                                                  at.stored, says));
        } else {
            findings.differs(at.what, at.stored, says);
        }
    }
    for (const StoredRow& note : rows_of(
             database,
             "SELECT 'participant ' || participant_code || ' ' || key AS what, coalesce(stored, "
             "'NULL') || ', noted ' || coalesce(utc, 'NULL') AS stored FROM (SELECT "
             "participant_code, 'handedness' AS key, handedness AS stored, handedness_utc AS utc, "
             "handedness BETWEEN -100 AND 100 AS fits FROM participant UNION ALL SELECT "
             "participant_code, 'consent', consent, consent_utc, consent IN (0, 1) FROM "
             "participant UNION ALL SELECT participant_code, 'destroyed', destroyed_utc, "
             "destroyed_utc, 1 FROM participant UNION ALL SELECT participant_code, key, value, "
             "noted_utc, 1 FROM participant_detail JOIN participant USING (participant_id)) WHERE "
             "NOT fits OR (stored IS NULL) <> (utc IS NULL) OR utc IS NOT "
             "strftime('%Y-%m-%dT%H:%M:%fZ', utc, '+0 days')")) {
        findings.differs(note.text("what"), note.text("stored"), "a value with its time");
    }
    for (const StoredRow& person : rows_of(
             database,
             "SELECT participant_code, coalesce(destroyed_utc, 'NULL') AS stored, max(said) AS "
             "said FROM (SELECT participant_id, participant_code, destroyed_utc, started_utc, "
             "EXISTS (SELECT 1 FROM event WHERE event.session_id = session.session_id AND key = "
             "'destroyed' AND text <> 'detail destroyed') AS said FROM participant JOIN session "
             "USING (participant_id) WHERE NOT EXISTS (SELECT 1 FROM event WHERE event.session_id "
             "= session.session_id AND key = 'is really')) GROUP BY participant_id HAVING "
             "iif(max(said), destroyed_utc IS NULL, destroyed_utc > min(started_utc))")) {
        findings.differs(
            fmt::format("participant {} destroyed_utc", person.text("participant_code")),
            person.text("stored"),
            person.integer("said") != 0 ? "when an event says that something was"
                                        : "NULL: no event of a session says so");
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

Verification verify(Database& database) {
    const Snapshot now(database);
    Verification found;
    Findings findings(found.file);
    try_to(findings, "integrity_check", [&] { ask_sqlite(database, findings); });
    try_to(findings, "sqlite_schema", [&] {
        for (const SchemaDifference& one : schema_differences(database.connection())) {
            findings.differs(one.name, one.stored, one.wanted);
        }
    });
    try_to(findings, "secret", [&] { check_secrets(database, findings); });
    try_to(findings, "session", [&] {
        TickRooms rooms;
        for (const StoredRow& session : rows_of(database, kSessions)) {
            found.sessions.push_back(check_session(database, session, rooms));
        }
    });
    try_to(findings, "participant", [&] { check_people(database, findings); });
    if (!found.sessions.empty()) {
        try_to(findings, "trace_column", [&] {
            findings.expect(
                "trace_column", trace_column_rows(),
                rows_of(database, "SELECT * FROM trace_column ORDER BY codec, column_position"));
        });
    }
    return found;
}

std::vector<std::pair<std::string, std::string>> library_versions() {
    return {{"sqlite", std::string(sqlite3_libversion()) + " " + sqlite3_sourceid()},
            {"zlib", zlibVersion()},
            {"nettle", fmt::format("{}.{}", nettle_version_major(), nettle_version_minor())}};
}

const Value& StoredRow::at(std::string_view column) const {
    static const Value none;
    const auto found = values_.find(column);
    return found == values_.end() ? none : found->second;
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
