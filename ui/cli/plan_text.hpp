#pragma once

#include <string>

#include "protocols/design/plan_summary.hpp"
#include "protocols/protocol/protocol.hpp"

/// A plan in counts, for people: what `palpate sequence` and `palpate check` print of it. Whole
/// lines.
namespace palpate::ui {

/// Longest runs, how few shuffles keep the limits, and how the order was found.
[[nodiscard]] std::string limits_text(const protocols::Protocol& protocol,
                                      const protocols::Plan& plan,
                                      const protocols::PlanSummary& summary);

/// Before which trials a break comes, counted from 1.
[[nodiscard]] std::string breaks_text(const protocols::PlanSummary& summary);

/// Trials of each condition by phase and block.
[[nodiscard]] std::string counts_text(const protocols::Protocol& protocol,
                                      const protocols::PlanSummary& summary);

/// How often a level follows another, objects first, then frictions.
[[nodiscard]] std::string steps_text(const protocols::Protocol& protocol,
                                     const protocols::PlanSummary& summary);

/// What the objects that yield promise; empty where none does.
[[nodiscard]] std::string softness_text(const protocols::Protocol& protocol);

/// Of a plan whose stimuli a rule chooses: the rule, and the trials of each run by phase and
/// interval.
[[nodiscard]] std::string rule_text(const protocols::Protocol& protocol,
                                    const protocols::Plan& plan);

}  // namespace palpate::ui
