#include "data/inference/mixed_logit.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <boost/math/distributions/chi_squared.hpp>

#include "engine/base/pcg32.hpp"
#include "engine/base/side_by_side.hpp"
#include "protocols/psychometric/exact_math.hpp"

namespace palpate::data {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// A function of the parameters that are fitted, in the order b0, b1, l11, l21, l22.
class Objective {
public:
    Objective(std::span<const TwoCounts> people, const MixedSpec& spec)
        : people_(people), spec_(spec), nodes_(gauss_hermite(spec.nodes)) {}

    [[nodiscard]] Eigen::Index size() const {
        return 2 + (spec_.effect ? 1 : 0) + (spec_.slope ? 2 : 0);
    }
    /// b0, b1, l11, l21, l22
    [[nodiscard]] std::array<double, 5> whole(const Vector& at) const {
        Eigen::Index i = 0;
        std::array<double, 5> all{};
        all[0] = at[i++];
        all[1] = spec_.effect ? at[i++] : 0.0;
        all[2] = at[i++];
        if (spec_.slope) {
            all[3] = at[i++];
            all[4] = at[i++];
        }
        return all;
    }
    [[nodiscard]] Vector part(const std::array<double, 5>& all) const {
        Vector at(size());
        Eigen::Index i = 0;
        at[i++] = all[0];
        if (spec_.effect) {
            at[i++] = all[1];
        }
        at[i++] = all[2];
        if (spec_.slope) {
            at[i++] = all[3];
            at[i++] = all[4];
        }
        return at;
    }
    /// Half of the deviance.
    [[nodiscard]] double operator()(const Vector& at) const {
        const auto all = whole(at);
        return 0.5 * mixed_deviance(people_, all[0], all[1], {all[2], all[3], all[4]}, nodes_);
    }

private:
    std::span<const TwoCounts> people_;
    MixedSpec spec_;
    Nodes nodes_;
};

Vector gradient_of(const Objective& f, const Vector& at) {
    constexpr double kStep = 1e-5;  // error 1e-10 of curvature, 1e-8 of rounding
    Vector gradient(at.size());
    Vector moved = at;
    for (Eigen::Index i = 0; i < at.size(); ++i) {
        moved[i] = at[i] + kStep;
        const double above = f(moved);
        moved[i] = at[i] - kStep;
        gradient[i] = (above - f(moved)) / (2.0 * kStep);
        moved[i] = at[i];
    }
    return gradient;
}

Matrix hessian_of(const Objective& f, const Vector& at) {
    constexpr double kStep = 1e-3;
    Matrix hessian(at.size(), at.size());
    const auto moved = [&](Eigen::Index i, double a, Eigen::Index j, double b) {
        Vector point = at;
        point[i] += a;
        point[j] += b;
        return f(point);
    };
    const double here = f(at);
    for (Eigen::Index i = 0; i < at.size(); ++i) {
        hessian(i, i) =
            (moved(i, kStep, i, 0.0) - 2.0 * here + moved(i, -kStep, i, 0.0)) / (kStep * kStep);
        for (Eigen::Index j = 0; j < i; ++j) {
            hessian(i, j) = (moved(i, kStep, j, kStep) - moved(i, kStep, j, -kStep) -
                             moved(i, -kStep, j, kStep) + moved(i, -kStep, j, -kStep)) /
                            (4.0 * kStep * kStep);
            hessian(j, i) = hessian(i, j);
        }
    }
    return hessian;
}

struct Minimum {
    Vector at;
    double value = 0.0;
    bool converged = false;
};

/// BFGS: C. G. Broyden, R. Fletcher, D. Goldfarb, D. F. Shanno, 1970.
Minimum descend(const Objective& f, const Vector& start) {
    Minimum best{.at = start, .value = f(start)};
    Vector gradient = gradient_of(f, best.at);
    Matrix inverse = Matrix::Identity(start.size(), start.size()) /
                     std::max(1.0, gradient.norm());  // a first step of at most 1
    for (int step = 0; step < 200; ++step) {
        Vector move = -inverse * gradient;
        if (const double longest = move.cwiseAbs().maxCoeff(); longest > 2.0) {
            move *= 2.0 / longest;
        }
        const double slope = gradient.dot(move);
        double share = 1.0;
        double value = f(best.at + move);
        while (!(value <= best.value + 1e-4 * share * slope) && share > 1e-10) {
            share *= 0.5;
            value = f(best.at + share * move);
        }
        const bool gained = value < best.value;
        if (gained) {
            const Vector s = share * move;
            const Vector next = gradient_of(f, best.at + s);
            const Vector y = next - gradient;
            best.at += s;
            best.value = value;
            gradient = next;
            if (const double sy = s.dot(y); sy > 1e-12 * s.norm() * y.norm()) {
                const Matrix turn = Matrix::Identity(s.size(), s.size()) - s * y.transpose() / sy;
                inverse = turn * inverse * turn.transpose() + s * s.transpose() / sy;
            }
        }
        if (gradient.cwiseAbs().maxCoeff() < 1e-6 || !gained) {
            // Where no step gains, rounding is all that is left.
            best.converged = gradient.cwiseAbs().maxCoeff() < 1e-3;
            return best;
        }
    }
    return best;
}

/// Newton's step, as long as it gains or moves by rounding alone.
void polish(const Objective& f, Minimum& best) {
    for (int step = 0; step < 2; ++step) {
        const Eigen::LDLT<Matrix> factor(hessian_of(f, best.at));
        if (factor.info() != Eigen::Success || !factor.isPositive()) {
            return;
        }
        const Vector moved = best.at - factor.solve(gradient_of(f, best.at));
        const double value = f(moved);
        if (!(value <= best.value + 1e-11 * std::fabs(best.value)) ||
            (moved - best.at).cwiseAbs().maxCoeff() > 0.1) {
            return;
        }
        best.at = moved;
        best.value = value;
    }
}

std::optional<double> error_of(const Matrix& covariance, Eigen::Index i) {
    const double variance = covariance(i, i);
    return std::isfinite(variance) && variance > 0.0 ? std::optional(std::sqrt(variance))
                                                     : std::nullopt;
}

void add_errors(const Objective& f, const Minimum& best, MixedFit& fit) {
    const Matrix hessian = hessian_of(f, best.at);
    const Eigen::SelfAdjointEigenSolver<Matrix> parts(hessian);
    if (!(parts.eigenvalues().minCoeff() > 1e-8 * parts.eigenvalues().maxCoeff())) {
        return;
    }
    const Matrix covariance = hessian.ldlt().solve(Matrix::Identity(f.size(), f.size()));
    fit.intercept_se = error_of(covariance, 0);
    fit.effect_se = fit.spec.effect ? error_of(covariance, 1) : std::nullopt;
}

MixedFit fit_of(const Objective& f, const MixedSpec& spec, const Minimum& best) {
    const auto all = f.whole(best.at);
    MixedFit fit{.spec = spec, .intercept = all[0], .effect = all[1]};
    // L and L with a column turned round give the same covariance: the diagonal is held above 0.
    const double one = all[2] < 0.0 ? -1.0 : 1.0;
    fit.l = {std::fabs(all[2]), one * all[3], std::fabs(all[4])};
    fit.sd_intercept = fit.l[0];
    fit.sd_slope = std::hypot(fit.l[1], fit.l[2]);
    constexpr double kNone = 1e-4;
    if (spec.slope && fit.sd_intercept > kNone && fit.sd_slope > kNone) {
        fit.correlation = fit.l[1] / fit.sd_slope;
    }
    fit.log_likelihood = -best.value;
    fit.singular = fit.l[0] < kNone || (spec.slope && fit.l[2] < kNone);
    constexpr double kFar = 10.0;
    fit.intercept_unbounded = std::fabs(fit.intercept) > kFar;
    fit.unbounded = fit.intercept_unbounded || std::fabs(fit.effect) > kFar;
    fit.converged = best.converged;
    return fit;
}

/// Logits of the shares of all people, half an answer added to either side.
std::array<double, 2> pooled_logits(std::span<const TwoCounts> people) {
    std::array<double, 2> logits{};
    for (std::size_t c = 0; c < 2; ++c) {
        double hits = 0.5;
        double misses = 0.5;
        for (const TwoCounts& one : people) {
            hits += one.k[c];
            misses += one.n[c] - one.k[c];
        }
        logits[c] = std::log(hits / misses);
    }
    return logits;
}

double uniform_of(Pcg32& random) {
    return (static_cast<double>(random.next()) +
            (static_cast<double>(random.next()) + 0.5) * 0x1p-32) *
           0x1p-32;
}

/// Answers of people like those that `null` describes.
std::vector<TwoCounts> drawn(std::span<const TwoCounts> people,
                             const MixedFit& null,
                             Pcg32& random) {
    std::vector<TwoCounts> made;
    for (const TwoCounts& one : people) {
        const double u0 = protocols::normal_quantile(uniform_of(random));
        const double u1 = protocols::normal_quantile(uniform_of(random));
        TwoCounts& other = made.emplace_back(TwoCounts{.n = one.n});
        for (std::size_t c = 0; c < 2; ++c) {
            const double logit =
                null.intercept + null.l[0] * u0 + (c == 1 ? null.l[1] * u0 + null.l[2] * u1 : 0.0);
            const double p = 1.0 / (1.0 + protocols::exponential(-logit));
            for (double n = 0.0; n < one.n[c]; n += 1.0) {
                other.k[c] += uniform_of(random) < p ? 1.0 : 0.0;
            }
        }
    }
    return made;
}

}  // namespace

