
#include <algorithm>
#include <map>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "protocols/session/progress.hpp"
#include "data/schema/catalogue.hpp"
#include "data/store/own_schema.hpp"
#include "data/store/people.hpp"
#include "data/store/session_lock.hpp"

namespace palpate::data {
namespace {

[[noreturn]] void refuse(Database& database, std::int64_t session, std::string_view why) {
    Statement row = database.first(
        "SELECT participant_code, session_number FROM session JOIN participant USING "
        "(participant_id) WHERE session_id = ?1",
        session);
    throw std::invalid_argument(
        fmt::format("{}: session {} of {} {}", database.file(), row.integer(1), row.text(0), why));
}

void refuse_running(Database& database, std::int64_t session) {
    if (SessionLock::held(database, session)) {
        refuse(database, session, "runs now, and would not know of it: end it first");
    }
}

/// A mark of the session as a whole.
std::string mark_session(Database& database,
                         std::int64_t session,
                         const Reason& why,
                         std::string_view key) {
    database.run("UPDATE session SET withdrawn_reason = ?2 WHERE session_id = ?1", session,
                 key.empty() ? std::optional(why.text) : std::nullopt);
    return add_event(database, session,
                     {.kind = protocols::EventKind::mark,
                      .text = std::string(why.text),
                      .key = std::string(key)},
                     why.operator_name);
}

/// The wished number if the participant has no session of it, in any version of the study; else the
/// next one.
std::int64_t free_number(Database& database,
                         std::int64_t session,
                         std::string_view code,
                         std::int64_t wished) {
    Statement row = database.first(
        "SELECT coalesce(max(session_number), 0), coalesce(sum(session_number = ?3), 0) FROM "
        "session JOIN study USING (study_id) JOIN participant USING (participant_id) WHERE "
        "participant_code = ?2 AND study_name = (SELECT study_name FROM study JOIN session AS own "
        "USING (study_id) WHERE own.session_id = ?1)",
        session, code, wished);
    return row.integer(1) == 0 ? wished : row.integer(0) + 1;
}

/// @param ran_as  code and number that it was run with, kept where they are others
void give_session(Database& database,
                  std::int64_t session,
                  std::string_view code,
                  std::int64_t number,
                  const std::pair<std::string, std::int64_t>& ran_as) {
    const bool as_run = ran_as.first == code && ran_as.second == number;
    database.run(
        "UPDATE session SET participant_id = (SELECT participant_id FROM participant WHERE "
        "participant_code = ?2), session_number = ?3, run_code = ?4, run_number = ?5 WHERE "
        "session_id = ?1",
        session, code, number,
        as_run ? std::nullopt : std::optional<std::string_view>(ran_as.first),
        as_run ? std::nullopt : std::optional(ran_as.second));
}

/// @throws std::invalid_argument if it cannot be given to `code`
void require_movable(Database& database,
                     std::int64_t session,
                     std::string_view whose,
                     std::string_view code) {
    if (whose == code) {
        refuse(database, session, "is theirs already");
    }
    refuse_if(!find_participant(database, code),
              "{}: nobody is called {}: palpate participant FILE {} --new registers them first",
              database.file(), code, code);
    if (is_destroyed(database, session)) {
        refuse(database, session, "was destroyed");
    }
    refuse_running(database, session);
}

MovedSession move_session(Database& database,
                          std::int64_t session,
                          std::string_view code,
                          const Reason& why) {
    Statement row = database.first(
        "SELECT participant_code, coalesce(run_code, participant_code), coalesce(run_number, "
        "session_number), finished FROM session JOIN participant USING (participant_id) WHERE "
        "session_id = ?1",
        session);
    const std::string run_code = row.text(1);
    const std::int64_t run_number = row.integer(2);
    MovedSession moved;
    moved.finished = row.integer(3) != 0;
    const std::string whose = row.text(0);
    row.reset();
    require_movable(database, session, whose, code);
    moved.number = free_number(database, session, code, run_number);
    moved.as_run = run_code == code && run_number == moved.number;
    give_session(database, session, code, moved.number, {run_code, run_number});
    add_event(database, session,
              {.kind = protocols::EventKind::participant,
               .text = std::string(why.text),
               .count = moved.number,
               .key = std::string(kIsReally),
               .value = std::string(code)},
              why.operator_name);
    note_at_beginning(database, session);
    moved.head = chain_head(database, session);
    return moved;
}

/// Scores that were noted while a session was theirs (?1), whosesoever it is now.
constexpr std::string_view kTheirScores =
    "event_kind = 'participant' AND key = 'handedness' AND value IS NOT NULL AND coalesce((SELECT "
    "moved.value FROM event AS moved WHERE moved.session_id = event.session_id AND moved.key = "
    "'is really' AND moved.event_id < event.event_id ORDER BY moved.event_id DESC LIMIT 1), "
    "(SELECT "
    "coalesce(run_code, participant_code) FROM session JOIN participant USING (participant_id) "
    "WHERE session.session_id = event.session_id)) = ?1";

/// The events that noted a score lose it; all later links are made again. Of a session of which
/// everything goes, and that was run as somebody else, nothing that says so is left: it is theirs.
void destroy_in(Database& database,
                std::int64_t session,
                std::string_view code,
                bool everything,
                const Reason& why) {
    const std::string before = chain_head(database, session);
    if (everything) {
        clear_session(database, session);
        database.run(
            "UPDATE session SET finished = 0, finished_utc = NULL, seal = NULL, seal_events = "
            "NULL, newest_seal = NULL, operator = NULL, run_code = NULL, run_number = NULL, "
            "withdrawn_reason = ?2 WHERE session_id = ?1",
            session, why.text);
    } else {
        database.run(
            fmt::format("UPDATE event SET text = key, value = NULL WHERE session_id = ?2 AND {}",
                        kTheirScores),
            code, session);
        chain_anew(database, session);
    }
    add_event(database, session,
              {.kind = everything ? protocols::EventKind::mark : protocols::EventKind::participant,
               .text = std::string(why.text),
               .key = std::string(kDestroyed),
               .value = before},
              why.operator_name);
}

/// Those of a participant, true, and those of others in which a score of theirs stands.
/// @throws std::invalid_argument for nobody, or if one of them runs
std::map<std::int64_t, bool> idle_sessions(Database& database, std::string_view code) {
    refuse_if(!find_participant(database, code), "{}: nobody is called {}", database.file(), code);
    std::map<std::int64_t, bool> sessions;
    for (const SessionRow& session : sessions_of(database, code, std::nullopt)) {
        sessions[session.id] = true;
    }
    for (const Statement& row : database.prepare(
             fmt::format("SELECT session_id FROM event WHERE {}", kTheirScores), code)) {
        sessions.emplace(row.integer(0), false);
    }
    for (const auto& each : sessions) {
        refuse_running(database, each.first);
    }
    return sessions;
}

/// @param consent  is taken away too
void destroy_notes(Database& database, std::string_view code, bool consent) {
    const std::string utc = note_time(database, code);
    database.run(
        "DELETE FROM participant_detail WHERE participant_id = (SELECT participant_id FROM "
        "participant WHERE participant_code = ?1)",
        code);
    database.run(fmt::format("UPDATE participant SET handedness = NULL, handedness_utc = NULL, "
                             "destroyed_utc = ?2{} WHERE participant_code = ?1",
                             consent ? ", consent = 0, consent_utc = ?2, refusals_utc = "
                                       "ltrim(coalesce(refusals_utc, '') || ' ' || ?2)"
                                     : ""),
                 code, utc);
}

}  // namespace

std::string withdraw_session(Database& database, std::int64_t session, const Reason& why) {
    Transaction all(database);
    if (const auto before = withdrawal(database, session)) {
        refuse(database, session, "is withdrawn already: " + *before);
    }
    refuse_running(database, session);
    std::string head = mark_session(database, session, why, {});
    all.commit();
    return head;
}

std::string undo_withdrawal(Database& database, std::int64_t session, const Reason& why) {
    Transaction all(database);
    if (is_destroyed(database, session)) {
        refuse(database, session, "was destroyed: nothing is left that could be analysed");
    }
    if (!withdrawal(database, session)) {
        refuse(database, session, "is not withdrawn: there is nothing to take back");
    }
    refuse_running(database, session);
    std::string head = mark_session(database, session, why, protocols::kUndone);
    all.commit();
    return head;
}

std::vector<MovedSession> move_sessions(Database& database,
                                        const std::vector<std::int64_t>& sessions,
                                        std::string_view code,
                                        const Reason& why) {
    Transaction all(database);
    std::vector<MovedSession> moved;
    for (const std::int64_t session : sessions) {
        moved.push_back(move_session(database, session, code, why));
    }
    all.commit();
    return moved;
}

void destroy_participant(Database& database,
                         std::string_view code,
                         Destroy what,
                         const Reason& why) {
    const std::string foreign = ordered_elsewhere(database.connection());
    refuse_if(!foreign.empty(),
              "{}: {} is ordered by a rule of another program, so that the file cannot be written "
              "anew without what is destroyed: drop it, and try again",
              database.file(), foreign);
    {
        Transaction all(database);
        database.execute("PRAGMA defer_foreign_keys = ON");
        const std::map<std::int64_t, bool> sessions = idle_sessions(database, code);
        const bool everything = what == Destroy::everything;
        destroy_notes(database, code, everything);
        for (const auto& [session, theirs] : sessions) {
            if (!is_destroyed(database, session)) {
                destroy_in(database, session, code, everything && theirs, why);
            }
        }
        all.commit();
    }
    try {
        empty_free_pages(database);
    } catch (const StoreError& e) {
        throw StoreError(fmt::format(
            "what was to be destroyed of {} is gone from {}, but its free pages may still hold it: "
            "the file could not be written anew ({}); when it can be, run this again",
            code, database.file(), e.what()));
    }
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

void empty_free_pages(Database& database) {
    database.execute("VACUUM");
    database.checkpoint();
}

}  // namespace palpate::data
