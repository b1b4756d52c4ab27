#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "protocols/order/constrained_order.hpp"

namespace palpate::protocols {

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
