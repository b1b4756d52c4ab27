#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "data/store/database.hpp"

/// A chain of SHA-256 hashes through a session: each trial that ended carries the head that its end made.
/// Who edits anything before a head has to recompute it and all later ones; a head noted in a lab book shows
/// that too.
///
/// The first link hashes what a session is before its first trial: its row without `finished` and the like,
/// protocol hash and participant's pseudonym, provenance, plan and pictures. Each next one hashes the head
/// before it, the trial's row, its rows in every other table (of a trace chunk's data their SHA-256), and the
/// session's events since the head before. A last one, at the end of the session, its row and its events.
/// Row numbers are in none of them: files may be merged. NULLs neither: a later schema may have more columns.
/// What is noted of an answer later (`mark`) is an event, and trial.invalid goes in as it was at the end.
namespace palpate::data {

/// Writes the head of a trial that has just got its outcome. In the caller's transaction, as its last words.
void chain_trial(Database& database, std::int64_t trial);
/// The same for the end of a session.
void chain_session(Database& database, std::int64_t session);

/// The last head of a session; empty: it has none yet.
[[nodiscard]] std::string chain_head(Database& database, std::int64_t session);

struct ChainBreak {
    std::int64_t trial = 0;  ///< 0: of the session's own row
    std::string stored;
    std::string recomputed;
};

/// Every head that is not what its session's rows give.
[[nodiscard]] std::vector<ChainBreak> chain_breaks(Database& database, std::int64_t session);

}  // namespace palpate::data
