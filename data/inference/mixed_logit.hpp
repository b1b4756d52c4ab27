#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "data/statistics/solve.hpp"

/// Logistic mixed model of two conditions: correct ~ friction + (friction | subject).
///
///   logit P(person i, condition c) = b0 + b1 c + s0 + s1 c,  (s0, s1) ~ normal(0, L L'),  c = 0, 1
///
/// L = ((l11, 0), (l21, l22)), so that no estimate of a covariance is out of range. What a trial
/// was besides does not enter: a person's answers are four counts. The integral over (s0, s1) of
/// each person is taken about its maximum, with q x q nodes of Gauss and Hermite scaled by the
/// curvature there (J. C. Pinheiro, D. M. Bates, J. Comput. Graph. Stat. 4:12, 1995): 1 node is
/// Laplace's approximation, as R's lme4::glmer takes it.
namespace palpate::data {

/// How often a person answered, and how often with 1, in both conditions.
struct TwoCounts {
    std::array<double, 2> n{};
    std::array<double, 2> k{};
};

/// -2 log-likelihood at a point. @param l  l11, l21, l22
[[nodiscard]] double mixed_deviance(std::span<const TwoCounts> people,
                                    double b0,
                                    double b1,
                                    const std::array<double, 3>& l,
                                    const Nodes& nodes);

/// Which of the model's numbers are fitted, and how exactly it is integrated.
struct MixedSpec {
    bool effect = true;  ///< b1 is fitted; false: 0
    bool slope = true;   ///< s1 is; false: 0, people differ in one number
    int nodes = 1;       ///< a side, 1 .. 40
    bool errors = true;  ///< standard errors, and the last digits of all; false: for simulations
};

/// A maximum of the approximated likelihood.
struct MixedFit {
    MixedSpec spec{};
    double intercept = 0.0;  ///< b0, logit
    double effect = 0.0;     ///< b1, logit
    /// Of b0 and b1, from the observed information of all parameters; nothing where that says
    /// nothing.
    std::optional<double> intercept_se{};
    std::optional<double> effect_se{};
    double sd_intercept = 0.0;  ///< of s0 over people
    double sd_slope = 0.0;      ///< of s1
    /// Of s0 and s1; nothing where one of them does not vary.
    std::optional<double> correlation{};
    double log_likelihood = 0.0;
    /// The covariance has lost a rank: some combination of s0 and s1 does not vary (|l11| or |l22|
    /// below 1e-4, as lme4's isSingular takes it).
    bool singular = false;
    /// |b0| or |b1| beyond 10 logits: no answer of the other kind in a condition. Then b1 has no
    /// end, and in the first case b0 neither; the likelihood has one, and so have its ratios.
    bool unbounded = false;
    bool intercept_unbounded = false;
    bool converged = false;
    std::array<double, 3> l{};  ///< l11, l21, l22
};

/// The highest of three maxima (BFGS with central differences from a small, a middle and a large
/// spread), polished by Newton's steps. Where `from` is given it is the only start.
/// @pre one person or more, n > 0 in both conditions for somebody
[[nodiscard]] MixedFit fit_mixed(std::span<const TwoCounts> people,
                                 const MixedSpec& spec,
                                 const MixedFit* from = nullptr);

/// Twice the loss of log-likelihood, never below 0.
[[nodiscard]] double likelihood_ratio(const MixedFit& full, const MixedFit& less);

/// The p of no variance of s1 (and no covariance): on the boundary the ratio is half chi-square of
/// 1 df, half of 2 (S. G. Self, K.-Y. Liang, J. Am. Stat. Assoc. 82:605, 1987; D. O. Stram, J. W.
/// Lee, Biometrics 50:1171, 1994).
[[nodiscard]] double slope_variance_p(double ratio);

/// A likelihood ratio against those of samples drawn without the effect.
struct SimulatedNull {
    std::size_t samples = 0;
    double p =
        1.0;  ///< share of ratios, the data's own counted as one, at least as high as the data's
};

/// The likelihood ratio of b1 = 0 under answers drawn from `null`, the fit without the effect, in
/// which people differ as fitted: its true distribution for so few people, where chi-square is one
/// for many. Laplace fits.
/// @param stream  sample s is drawn with PCG32 (seed, stream + s): any number of threads gives the
/// same
[[nodiscard]] SimulatedNull simulate_null(std::span<const TwoCounts> people,
                                          const MixedFit& null,
                                          double ratio,
                                          std::size_t samples,
                                          std::uint64_t seed,
                                          std::uint64_t stream);

}  // namespace palpate::data
