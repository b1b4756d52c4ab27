#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "data/store/chain.hpp"
#include "data/store/database.hpp"

/// What people note by hand: of participants, of sessions, and of answers that do not count after
/// all.
namespace palpate::data {

/// Nothing in a field: not known, or not to be changed.
struct ParticipantNotes {
    std::optional<std::int64_t> handedness{};  ///< Edinburgh score, -100 left to 100 right
    std::optional<bool> consent{};
    std::vector<std::pair<std::string, std::string>> details{};  ///< key [a-z0-9_]{1,64}, value
};

/// What is noted of a participant now.
struct Participant {
    ParticipantNotes notes{};
    std::string consent_utc;    ///< when consent was noted; empty: it was not
    std::string destroyed_utc;  ///< when all that was noted was destroyed; empty: it was not
    std::int64_t sessions = 0;  ///< begun, of any study
    std::int64_t subject = 0;   ///< the number in exports
};

/// Nobody of that pseudonym is known: nothing.
[[nodiscard]] std::optional<Participant> find_participant(Database& database,
                                                          std::string_view code);

/// Somebody known whose code could be meant by `code`: it differs in upper and lower case, in - and
/// _, or in leading zeros only, as P03 and p-3. Nobody where `code` itself is known.
[[nodiscard]] std::optional<std::string> similar_participant(Database& database,
                                                             std::string_view code);

/// When something was last noted or destroyed, of this person or ("") of anybody; empty: never.
[[nodiscard]] std::string newest_note(Database& database, std::string_view code = {});

/// The time of what is noted of a person now: the clock's, but always after newest_note(), so that
/// notes keep their order where the clock was set back.
[[nodiscard]] std::string note_time(Database& database, std::string_view code);

/// Registers the participant if need be and notes what is given. What was noted before and is not
/// given stays; each has the note_time() when it was last noted. Each of the participant's sessions
/// that was not destroyed gets an event of each note, with that time: "handedness 80", "consent
/// yes", and of a detail its key alone (events go where details do not).
void note_participant(Database& database,
                      std::string_view code,
                      const ParticipantNotes& notes,
                      std::string_view operator_name = {});

/// Handedness and consent, as far as they are known, as events of a session that begins: who edits
/// them later contradicts its chain. In the caller's transaction.
void note_at_beginning(Database& database, std::int64_t session);

/// Where what is noted of a participant is not what the events of their sessions say: those since
/// the session is theirs.
struct NoteBreak {
    std::string what;    ///< "participant P01 handedness"
    std::string stored;  ///< in the participant's row
    std::string noted;   ///< by the last such event
    bool later = false;  ///< noted after it, or a refusal of another time: in a file that was
                         ///< merged, or by who edits the time as well
};
/// All of them; of a file that nobody tampered with none but later ones.
[[nodiscard]] std::vector<NoteBreak> note_breaks(Database& database);

/// A session in a list.
struct SessionRow {
    std::int64_t id = 0;
    std::string study;
    std::string version;  ///< the study's id and hash, as shapes@1a2b3c4d
    std::int64_t number = 0;
};

/// The sessions of a participant, the last begun first.
/// @param number, study  only those of this number and study, or version of one; "": of any
[[nodiscard]] std::vector<SessionRow> sessions_of(Database& database,
                                                  std::string_view code,
                                                  std::optional<std::size_t> number,
                                                  std::string_view study = "");

/// The session's rows were deleted (Destroy::everything).
[[nodiscard]] bool is_destroyed(Database& database, std::int64_t session);

/// An event "note" of the session. @return the new head of its chain
/// @throws std::invalid_argument for one that was destroyed
std::string add_note(Database& database,
                     std::int64_t session,
                     std::string_view text,
                     std::string_view operator_name = {});

/// What came of marking a trial.
struct MarkResult {
    bool finished = false;  ///< the session
    std::string head;       ///< of its chain, with the mark
};

/// The answer of a trial does not count, for this reason: it stays, and analyses leave it out.
/// Unless the session is finished, the position is run again when it is resumed.
/// @throws std::invalid_argument if there is no such trial, if it has no answer or does not count
///         already, or while a program runs its session, which goes by what it knows: the next
///         trials would contradict the mark
MarkResult mark_invalid(Database& database, std::int64_t trial, const Reason& why);

/// The mark of a trial is taken back, for this reason: its answer counts again, as if it had never
/// been marked.
/// @throws std::invalid_argument if there is no such trial, if it is not marked, while a program
///         runs its session, or where the session went on otherwise for the mark: another answer
///         counts in its place, its part was run again, or its rule went on without it
MarkResult undo_mark(Database& database, std::int64_t trial, const Reason& why);

// -------------------------------------------------------------------------------------------------
// What people set right of whole sessions: each an event under the seal, so that nothing is erased.

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
