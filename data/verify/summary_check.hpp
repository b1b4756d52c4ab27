#pragma once

#include <optional>
#include <span>
#include <vector>

#include "protocols/session/recorder.hpp"
#include "data/verify/interval_check.hpp"

namespace palpate::data {

/// The columns of a trial that ended and of its intervals, added up again from its ticks.
///
/// How many ticks were felt (the rest is the ramp out of the force) is known where the clock was
/// virtual; on a real one the stored number is believed as far as a whole ramp stands behind it.
/// @param force  the device of the trial gives some
/// @return what was felt of each interval; nothing where ticks are missing
std::vector<protocols::TrialSummary> check_summary(const SessionFrame& frame,
                                                   const StoredRow& trial,
                                                   std::span<const CheckedInterval> intervals,
                                                   bool answered_by_numbers,
                                                   bool force,
                                                   Findings& findings);

/// Why an answer does not count: by the rules of [invalid], or because somebody marked it.
/// @param mark  the reason of its mark, if it has one @param felt of each interval, from
/// check_summary()
void check_invalid(const SessionFrame& frame,
                   const StoredRow& trial,
                   const std::optional<std::string>& mark,
                   std::span<const protocols::TrialSummary> felt,
                   Findings& findings);

/// The rows of fault_tick: the last ticks of the last interval, at most 100, for a faulted trial;
/// none else.
/// @param rows  of the trial, by tick
void check_fault_ticks(std::span<const StoredRow> rows,
                       const StoredRow& trial,
                       const StoredTrace& last,
                       Findings& findings);

}  // namespace palpate::data