MixedFit fit_mixed(std::span<const TwoCounts> people, const MixedSpec& spec, const MixedFit* from) {
    const Objective f(people, spec);
    std::vector<std::array<double, 5>> starts;
    if (from != nullptr) {
        // Off the boundary: there the slope of l22 is 0 and no step would leave it.
        starts.push_back({from->intercept, from->effect, std::max(from->l[0], 0.05), from->l[1],
                          std::max(from->l[2], 0.05)});
    } else {
        const auto logits = pooled_logits(people);
        for (const double spread : {0.2, 0.6, 1.5}) {
            starts.push_back({logits[0], logits[1] - logits[0], spread, 0.0, 0.7 * spread});
        }
    }
    Minimum best;
    for (const auto& start : starts) {
        Minimum found = descend(f, f.part(start));
        if (best.at.size() == 0 || found.value < best.value) {
            best = std::move(found);
        }
    }
    if (spec.errors) {
        polish(f, best);
    }
    MixedFit fit = fit_of(f, spec, best);
    if (spec.errors) {
        add_errors(f, best, fit);
    }
    return fit;
}

double likelihood_ratio(const MixedFit& full, const MixedFit& less) {
    return std::max(0.0, 2.0 * (full.log_likelihood - less.log_likelihood));
}

double chi_square_p(double x, int df) {
    return boost::math::cdf(complement(boost::math::chi_squared(df), std::max(x, 0.0)));
}

