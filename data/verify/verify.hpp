#pragma once

#include "data/store/database.hpp"
#include "data/verify/finding.hpp"

namespace palpate::data {

/// Recomputes all that a database says and that follows from something else in it, and says what differs.
/// Changes nothing: give a database opened to read. Sees one moment of it, also while a session runs.
///
/// - SQLite's integrity_check and foreign_key_check, the table trace_column.
/// - The protocol's hash from its text, the plan from protocol, participant, session, seed and row of
///   pictures, the hashes of the objects' geometry, the calibration's hash from its text.
/// - Every trial: its turn, attempt and outcome, every bit of its chunks, its ticks without a gap; every
///   force, GO, CP, mu and mode from the recorded HIP, to the bit, with the stored slip_decay and
///   heal_decay; the columns added up from its ticks; object and correct of the answer from its place;
///   fault_tick from the trace. Of a simulated answer place and reaction_s too.
///
/// What a session of an older program does not hold is said to be missing, not wrong. Such a session is one
/// without a build id in session_provenance.
///
/// What cannot be noticed here, because nothing else in the file says it:
/// - times: *_utc; of a person's trial done_s, done_uncertainty_s, reaction_s and uncertainty_s within
///   their ranges; complete instead of timed_out;
/// - an answer of a person changed as a whole (place, object and correct together), or its input;
/// - kind (real or pilot), uuid, device, operator, provenance other than hashes, the texts of events;
/// - what was noted of a participant; a mark of an answer removed together with its event;
/// - the last whole chunks of an interrupted trial, its last attempts, or a whole last session removed;
/// - in a chunk packed again with a right crc32: counts, codes, lateness, commands and flags of the safety
///   chain, and HIP with all that follows from it;
/// - a bit of a chunk that unpacks to the same ticks (padding, another way to say a run), where another zlib
///   packed the trial, or it is the only chunk; the sign of zero, a slip_decay or heal_decay within the error of exp() in a trial that does
///   not use it.
/// Whoever can write the file can also write it consistently: a seal against that needs a hash kept
/// elsewhere.
[[nodiscard]] Verification verify(Database& database);

}  // namespace palpate::data
