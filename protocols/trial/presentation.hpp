#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "protocols/design/plan.hpp"
#include "protocols/protocol/protocol.hpp"

namespace palpate::protocols {

/// What one interval of a trial lets one feel, in numbers. A trial has one interval, or two that
/// are compared.
struct Presentation {
    std::size_t interval = 1;  ///< of the trial, 1 or 2
    ObjectSpec object{};       ///< with the curvature that is felt
    FrictionSpec friction{};   ///< with the coefficients that are felt
    /// What the rule chose, as it counts; none where it chose nothing: the standard, a factorial
    /// design.
    std::optional<double> stimulus{};

    friend bool operator==(const Presentation&, const Presentation&) = default;
};

/// What a rule's choice lets one feel, in place of the protocol's: curvature, coefficients or
/// compliance.
void feel_stimulus(const AdaptiveSpec& spec, double stimulus, Presentation& felt);

/// What a rule varies of it, in the unit of the key: 1/m, mu_s, or mm/N.
[[nodiscard]] double varied_value(const AdaptiveSpec& spec, const Presentation& felt);

/// The intervals of a planned trial in order.
/// @param stimulus  what the rule chose, for trials of a rule
/// @throws std::invalid_argument for a stimulus without a rule, or a rule without one
[[nodiscard]] std::vector<Presentation> presentations_of(const Protocol& protocol,
                                                         const PlannedTrial& planned,
                                                         std::optional<double> stimulus = {});

}  // namespace palpate::protocols
