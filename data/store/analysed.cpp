#include "data/store/analysed.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/store/own_schema.hpp"

namespace palpate::data {
namespace {

/// A row a version with people of a kind; `several`: so has another one of the same protocol. Of
/// all that is in the file: who is left out later gives no version another name.
constexpr std::string_view kVersions = R"sql(
SELECT study_id, study_name, protocol_sha256, session_kind, count(DISTINCT participant_id) AS people,
       count(*) OVER (PARTITION BY study_name, session_kind) > 1 AS several
FROM main.session JOIN main.study USING (study_id)
WHERE EXISTS (SELECT 1 FROM trial WHERE trial.session_id = session.session_id)
GROUP BY study_id, session_kind)sql";

/// What no analysis sees: sessions that were withdrawn, and all of who does not consent.
constexpr std::string_view kHidden =
    "withdrawn_reason IS NOT NULL OR participant_id IN (SELECT participant_id FROM "
    "main.participant WHERE consent = 0)";

bool any(Database& database, const std::string& sql) {
    return database.prepare(fmt::format("SELECT 1 FROM ({}) LIMIT 1", sql)).step();
}

/// A study of several versions is "name@12345678", each.
void name_versions(Database& database) {
    database.execute(
        fmt::format("CREATE TEMP TABLE study AS SELECT study_id, iif(study_id IN (SELECT study_id "
                    "FROM ({}) WHERE several), study_name || '@' || substr(protocol_sha256, 1, 8), "
                    "study_name) AS study_name, study_title, protocol_sha256, protocol_toml FROM "
                    "main.study;CREATE UNIQUE INDEX temp.study_by_id ON study (study_id)",
                    kVersions)
            .c_str());
}

void check_study(Database& database, const std::string& study) {
    std::set<std::string> all;
    std::set<std::string> versions;
    for (const std::string& name : texts(database.prepare("SELECT study_name FROM study"))) {
        all.insert(name);
        if (name.starts_with(study + '@')) {
            versions.insert(name);
        }
    }
    if (!all.contains(study)) {
        throw std::invalid_argument(
            versions.empty()
                ? fmt::format("{} has no study {}: it has {}", database.file(), plain(study),
                              all.empty() ? "none" : plain(fmt::format("{}", fmt::join(all, ", "))))
                : several_studies(database, versions));
    }
}

}  // namespace

void analyse(Database& database, Versions versions, const std::string& study) {
    const bool hidden = hides(database);
    if (hidden) {
        database.execute(
            fmt::format("CREATE TEMP VIEW session AS SELECT * FROM main.session WHERE NOT ({})",
                        kHidden)
                .c_str());
    }
    const bool apart = versions == Versions::apart &&
                       any(database, fmt::format("SELECT 1 FROM ({}) WHERE several", kVersions));
    if (apart) {
        name_versions(database);
    }
    if (apart || hidden) {
        make_own_views(database.connection());  // those of the file would not see it
    }
    if (!study.empty()) {
        check_study(database, study);
    }
}

void keep_attempts(Database& database) {
    database.execute("CREATE TEMP TABLE attempts AS SELECT * FROM analysis_trial");
    database.execute("DROP VIEW IF EXISTS temp.analysis_trial");
    database.execute("CREATE TEMP VIEW analysis_trial AS SELECT * FROM temp.attempts");
    // Whoever asks for the events of each trial goes over all of them for each, but for an index.
    database.execute("CREATE TEMP TABLE event AS SELECT * FROM main.event");
    database.execute("CREATE INDEX temp.event_of_trial ON event (trial_id)");
}

bool hides(Database& database) {
    return any(database, fmt::format("SELECT 1 FROM main.session WHERE {}", kHidden));
}

std::string why_hidden(Database& database, std::int64_t trial) {
    Statement row = database.prepare(
        fmt::format("SELECT iif(withdrawn_reason IS NULL, 'of somebody who is noted as not "
                    "consenting', 'of a session that was withdrawn') FROM trial JOIN main.session "
                    "USING (session_id) WHERE trial_id = ?1 AND ({})",
                    kHidden),
        trial);
    return row.step() ? row.text(0) : std::string();
}

void require_shown(Database& database, std::int64_t trial) {
    if (const std::string why = why_hidden(database, trial); !why.empty()) {
        throw std::invalid_argument(fmt::format("{}: trial {} is {}: its ticks are not shown",
                                                database.file(), trial, why));
    }
}

std::string several_studies(Database& database, const std::set<std::string>& studies) {
    std::string text =
        fmt::format("{} holds several studies: give --study and one of {}", database.file(),
                    plain(fmt::format("{}", fmt::join(studies, ", "))));
    const std::string versions = versions_text(versions_of(database));
    return versions.empty() ? text : text + "\n" + versions;
}

std::vector<StudyVersion> versions_of(Database& database) {
    Statement row = database.prepare(fmt::format(
        "SELECT study.study_name, protocol_sha256, session_kind, people FROM (SELECT study_id, "
        "session_kind, people FROM ({}) WHERE several) JOIN study USING (study_id) ORDER BY "
        "study_id, session_kind",
        kVersions));
    return row.all([](const Statement& one) {
        return StudyVersion{one.text(0), one.text(1), one.text(2), one.integer(3)};
    });
}

std::string versions_text(const std::vector<StudyVersion>& versions) {
    std::string text;
    for (const StudyVersion& one : versions) {
        text += fmt::format(
            "    {:<40}  {} ({})\n",
            plain(one.study.find('@') == std::string::npos
                      ? fmt::format("{}@{}", one.study, one.protocol_sha256.substr(0, 8))
                      : one.study),
            counted(one.people, "person", "people"), one.kind);
    }
    if (text.empty()) {
        return text;
    }
    const bool apart = versions.front().study.find('@') != std::string::npos;
    return (apart ? "  The file holds several versions of a protocol, which are kept apart "
                    "(--versions together takes them as one):\n"
                  : "  CAUTION: the file holds several versions of a protocol, taken as one:\n") +
           text;
}

}  // namespace palpate::data
