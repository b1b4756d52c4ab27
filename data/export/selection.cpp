#include "data/export/selection.hpp"

#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "protocols/design/counted.hpp"
#include "protocols/design/sha256.hpp"

namespace palpate::data {
namespace {

/// Letters and digits of a study's name, and a number where two would be the same.
std::string label_of(std::string_view name, std::set<std::string>& taken) {
    std::string plain;
    for (const char c : name) {
        const bool keep =
            (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        plain += keep ? std::string(1, c) : "";
    }
    plain = plain.empty() ? "study" : plain;
    std::string label = plain;
    for (int n = 2; !taken.insert(label).second; ++n) {
        label = fmt::format("{}x{}", plain, n);
    }
    return label;
}

std::map<std::int64_t, std::string> study_labels(Database& database) {
    std::map<std::int64_t, std::string> labels;
    std::set<std::string> taken;
    Statement row = database.prepare("SELECT id, name FROM study ORDER BY protocol_sha256");
    while (row.step()) {
        labels[row.integer(0)] = label_of(row.text(1), taken);
    }
    return labels;
}

std::int64_t count(Database& database, std::string_view sql, const std::string& kind) {
    Statement row = database.prepare(sql);
    row.bind(1, std::string_view(kind)).step();
    return row.integer(0);
}

}  // namespace

Selection::Selection(Database& database, const ExportOptions& options)
    : database_(database), now_(database) {
    database_.execute(
        "PRAGMA temp_store = MEMORY;"
        "CREATE TEMP TABLE chosen (session INTEGER PRIMARY KEY, subject TEXT, label TEXT, day"
        " INTEGER);"
        "CREATE TEMP TABLE numbered (trial INTEGER PRIMARY KEY, number INTEGER NOT NULL);");
    choose(options.kind);
    name_subjects();
    database_.execute(
        "UPDATE chosen SET day = (SELECT CAST(julianday(date(mine.started_utc))"
        " - julianday(date(min(other.started_utc))) AS INTEGER) FROM session AS mine"
        " JOIN session AS other ON other.participant = mine.participant"
        " JOIN chosen AS too ON too.session = other.id WHERE mine.id = chosen.session);"
        "INSERT INTO numbered SELECT id, row_number() OVER (PARTITION BY session ORDER BY id)"
        " FROM trial WHERE session IN (SELECT session FROM chosen);");
}

std::string Selection::titles() const {
    std::set<std::string_view> titles;
    for (const ChosenSession& session : sessions_) {
        titles.insert(session.title);
    }
    return fmt::format("{}", fmt::join(titles, "; "));
}

void Selection::choose(const std::string& kind) {
    constexpr std::string_view kOfKind = "SELECT count(*) FROM session WHERE ?1 IN ('all', kind)";
    constexpr std::string_view kRefused =
        "SELECT count(DISTINCT participant.id) FROM session JOIN participant"
        " ON participant.id = participant WHERE ?1 IN ('all', kind) AND consent = 0";
    without_consent_ = count(database_, kRefused, kind);
    database_
        .prepare(
            "INSERT INTO chosen (session) SELECT session.id FROM session JOIN participant"
            " ON participant.id = participant"
            " WHERE ?1 IN ('all', kind) AND consent IS NOT 0")
        .bind(1, std::string_view(kind))
        .run();
    if (count(database_, "SELECT count(*) FROM chosen WHERE ?1 = ?1", kind) == 0) {
        throw std::invalid_argument(fmt::format(
            "there is no {}session to export: {} of that kind, {} real, {} pilot, {} "
            "simulated, and "
            "{} not consent; --kind chooses",
            kind == "all" ? "" : kind + " ", count(database_, kOfKind, kind),
            count(database_, kOfKind, "real"), count(database_, kOfKind, "pilot"),
            count(database_, kOfKind, "simulated"),
            protocols::counted(without_consent_, "participant does", "participants do")));
    }
}

void Selection::name_subjects() {
    // The uuid of a participant's first session is random, and is exported with details only.
    std::map<std::string, std::int64_t> by_hash;
    Statement who = database_.prepare(
        "SELECT participant, code, uuid, min(number || ' ' || uuid) FROM session"
        " JOIN participant ON participant.id = participant GROUP BY participant.id");
    while (who.step()) {
        by_hash[protocols::sha256_hex("subject " + who.text(1) + ' ' + who.text(3))] =
            who.integer(0);
    }
    const auto labels = study_labels(database_);
    Statement session = database_.prepare(
        "SELECT session.id, study, number, rate_hz, name, title FROM chosen"
        " JOIN session ON session.id = session JOIN study ON study.id = study"
        " WHERE participant = ?1 ORDER BY study, number");
    Statement set =
        database_.prepare("UPDATE chosen SET subject = ?2, label = ?3 WHERE session = ?1");
    int subjects = 0;
    for (const auto& [hash, participant] : by_hash) {
        session.bind(1, participant);
        for (bool first = true; session.step(); first = false) {
            subjects += first ? 1 : 0;
            ChosenSession& one = sessions_.emplace_back();
            one = {.id = session.integer(0),
                   .subject = fmt::format("sub-{:03}", subjects),
                   .label = labels.at(session.integer(1)),
                   .study = session.text(4),
                   .title = session.text(5),
                   .number = session.integer(2),
                   .rate_hz = session.real(3)};
            set.bind(1, one.id)
                .bind(2, std::string_view(one.subject))
                .bind(3, std::string_view(one.label))
                .run();
        }
        session.reset();
    }
}

}  // namespace palpate::data
