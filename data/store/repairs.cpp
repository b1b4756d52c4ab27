#include "data/store/repairs.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "protocols/session/progress.hpp"
#include "data/store/destruction.hpp"
#include "data/store/people.hpp"
#include "data/store/session_lock.hpp"

namespace palpate::data {
namespace {

/// "P03's session 1"
std::string called(Database& database, std::int64_t session) {
    Statement row = database.first(
        "SELECT participant_code, session_number FROM session JOIN participant USING "
        "(participant_id) WHERE session_id = ?1",
        session);
    return fmt::format("session {} of {}", row.integer(1), row.text(0));
}

[[noreturn]] void refuse(Database& database, std::int64_t session, std::string_view why) {
    throw std::invalid_argument(
        fmt::format("{}: {} {}", database.file(), called(database, session), why));
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
    if (!find_participant(database, code)) {
        throw std::invalid_argument(fmt::format(
            "{}: nobody is called {}: palpate participant FILE {} --new registers them first",
            database.file(), code, code));
    }
    if (is_destroyed(database, session)) {
        refuse(database, session, "was destroyed");
    }
    refuse_running(database, session);
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

MovedSession move_session(Database& database,
                          std::int64_t session,
                          std::string_view code,
                          const Reason& why) {
    Transaction all(database);
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
    all.commit();
    return moved;
}

}  // namespace palpate::data
