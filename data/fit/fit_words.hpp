#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "data/fit/fit_report.hpp"
#include "data/tables/table.hpp"

/// What the table for people and the JSON for programs say alike.
namespace palpate::data {

/// As protocol files and --family have it.
[[nodiscard]] std::string_view word_of(protocols::Family family);
/// "threshold", "slope b"; of at_share "stimulus at a share".
[[nodiscard]] std::string_view word_of(Quantity quantity);
/// "free", "0.02 (given)".
[[nodiscard]] std::string rate_text(bool free, double value);
/// "free, one for all conditions of a person" too, as the next.
[[nodiscard]] std::string guess_text(const CurveSpec& spec);
[[nodiscard]] std::string lapse_text(const CurveSpec& spec);
/// "threshold ~ normal: mean, sd (5, 2), lapse ~ beta(2, 50)"; empty without priors.
[[nodiscard]] std::string priors_text(const CurveSpec& spec);
[[nodiscard]] std::int64_t answers_of(const FittedCurve& curve);
/// Half of the answers or more stand alone at their stimulus: then the deviance is of the fitted
/// chances alone.
[[nodiscard]] bool single_answers(const FittedCurve& curve);
inline constexpr std::string_view kNoGoodness =
    "no goodness of fit: the deviance of single answers says next to nothing of it; group them by "
    "stimulus";
/// What a reader should know before the numbers are believed.
[[nodiscard]] std::vector<std::string> warnings_of(const FitReport& report,
                                                   const FittedCurve& curve);

/// The quantities of a curve, a row each.
[[nodiscard]] Table estimates_table(const FitReport& report, const FittedCurve& curve);
/// Of each participant, what a condition has more than the first: a row a quantity.
[[nodiscard]] Table differences_table(const FitReport& report);

}  // namespace palpate::data
