#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace palpate::data {

/// What is pushed, and whereto.
struct PushChoice {
    bool insecure = false;           ///< Postgres
    bool including_refused = false;  ///< also the sessions of who is noted as not consenting
};

/// What a push did.
struct PushReport {
    std::size_t sessions = 0;   ///< looked at
    std::size_t declined = 0;   ///< of these: left out, of people who do not consent
    std::size_t withdrawn = 0;  ///< of these: withdrawn, and on the server all the same
    std::int64_t rows = 0;      ///< added
    std::string way;            ///< Postgres::way()
    std::vector<std::string>
        conflicts;  ///< what the server says differently: nothing of it was added
};

/// Adds what the server does not have yet of a file: sessions with their plans, every attempt that
/// ended with its chunks as they are, events, ends, studies, handedness and consent. The file is
/// only read. Of who is noted as not consenting, here or on the server, nothing is sent, and
/// nothing taken away that is there: only an administrator can. An attempt and all that belongs to
/// it is one transaction, so that a push that was cut off left whole attempts behind, and the next
/// one goes on. Pushing twice is pushing once.
///
/// Makes the schema `palpate` if it is not there and the user may, and adds again what somebody
/// took away: rows are counted. Values that somebody changed beside a hash are not seen, but for
/// those of a study and of trace_column. In conflict are these, a session whose beginning, an
/// attempt or an event that the server has otherwise, a study, participant and number that are
/// there under another uuid (by the last event that says whose a session is; not if the session
/// itself is there too, or the file has both), a participant's handedness, consent where somebody
/// refused it before, and a session whose chain of hashes does not hold (data/store/chain.hpp):
/// damaged, or edited by hand. Of who does not consent nothing is added but that they do not, as a
/// row beside that of a yes before, and which sessions are theirs; a session or a handedness of
/// theirs that is there is a conflict, and so is a handedness that was destroyed here. That
/// something was destroyed is sent, and what a file that does not know of it has of that person is
/// not. The server has each session as it was run: whose it is really, and that it was withdrawn,
/// its events say.
/// @throws std::invalid_argument for a wrong URL, or without libpq
/// @throws StoreError if the file says otherwise than this program how ticks are written
/// @throws PostgresError if the server fails: what was added stays
[[nodiscard]] PushReport push_file(const std::string& file,
                                   const std::string& url,
                                   PushChoice choice = {});

/// SQL for an administrator: postgres_schema() and postgres_roles().
[[nodiscard]] std::string push_setup();

}  // namespace palpate::data