double slope_variance_p(double ratio) {
    return 0.5 * (chi_square_p(ratio, 1) + chi_square_p(ratio, 2));
}

SimulatedNull simulate_null(std::span<const TwoCounts> people,
                            const MixedFit& null,
                            double ratio,
                            std::size_t samples,
                            std::uint64_t seed,
                            std::uint64_t stream) {
    std::vector<double> ratios(samples);
    constexpr std::size_t kShare = 25;
    SideBySide work;
    std::size_t last = 0;
    for (std::size_t first = 0; first < samples; first += kShare) {
        last = work.add([&, first] {
            for (std::size_t s = first; s < std::min(first + kShare, samples); ++s) {
                Pcg32 random(seed, stream + s);
                const std::vector<TwoCounts> answers = drawn(people, null, random);
                const MixedFit less = fit_mixed(answers, {.effect = false, .errors = false}, &null);
                ratios[s] = likelihood_ratio(fit_mixed(answers, {.errors = false}, &less), less);
            }
        });
    }
    for (std::size_t task = 0; samples > 0 && task <= last; ++task) {
        work.wait_for(task);
    }
    // Equal counts give equal ratios but for the last digits of the search.
    const auto reached = std::ranges::count_if(
        ratios, [&](double one) { return one >= ratio - 1e-6 * std::max(1.0, ratio); });
    return {.samples = samples,
            .p = static_cast<double>(reached + 1) / static_cast<double>(samples + 1)};
}

}  // namespace palpate::data
