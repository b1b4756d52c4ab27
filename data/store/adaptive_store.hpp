#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocols/session/adaptive_runs.hpp"
#include "data/store/database.hpp"

/// Rules that choose stimuli: what is stored of them, and how they are built again.
namespace palpate::data {

/// {"threshold":{"mean":5.1,"mode":5},...} as adaptive_step.estimates has it; numbers as short as
/// can be.
[[nodiscard]] std::string estimates_text(const std::vector<protocols::Estimate>& estimates);

/// The rules of a session by the answers that count at the end, stored states unchecked: what is
/// stored beside an answer took in those that were marked after it.
/// @throws std::exception if the session, its protocol or an answer is not what a rule takes
[[nodiscard]] protocols::AdaptiveRuns runs_that_count(Database& database, std::int64_t session);

/// A run of a session as palpate procedure reads it.
struct ExportedRun {
    std::string
        procedure;  ///< a procedure file: the protocol's rule, and where the run's stream begins
    std::string responses;  ///< CSV: stimulus,response, in the order of the answers
};

/// Answers that were marked later are left out: what is replayed is the rule as it stands at the
/// end.
/// @param run  from 0
/// @throws StoreError if there is no such session or run
[[nodiscard]] ExportedRun exported_run(Database& database, std::int64_t session, std::int64_t run);

}  // namespace palpate::data
