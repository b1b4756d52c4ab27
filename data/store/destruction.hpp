#pragma once

#include <cstdint>
#include <string_view>

#include "data/store/chain.hpp"
#include "data/store/database.hpp"

/// What is destroyed because a participant wants it: the only rows that this program ever deletes.
namespace palpate::data {

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

/// Its rows were deleted (Destroy::everything).
[[nodiscard]] bool is_destroyed(Database& database, std::int64_t session);

/// Writes the file anew without what was deleted.
void empty_free_pages(Database& database);

}  // namespace palpate::data
