#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "data/store/chain.hpp"
#include "data/store/database.hpp"

/// What people set right of whole sessions: each an event under the seal, so that nothing is
/// erased.
namespace palpate::data {

/// Analyses and exports leave the session out, for this reason, and it is never resumed. @return
/// the new head
/// @throws std::invalid_argument if that is so already, or while a program runs it
std::string withdraw_session(Database& database, std::int64_t session, const Reason& why);

/// Takes that back. @throws std::invalid_argument if it is not withdrawn, or while a program runs
/// it
std::string undo_withdrawal(Database& database, std::int64_t session, const Reason& why);

/// A session that became another's.
struct MovedSession {
    std::int64_t number = 0;  ///< of the participant's sessions, from now on
    bool finished = false;
    bool as_run = false;  ///< it is as it was run again
    std::string head;
};

/// The sessions were run under a wrong code and count as those of `code`, everywhere, each with its
/// own number where that is free and else the next one, all or none. Their orders stay those that
/// were drawn for the code under which they were run. Moved back, they are as they were.
/// @throws std::invalid_argument if nobody is called `code`, if one is theirs already, or while a
/// program runs one
std::vector<MovedSession> move_sessions(Database& database,
                                        const std::vector<std::int64_t>& sessions,
                                        std::string_view code,
                                        const Reason& why);

// -------------------------------------------------------------------------------------------------
// What is destroyed because a participant wants it: the only rows that this program ever deletes.

/// How much.
enum class Destroy {
    details,  ///< handedness, and what else was asked
    /// These, and all of each session but that it was, when, and with which newest seal.
    everything,
};

/// Destroys it, in the file's free pages too. Pseudonym and number stay, so that neither is given
/// again, and each session has an event that says it, with the newest seal that it had. Of
/// `everything` this event is all that its chain still links; consent is noted as no. Copies,
/// exports and servers are others' to look after.
/// @throws std::invalid_argument if nobody is called so, or while a program runs a session of
/// theirs
void destroy_participant(Database& database,
                         std::string_view code,
                         Destroy what,
                         const Reason& why);

/// Deletes all that belongs to a session, but not its own row. In the caller's transaction, with
/// deferred foreign keys.
void clear_session(Database& database, std::int64_t session);

/// Writes the file anew without what was deleted.
void empty_free_pages(Database& database);

}  // namespace palpate::data
