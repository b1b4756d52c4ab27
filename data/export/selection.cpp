#include "data/export/selection.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/text.hpp"

namespace palpate::data {
namespace {

/// Letters and digits of a study's name.
std::string plain_name(std::string_view name) {
    std::string plain;
    for (const char c : name) {
        const bool keep =
            (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        plain += keep ? std::string(1, c) : "";
    }
    return plain.empty() ? "study" : plain;
}

/// What studies are called in names of files, by study_id. Of several with one name none has it
/// alone: another that comes later would take its meaning.
std::map<std::int64_t, std::string> study_labels(Database& database) {
    std::map<std::string, std::map<std::int64_t, std::string>> studies;
    for (const Statement& study : database.prepare(
             "SELECT study_id, study_name, substr(protocol_sha256, 1, 8) FROM study")) {
        studies[plain_name(study.text(1))][study.integer(0)] = study.text(2);
    }
    std::map<std::int64_t, std::string> labels;
    for (const auto& [name, versions] : studies) {
        for (const auto& [id, hash] : versions) {
            labels[id] = versions.size() == 1 ? name : fmt::format("{}x{}", name, hash);
        }
    }
    return labels;
}

/// Why there is nothing of a kind.
std::string no_session(Database& database, const std::string& kind) {
    Statement row = database.first(
        "SELECT sum(asked), sum(asked AND consent IS NOT 0), sum(asked AND consent = 0), "
        "sum(session_kind = 'real'), sum(session_kind = 'pilot'), sum(session_kind = 'simulated') "
        "FROM (SELECT *, ?1 IN ('all', session_kind) AS asked FROM session) JOIN participant USING "
        "(participant_id)",
        kind);
    const auto are = [&](int column) {
        return counted(row.integer(column), "is", "are");
    };
    const std::string name = kind == "all" ? "session" : kind + " session";
    const std::string text =
        fmt::format("there is no {} to export: of {} {} withdrawn, and {} of who does not consent",
                    name, counted(row.integer(0), name), are(1), are(2));
    return kind == "all" ? text
                         : fmt::format(
                               "{}; the file has {} real, {} pilot and {} simulated: "
                               "--kind chooses",
                               text, row.integer(3), row.integer(4), row.integer(5));
}

}  // namespace

Selection::Selection(Database& database, const ExportOptions& options)
    : database_(database), now_(database) {
    database_.execute(
        "CREATE TEMP TABLE chosen (session_id INTEGER PRIMARY KEY, "
        "subject TEXT, label TEXT, day INTEGER, session_number INTEGER);CREATE TEMP TABLE numbered "
        "(trial_id INTEGER PRIMARY KEY, trial_number INTEGER NOT NULL, zero_ns INTEGER, "
        "trials_since_break INTEGER, exclusion TEXT);CREATE TEMP TABLE happened (event_id INTEGER "
        "PRIMARY KEY, since_ns INTEGER);");
    choose(options.kind);
    database_.execute(  // a gap would say that somebody had a session of another kind before
        "UPDATE chosen SET session_number = n FROM (SELECT session.session_id, dense_rank() OVER "
        "(PARTITION BY participant_id, study_name ORDER BY session.session_number) AS n FROM "
        "chosen JOIN session USING (session_id) JOIN study USING (study_id)) AS ranked WHERE "
        "ranked.session_id = chosen.session_id");
    name_subjects();
    database_.execute(
        "UPDATE chosen SET day = (SELECT CAST(julianday(date(mine.started_utc)) - "
        "julianday(date(min(other.started_utc))) AS INTEGER) FROM session AS mine JOIN session AS "
        "other ON other.participant_id = mine.participant_id JOIN chosen AS too ON too.session_id "
        "= other.session_id WHERE mine.session_id = chosen.session_id);"
        // The servo's clock says when its machine was switched on, and so who came first: it counts
        // from the first of attempts that follow each other within an hour.
        "WITH begun AS (SELECT trial_id, session_id, started_ns, started_ns - lag(started_ns) OVER "
        "(PARTITION BY session_id ORDER BY trial_id) AS gap FROM trial WHERE session_id IN (SELECT "
        "session_id FROM chosen)), part AS (SELECT *, sum(gap IS NULL OR gap NOT BETWEEN 0 AND "
        "3600000000000) OVER (PARTITION BY session_id ORDER BY trial_id) AS part FROM begun) "
        "INSERT INTO numbered SELECT trial_id, row_number() OVER (PARTITION BY part.session_id "
        "ORDER BY trial_id), first_value(started_ns) OVER (PARTITION BY part.session_id, part "
        "ORDER BY trial_id), trials_since_break, exclusion FROM part JOIN analysis_trial USING "
        "(trial_id);INSERT INTO happened SELECT event_id, since_ns FROM (SELECT event.event_id AS "
        "event_id, event.at_ns - zero_ns AS since_ns, row_number() OVER (PARTITION BY "
        "event.event_id ORDER BY abs(event.at_ns - begun.started_ns)) AS nearest FROM event JOIN "
        "chosen ON chosen.session_id = event.session_id JOIN trial AS begun ON begun.session_id = "
        "event.session_id JOIN numbered ON numbered.trial_id = begun.trial_id WHERE "
        "abs(event.at_ns - begun.started_ns) < 3600000000000) WHERE nearest = 1;");
}

std::string Selection::titles() const {
    std::set<std::string_view> titles;
    for (const ChosenSession& session : sessions_) {
        titles.insert(session.title);
    }
    return fmt::format("{}", fmt::join(titles, "; "));
}

std::vector<NotTaken> Selection::keep(std::string_view held) {
    database_.run(fmt::format("CREATE TEMP TABLE held AS {}", held));
    std::vector<NotTaken> none =
        database_
            .prepare(
                "SELECT study_name, session_kind, count(*) FROM chosen JOIN session USING "
                "(session_id) JOIN study USING (study_id) GROUP BY 1, 2 HAVING "
                "sum(session_id IN (SELECT session_id FROM held)) = 0 ORDER BY 2, 1")
            .all([](const Statement& row) {
                return NotTaken{row.text(0), row.text(1), row.integer(2)};
            });
    database_.execute("DELETE FROM chosen WHERE session_id NOT IN (SELECT session_id FROM held)");
    name_subjects();
    return none;
}

void Selection::choose(const std::string& kind) {
    database_.run(
        "INSERT INTO chosen (session_id) SELECT session.session_id FROM session JOIN participant "
        "USING (participant_id) WHERE ?1 IN ('all', session_kind) AND consent IS NOT 0 AND "
        "withdrawn_reason IS NULL",
        kind);
    if (!database_.prepare("SELECT 1 FROM chosen LIMIT 1").step()) {
        throw std::invalid_argument(no_session(database_, kind));
    }
}

void Selection::name_subjects() {
    const std::map<std::int64_t, std::string> labels = study_labels(database_);
    Statement session = database_.prepare(
        "SELECT session.session_id, study_id, chosen.session_number, rate_hz, study_name, "
        "study_title, participant.subject, session_kind FROM chosen JOIN session USING "
        "(session_id) JOIN study USING (study_id) JOIN participant USING (participant_id) ORDER BY "
        "participant.subject, protocol_sha256, chosen.session_number");
    sessions_ = session.all([&labels](const Statement& one) {
        return ChosenSession{.id = one.integer(0),
                             .subject = fmt::format("sub-{:010}", one.integer(6)),
                             .label = labels.at(one.integer(1)),
                             .study = one.text(4),
                             .title = one.text(5),
                             .kind = one.text(7),
                             .number = one.integer(2),
                             .rate_hz = one.real(3)};
    });
    for (const ChosenSession& one : sessions_) {
        database_.run("UPDATE chosen SET subject = ?2, label = ?3 WHERE session_id = ?1", one.id,
                      one.subject, one.label);
    }
}

}  // namespace palpate::data
