#pragma once

#include <cstddef>
#include <vector>

#include "protocols/observer/person.hpp"
#include "ui/session/simulated_session.hpp"

namespace palpate::ui {

/// What hands of simulated people feel in the main trials of a study: of each whole session,
/// without practice, catch trials and breaks, every trial that counts. Nothing is recorded. In the
/// order of people and trials, whatever the number of threads.
/// @throws as SimulatedSession; std::runtime_error if it was interrupted or a force went off
[[nodiscard]] std::vector<protocols::FeltTrial> felt_hands(const SimulatedStudy& study,
                                                           std::size_t people,
                                                           std::size_t threads);

}  // namespace palpate::ui
