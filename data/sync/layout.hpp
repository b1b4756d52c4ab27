#pragma once

#include <string>
#include <vector>

#include "data/store/database.hpp"

/// What belongs to what in a palpate database, read from the catalogue, so that files can be
/// brought together whatever tables a later schema adds. What somebody added to a file is theirs:
/// it goes nowhere.
namespace palpate::data {

/// A table whose rows belong to one session or trial.
struct OwnedTable {
    std::string name;
    std::vector<std::string> columns;  ///< without the owner's

    /// "a, b, c"
    [[nodiscard]] std::string list() const;
    /// SELECT list() of the owner ?1, in an order that depends on the content alone.
    [[nodiscard]] std::string select(std::string_view owner) const;
    /// INSERT of the owner ?1 and list() from ?2 on.
    [[nodiscard]] std::string insert(std::string_view owner) const;
};

/// What belongs to what, so that it can be copied into another file.
struct Layout {
    std::vector<OwnedTable> of_session;  ///< plan, picture, ...: set before the first trial
    std::vector<OwnedTable> of_trial;    ///< response, trace_chunk, ...
    std::vector<OwnedTable> of_file;     ///< trace_column: nobody's, the same in every file; secret
    /// Set before the first trial: without session_id, study_id, participant_id, newest_seal.
    OwnedTable session;
    OwnedTable session_end;      ///< set when it finished
    OwnedTable session_repairs;  ///< set by events later: whose it is, whether it is left out
    OwnedTable trial;            ///< without trial_id, session_id, invalid_reason
    OwnedTable event;            ///< without event_id, session_id, trial_id
};

/// By the catalogue of this program.
[[nodiscard]] Layout catalogue_layout();

/// Binds all columns of `from`'s row to `to`, the first to parameter `first`.
void bind_row(const Statement& from, Statement& to, int first);

}  // namespace palpate::data
