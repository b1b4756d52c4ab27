#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "protocols/design/plan.hpp"
#include "protocols/order/constrained_order.hpp"
#include "protocols/protocol/protocol.hpp"

/// What a plan holds, counted, for whoever wants to check it before it runs.
namespace palpate::protocols {

/// A part of the session whose counts are to be balanced.
struct PlanPart {
    Phase phase = Phase::main;
    std::size_t block = 0;

    friend auto operator<=>(const PlanPart&, const PlanPart&) = default;
};

/// What can be counted in a plan.
struct PlanSummary {
    std::map<PlanPart, std::map<Condition, std::size_t>> counts;
    /// Longest runs among the main trials, catch trials left out, as the limits count them.
    std::size_t longest_object_run = 0, longest_friction_run = 0;
    /// [from][to]: how often a level follows another among the main trials, catch trials left out.
    std::map<std::size_t, std::map<std::size_t, std::size_t>> object_steps, friction_steps;
    std::vector<std::size_t> breaks;  ///< positions that a break comes before
};

/// Counts a plan. Runs and steps go on from a block into the next.
[[nodiscard]] PlanSummary summarise(const Plan& plan);

/// What a protocol cannot say of a trial: how quick a person is. Guesses, to be named with the
/// result.
inline constexpr double kReadySeconds = 2.0;   ///< to bring the handle to the start pose
inline constexpr double kChoiceSeconds = 3.0;  ///< to choose among the pictures, or say how sure
/// Of a trial: to answer its question, and to say how sure one is where that is asked.
[[nodiscard]] double choice_seconds(const Protocol& protocol) noexcept;

/// How long the screen says right or wrong, s.
inline constexpr double kFeedbackSeconds = 1.0;

/// How long a session takes, s, without instructions and without trials that are run again.
struct Duration {
    double shortest = 0.0;  ///< every trial felt for explore_min, no time for ready and choice
    double prompted = 0.0;  ///< felt until explore_prompt, with kReadySeconds and choice_seconds()
    double longest = 0.0;   ///< every trial felt until explore_timeout, else as prompted
};

/// A trial is ready + force in + explore + force out + choice, and feedback where it is given. A
/// break, break_min, or a gap stands between two of them.
[[nodiscard]] Duration duration_of(const Plan& plan, const Protocol& protocol);

/// What share of all shuffles keeps the run limits.
struct Acceptance {
    double share = 1.0;
    bool exact = true;        ///< a count divided by a count; else an estimate
    double error = 0.0;       ///< of an estimate: its standard deviation, relative to `share`
    std::uint64_t draws = 0;  ///< of an estimate: proposals drawn
};

/// Exact for one limit, wherever it can be counted, and for two where OrderCounter takes both at
/// once. Else the exact share of what OrderSampler counts, times the share of its proposals that
/// are kept, drawn with a fixed seed: two calls agree.
/// @throws OrderError if the limits cannot be kept
[[nodiscard]] Acceptance acceptance_of(std::span<const Condition> trials, const RunLimits& limits);

/// The exact share of one factor alone; nothing beyond kMaxCounted trials.
[[nodiscard]] std::optional<double> acceptance_of_one(std::span<const Condition> trials,
                                                      std::size_t Condition::*factor,
                                                      std::size_t limit);

}  // namespace palpate::protocols
