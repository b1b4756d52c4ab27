#pragma once

#include <cstdint>
#include <optional>
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

}  // namespace palpate::data
