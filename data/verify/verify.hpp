#pragma once

#include "data/store/database.hpp"
#include "data/verify/finding.hpp"

namespace palpate::data {

/// Recomputes all that a database says and that follows from something else in it, and says what differs.
/// Changes nothing: give a database opened to read. Sees one moment of it, also while a session runs.
///
/// - SQLite's integrity_check and foreign_key_check, the table trace_column; every table, index and view of
///   palpate's word by word, CHECKs included; that no trigger stands on a table of palpate and nothing called
///   sample hides the ticks; that the file has its secret, and the numbers of people in exports follow from
///   one.
/// - The protocol's hash from its text, the plan from protocol, participant, session, seed and row of
///   pictures, the hashes of the objects' geometry, the calibration's hash from its text.
/// - Every trial: its turn, attempt and outcome, every bit of its chunks, its ticks without a gap; every
///   force, GO, CP, mu and mode from the recorded HIP, to the bit, with the stored slip_decay and
///   heal_decay; the columns added up from its ticks; object and correct of the answer from its place;
///   fault_tick from the trace. Of a simulated answer place and reaction_s too.
///
/// - The chain of hashes (data/store/chain.hpp): any edit of a session's rows, marks and notes made later
///   included, that was not followed by making all later heads again; that what is noted of a participant's
///   handedness and consent is what events of their sessions say; of a session that was destroyed on request, that
///   nothing but the mark that says so is left.
///
/// What cannot be noticed here, because nothing else in the file says it:
/// - whatever was made again consistently, heads too: compare the last head with the one in the lab book;
/// - the last trials, marks or notes of a session removed, and session.head set back to the head before them; a
///   whole session removed. The lab book shows the first;
/// - a detail of a participant; handedness and consent of somebody without a session, or noted before them, or
///   edited together with the time when they were noted;
/// - the sign of zero, a bit of an unused page of the file.
/// Whoever can write the file can also write it consistently: a seal against that is a head kept elsewhere.
[[nodiscard]] Verification verify(Database& database);

}  // namespace palpate::data
