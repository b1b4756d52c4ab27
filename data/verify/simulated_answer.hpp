#pragma once

#include <cstddef>

#include "data/verify/interval_check.hpp"

namespace palpate::data {

/// What the simulated observer answers to these ticks, and how fast, follows from protocol,
/// participant, session and seed: the answer, its confidence and reaction_s are computed again.
/// @param done  trials of the session before this attempt
void check_simulated_answer(const SessionFrame& frame,
                            const StoredRow& response,
                            std::span<const CheckedInterval> intervals,
                            std::size_t done,
                            Findings& findings);

}  // namespace palpate::data
