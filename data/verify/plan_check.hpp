#pragma once

#include "data/verify/trial_check.hpp"

namespace palpate::data {

/// Draws the plan again from protocol, participant, session, seed and the stored row of pictures,
/// and compares it with the stored rows, plan_sha256 and shuffles. Sets the frame's plan: the one
/// drawn.
/// @return false if there is no plan to check trials against
[[nodiscard]] bool check_plan(Database& database,
                              const StoredRow& session,
                              SessionFrame& frame,
                              Findings& findings);

}  // namespace palpate::data
