#pragma once

#include <array>
#include <span>
#include <vector>

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

/// Nodes and weights of the integral of e^(-z^2) f(z) (Gauss-Hermite).
struct Nodes {
    std::vector<double> at{};
    std::vector<double> weight{};
};
/// By Golub and Welsch (Math. Comput. 23:221, 1969). @pre 1 <= count <= 40
[[nodiscard]] Nodes gauss_hermite(int count);

/// -2 log-likelihood at a point. @param l  l11, l21, l22
[[nodiscard]] double mixed_deviance(std::span<const TwoCounts> people,
                                    double b0,
                                    double b1,
                                    const std::array<double, 3>& l,
                                    const Nodes& nodes);

}  // namespace palpate::data
