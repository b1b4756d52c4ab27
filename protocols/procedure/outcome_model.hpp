#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/psychometric/psychometric_function.hpp"

/// The psychometric function of QUEST+ (Watson 2017): for a stimulus x and parameters s, the
/// chances of all outcomes. Any number of stimulus dimensions, parameters and outcomes.
namespace palpate::protocols {

/// What the parameter of steepness in a model's grid means; its name says it.
enum class SlopeAs : std::uint8_t {
    slope,        ///< b of Family
    log10_slope,  ///< log10 b, as Kontsevich & Tyler 1999 space it
    sd            ///< 1 / b: the standard deviation of the family "normal"
};
inline constexpr std::array<std::string_view, 3> kSlopeWords{"slope", "log10_slope", "sd"};

/// P(outcome | x, s): how an answer depends on the stimulus and on the parameters to estimate.
struct OutcomeModel {
    std::vector<std::string> stimulus;    ///< names of the dimensions of x, in order
    std::vector<std::string> parameters;  ///< names of s, in order
    std::size_t outcomes = 2;             ///< 0 ... outcomes - 1
    /// Writes the chances of all outcomes at x for s: `outcomes` numbers that add up to 1.
    /// @throws std::invalid_argument if s is out of its range
    std::function<void(
        std::span<const double> x, std::span<const double> s, std::span<double> chances)>
        chances{};
    /// Of a psychometric_model.
    struct Shape {
        Family family = Family::normal;
        LapseForm form = LapseForm::upper;
        SlopeAs slope_as = SlopeAs::slope;
    };
    std::optional<Shape> shape{};
};

/// A yes/no or correct/wrong answer: outcome 1 with the chance of a psychometric function of
/// (threshold, slope, guess, lapse); with the two-sided form (threshold, slope, lapse). Stimulus:
/// one dimension, "stimulus".
[[nodiscard]] OutcomeModel psychometric_model(Family family,
                                              LapseForm form,
                                              SlopeAs slope_as = SlopeAs::slope);

/// b of Family for a value of the parameter of steepness.
[[nodiscard]] double slope_of(SlopeAs as, double value);

/// As psychometric_model, with a threshold that depends on a second stimulus dimension, "covariate"
/// (such as a friction coefficient): threshold + tilt * covariate. Parameters (threshold, tilt,
/// ...).
[[nodiscard]] OutcomeModel covariate_model(Family family,
                                           LapseForm form,
                                           SlopeAs slope_as = SlopeAs::slope);

/// Which of m known items was it? The percept of x is x + bias + noise * N(0, 1); the observer
/// names the item whose value is nearest (criteria midway between neighbours), and with the chance
/// `lapse` any of the m at random:
///
///     P(j | x) = lapse / m + (1 - lapse) (Phi(z_j) - Phi(z_(j-1))),  z_j = (c_j - x - b) / noise
///
/// with c_j = (v_j + v_(j+1)) / 2 between and infinite outside. Stimulus: one dimension,
/// "stimulus"; parameters (noise, bias, lapse). An ideal observer of an identification experiment;
/// Thurstone's law of categorical judgement with fixed criteria.
/// @param alternatives  v, increasing, at least 2
/// @throws std::invalid_argument for other alternatives
[[nodiscard]] OutcomeModel identification_model(const std::vector<double>& alternatives);

}  // namespace palpate::protocols
