#include "data/store/destruction.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "data/schema/catalogue.hpp"
#include "data/store/own_schema.hpp"
#include "data/store/people.hpp"
#include "data/store/session_lock.hpp"

namespace palpate::data {
namespace {

/// The events that noted a score lose it; all later links are made again.
void destroy_scores(Database& database, std::int64_t session, const Reason& why) {
    const std::string before = chain_head(database, session);
    database.run(
        "UPDATE event SET text = key, value = NULL WHERE session_id = ?1 AND event_kind = "
        "'participant' AND key = 'handedness'",
        session);
    chain_anew(database, session);
    add_event(database, session,
              {.kind = protocols::EventKind::participant,
               .text = std::string(why.text),
               .key = std::string(kDestroyed),
               .value = before},
              why.operator_name);
}

/// Where it was run as somebody else, nothing that says so is left: it is theirs.
void destroy_session(Database& database, std::int64_t session, const Reason& why) {
    const std::string before = chain_head(database, session);
    clear_session(database, session);
    database.run(
        "UPDATE session SET finished = 0, finished_utc = NULL, seal = NULL, seal_events = NULL, "
        "newest_seal = NULL, operator = NULL, run_code = NULL, run_number = NULL, withdrawn_reason "
        "= ?2 WHERE session_id = ?1",
        session, why.text);
    add_event(database, session,
              {.kind = protocols::EventKind::mark,
               .text = std::string(why.text),
               .key = std::string(kDestroyed),
               .value = before},
              why.operator_name);
}

/// All of a participant. @throws std::invalid_argument for nobody, or if one of them runs
std::vector<SessionRow> idle_sessions(Database& database, std::string_view code) {
    if (!find_participant(database, code)) {
        throw std::invalid_argument(fmt::format("{}: nobody is called {}", database.file(), code));
    }
    std::vector<SessionRow> sessions = sessions_of(database, code, std::nullopt);
    for (const SessionRow& session : sessions) {
        if (SessionLock::held(database, session.id)) {
            throw std::invalid_argument(fmt::format("{}: session {} of {} runs now: end it first",
                                                    database.file(), session.number, code));
        }
    }
    return sessions;
}

/// @param consent  is taken away too
void destroy_notes(Database& database, std::string_view code, bool consent) {
    database.run(
        "DELETE FROM participant_detail WHERE participant_id = (SELECT participant_id FROM "
        "participant WHERE participant_code = ?1)",
        code);
    database.run(fmt::format("UPDATE participant SET handedness = NULL, handedness_utc = NULL, "
                             "destroyed_utc = ?2{} WHERE participant_code = ?1",
                             consent ? ", consent = 0, consent_utc = ?2" : ""),
                 code, database.utc_now());
}

}  // namespace

void destroy_participant(Database& database,
                         std::string_view code,
                         Destroy what,
                         const Reason& why) {
    if (const std::string theirs = ordered_elsewhere(database.connection()); !theirs.empty()) {
        throw std::invalid_argument(
            fmt::format("{}: {} is ordered by a rule of another program, so that the file cannot "
                        "be written anew without what is destroyed: drop it, and try again",
                        database.file(), theirs));
    }
    {
        Transaction all(database);
        database.execute("PRAGMA defer_foreign_keys = ON");
        const std::vector<SessionRow> sessions = idle_sessions(database, code);
        const bool everything = what == Destroy::everything;
        destroy_notes(database, code, everything);
        for (const SessionRow& session : sessions) {
            if (is_destroyed(database, session.id)) {
                continue;
            }
            (everything ? destroy_session : destroy_scores)(database, session.id, why);
        }
        all.commit();
    }
    empty_free_pages(database);
}

void clear_session(Database& database, std::int64_t session) {
    std::vector<std::string> of_trials = tables_with("trial_id");
    std::ranges::stable_partition(of_trials, [](const auto& table) { return table != "trial"; });
    for (const std::string& table : of_trials) {
        database.run(fmt::format("DELETE FROM {} WHERE trial_id IN (SELECT trial_id FROM trial "
                                 "WHERE session_id = ?1)",
                                 table),
                     session);
    }
    for (const std::string& table : tables_with("session_id")) {
        if (table != "session") {
            database.run(fmt::format("DELETE FROM {} WHERE session_id = ?1", table), session);
        }
    }
}

bool is_destroyed(Database& database, std::int64_t session) {
    return database
        .prepare("SELECT 1 FROM event WHERE session_id = ?1 AND event_kind = 'mark' AND key = ?2",
                 session, kDestroyed)
        .step();
}

void empty_free_pages(Database& database) {
    database.execute("VACUUM");
    database.checkpoint();
}

}  // namespace palpate::data
