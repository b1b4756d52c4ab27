#pragma once

#include <cstddef>

#include "data/verify/trial_check.hpp"

namespace palpate::data {

/// What the simulated observer answers to these ticks, and how fast, follows from protocol, participant,
/// session and seed: place and reaction_s of a simulated answer are computed again.
/// @param number  of the trial as the observer saw it, from 1
void check_simulated_answer(const SessionFrame& frame,
                            const StoredRow& trial,
                            const StoredRow& response,
                            const StoredTrace& trace,
                            std::size_t number,
                            Findings& findings);

}  // namespace palpate::data
