#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace palpate::protocols {

/// What a procedure says of one quantity so far.
struct Estimate {
    std::string name;            ///< threshold, slope, ...; the staircase's name
    std::optional<double> mean;  ///< of the posterior, or of a staircase's last reversals
    std::optional<double> mode;  ///< of the posterior
    std::optional<double> sd{};  ///< of the posterior; of those reversals, n - 1 below
    /// 95 % credible: the least values with 2.5 % and 97.5 % of the posterior at or below them, so
    /// that it holds 95 % or more. None of a staircase.
    std::optional<double> low{};
    std::optional<double> high{};
    bool cut = false;  ///< it ends where the posterior's grid does: there may be more beyond
    std::size_t reversals = 0;  ///< of a staircase: how many the mean is of

    friend bool operator==(const Estimate&, const Estimate&) = default;
};

/// A value of a quantity, and the share of the posterior that it has.
using Weighed = std::pair<double, double>;

/// sd, low, high and cut of a posterior; its mean too.
/// @param values  increasing; the shares add up to 1
[[nodiscard]] Estimate belief(std::string name, std::span<const Weighed> values);

}  // namespace palpate::protocols
