#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "data/store/database.hpp"
#include "data/verify/findings.hpp"

namespace palpate::data {

/// What nothing else in a file says, so that verify cannot notice it.
inline constexpr std::array<std::string_view, 5> kNotChecked{
    "rows made again or taken away together with all later seals, a whole session taken away: "
    "compare the newest "
    "seals with those in the lab book",
    "a participant's details, when handedness or consent was noted, consent refused before or "
    "something destroyed; handedness, consent and destruction of somebody without a session, or "
    "noted before it",
    "the secret of a file in which nothing was drawn yet",
    "tables, views and plain indices that somebody added",
    "the sign of zero, and bytes of the file that nothing uses"};

/// Recomputes all that a database says and that follows from something else in it, and says what
/// differs. Changes nothing: give a database opened to read. Sees one moment of it, also while a
/// session runs.
///
/// - SQLite's integrity_check and foreign_key_check, the table trace_column; the whole schema
///   (data/store/own_schema.hpp); that the file has its secret, and the numbers of people in
///   exports follow from one.
/// - The protocol's hash from its text, the plan from protocol, participant, session, seed and row
///   of pictures, the hashes of the objects' geometry, the calibration's hash from its text.
/// - Every trial: its turn, attempt and outcome, every bit of its chunks, its ticks without a gap;
///   every force, GO, CP, mu and mode from the recorded HIP, to the bit, with the stored slip_decay
///   and heal_decay; the columns added up from its ticks; object and correct of the answer from its
///   place; fault_tick from the trace. Of a simulated answer place and reaction_s too.
///
/// - The chain of hashes (data/store/chain.hpp): any edit of a session's rows, marks and notes made
///   later included, that was not followed by making all later heads again; that what is noted of a
///   participant's handedness, consent and destruction is what events of their sessions say; of a
///   session that was destroyed on request, that nothing but the mark that says so is left.
///
/// - That every secret but the file's own was used.
///
/// What it cannot notice says kNotChecked. Whoever can write the file can also write it
/// consistently: a seal against that is a head kept elsewhere.
[[nodiscard]] Verification verify(Database& database);

/// Of the libraries that this room alone uses, as they run: SQLite, zlib, nettle.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace palpate::data
