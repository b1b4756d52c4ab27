#include "engine/deformation/dnurbs.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

/// Gauss points of a rational curve, doubled until no entry changes by more than this share of the
/// largest one.
constexpr std::size_t kFirstPoints = 16;
constexpr std::size_t kLastPoints = 256;
constexpr double kSettled = 1e-13;
/// Matrices are dense: more control points than this are a mistake.
constexpr std::size_t kMaxPoints = 256;
/// A pivot of K below this share of its largest entry is that of a motion which nothing resists.
constexpr double kFree = 1e-12;
struct GaussPoint {
    double place = 0.0;  ///< in [-1, 1]
    double weight = 0.0;
};

/// Gauss-Legendre points: Newton's method on P_n from Tricomi's estimate of its roots (Abramowitz &
/// Stegun 22.16.6, 25.4.29). To 2 ulp.
std::vector<GaussPoint> gauss_legendre(std::size_t n) {
    std::vector<GaussPoint> points(n);
    const auto count = static_cast<double>(n);
    for (std::size_t i = 0; i < n; ++i) {
        long double x = sin_cos(kPi * (static_cast<double>(i) + 0.75) / (count + 0.5)).cos;
        long double slope = 1.0L;
        for (int turn = 0; turn < 100; ++turn) {
            long double before = 1.0L;
            long double now = x;
            for (std::size_t k = 2; k <= n; ++k) {
                const auto order = static_cast<long double>(k);
                const long double next =
                    ((2.0L * order - 1.0L) * x * now - (order - 1.0L) * before) / order;
                before = now;
                now = next;
            }
            slope = static_cast<long double>(n) * (before - x * now) / (1.0L - x * x);
            const long double move = now / slope;
            x -= move;
            if (std::fabs(move) < 1e-19L) {
                break;
            }
        }
        points[i] = {static_cast<double>(x),
                     static_cast<double>(2.0L / ((1.0L - x * x) * slope * slope))};
    }
    return points;
}

bool not_negative(double value) {
    return std::isfinite(value) && value >= 0.0;
}

/// Checked: knots, points and weights as a curve asks for them, densities, and the points that are
/// fixed.
DnurbsSpec checked(DnurbsSpec spec) {
    static_cast<void>(NurbsCurve<2>(spec.degree, spec.knots, spec.points, spec.weights));
    const std::size_t n = spec.points.size();
    refuse_if(n > kMaxPoints, "points_m has {} control points: give at most {}", n, kMaxPoints);
    require(not_negative(spec.mu), "mu", spec.mu, "give a number from 0");
    require(not_negative(spec.gamma), "gamma", spec.gamma, "give a number from 0");
    require(not_negative(spec.alpha), "alpha", spec.alpha, "give a number from 0");
    require(not_negative(spec.beta), "beta", spec.beta, "give a number from 0");
    std::sort(spec.fixed.begin(), spec.fixed.end());
    for (std::size_t i = 0; i < spec.fixed.size(); ++i) {
        refuse_if(spec.fixed[i] >= n, "fixed has {}: control points count from 0 to {}",
                  spec.fixed[i], n - 1);
        refuse_if(i > 0 && spec.fixed[i] == spec.fixed[i - 1], "fixed has {} twice: leave one out",
                  spec.fixed[i]);
    }
    refuse_if(spec.fixed.size() == n,
              "fixed has every control point: leave one out, or nothing moves");
    return spec;
}

/// Entries row by row.
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Index index(std::size_t i) {
    return static_cast<Eigen::Index>(i);
}

/// Rows and columns of the control points that move, of a matrix of all.
Matrix of_moving(const Dnurbs& curve, const std::vector<double>& all) {
    const Eigen::Index n = index(curve.points());
    return Eigen::Map<const Matrix>(all.data(), n, n)(curve.moving(), curve.moving());
}

/// Entries that two ways to compute them agree in.
bool close(const std::vector<double>& before, const std::vector<double>& now) {
    const Eigen::Map<const Eigen::ArrayXd> a(before.data(), index(before.size()));
    const Eigen::Map<const Eigen::ArrayXd> b(now.data(), index(now.size()));
    return (b - a).abs().maxCoeff() <= kSettled * b.abs().maxCoeff();
}

std::vector<double> row_by_row(const Matrix& m) {
    return {m.data(), m.data() + m.size()};
}

/// B-splines of all degrees up to p on the piece that begins with a knot: of degree d the j-th
/// belongs to control point knot - d + j.
std::vector<std::vector<double>> splines_at(const std::vector<double>& t,
                                            std::size_t knot,
                                            std::size_t p,
                                            double u) {
    std::vector<std::vector<double>> spline{{1.0}};
    for (std::size_t d = 1; d <= p; ++d) {
        std::vector<double> next(d + 1);
        for (std::size_t j = 0; j < d; ++j) {
            const std::size_t left = knot + 1 + j - d;
            const double share = (u - t[left]) / (t[left + d] - t[left]);
            next[j] += (1.0 - share) * spline.back()[j];
            next[j + 1] += share * spline.back()[j];
        }
        spline.push_back(std::move(next));
    }
    return spline;
}

/// By the quotient rule. @param weights  of the control points of r
void make_rational(std::span<const double> weights, BasisAt& r) {
    double w = 0.0;
    double w1 = 0.0;
    double w2 = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double weight = weights[i];
        w += r.value[i] *= weight;
        w1 += r.first_derivative[i] *= weight;
        w2 += r.second_derivative[i] *= weight;
    }
    for (std::size_t i = 0; i < weights.size(); ++i) {
        r.value[i] /= w;
        r.first_derivative[i] = (r.first_derivative[i] - r.value[i] * w1) / w;
        r.second_derivative[i] =
            (r.second_derivative[i] - 2.0 * r.first_derivative[i] * w1 - r.value[i] * w2) / w;
    }
}

}  // namespace

Dnurbs::Dnurbs(DnurbsSpec spec)
    : spec_(checked(std::move(spec))),
      knots_(spec_.knots, spec_.degree, spec_.points.size()),
      weights_(spec_.weights.empty() ? std::vector<double>(points(), 1.0) : spec_.weights),
      gram_(points() * points()),
      stiffness_(points() * points()) {
    for (std::size_t i = 0; i < points(); ++i) {
        if (!std::binary_search(spec_.fixed.begin(), spec_.fixed.end(), i)) {
            moving_.push_back(i);
        }
    }
    if (std::ranges::adjacent_find(weights_, std::not_equal_to<>()) == weights_.end()) {
        assemble(static_cast<std::size_t>(spec_.degree) + 1);
        return;
    }
    assemble(kFirstPoints);
    for (std::size_t points = 2 * kFirstPoints; points <= kLastPoints; points *= 2) {
        const std::vector<double> gram = gram_;
        const std::vector<double> stiffness = stiffness_;
        assemble(points);
        if (close(gram, gram_) && close(stiffness, stiffness_)) {
            return;
        }
    }
}

void Dnurbs::assemble(std::size_t gauss_points) {
    std::fill(gram_.begin(), gram_.end(), 0.0);
    std::fill(stiffness_.begin(), stiffness_.end(), 0.0);
    const std::vector<GaussPoint> gauss = gauss_legendre(gauss_points);
    for (const KnotVector::Interval& piece : knots_.intervals()) {
        const double half = 0.5 * (piece.hi - piece.lo);
        for (const GaussPoint& g : gauss) {
            const BasisAt r = basis(piece.lo + half * (1.0 + g.place));
            const double share = half * g.weight;
            for (std::size_t i = 0; i < r.value.size(); ++i) {
                for (std::size_t j = 0; j < r.value.size(); ++j) {
                    const std::size_t k = at(r.first + i, r.first + j);
                    gram_[k] += share * r.value[i] * r.value[j];
                    stiffness_[k] +=
                        share * (spec_.alpha * r.first_derivative[i] * r.first_derivative[j] +
                                 spec_.beta * r.second_derivative[i] * r.second_derivative[j]);
                }
            }
        }
    }
}

BasisAt Dnurbs::basis(double u) const {
    const auto p = static_cast<std::size_t>(spec_.degree);
    const std::vector<double>& t = knots_.values();
    const KnotVector::Interval& piece = knots_.intervals()[knots_.interval_of(u)];
    const std::vector<std::vector<double>> spline = splines_at(t, piece.knot, p, u);
    // A derivative is one of degree d - 1, raised: N' = d (N_left / width - N_right / width).
    const auto raised = [&](std::vector<double> values, std::size_t from) {
        for (std::size_t d = from + 1; d <= p; ++d) {
            std::vector<double> next(d + 1);
            for (std::size_t j = 0; j < d; ++j) {
                const std::size_t left = piece.knot + 1 + j - d;
                const double slope = static_cast<double>(d) / (t[left + d] - t[left]) * values[j];
                next[j] -= slope;
                next[j + 1] += slope;
            }
            values = std::move(next);
        }
        return values;
    };
    BasisAt r{.first = piece.knot - p, .value = spline[p]};
    r.first_derivative = raised(spline[p - 1], p - 1);
    r.second_derivative = p < 2 ? std::vector<double>(p + 1) : raised(spline[p - 2], p - 2);
    make_rational(std::span(weights_).subspan(r.first, p + 1), r);
    return r;
}

Vec2 Dnurbs::point(double u, std::span<const Vec2> displacements) const {
    const BasisAt r = basis(u);
    Vec2 sum{};
    for (std::size_t i = 0; i < r.value.size(); ++i) {
        sum += r.value[i] * (spec_.points[r.first + i] + displacements[r.first + i]);
    }
    return sum;
}

std::vector<Vec2> Dnurbs::equilibrium(double u, const Vec2& force) const {
    const Matrix k = of_moving(*this, stiffness_);
    const Eigen::LDLT<Matrix> factor(k);
    refuse_if(!(factor.vectorD().minCoeff() > kFree * k.diagonal().maxCoeff()),
              "fixed leaves a motion that no tension or rigidity resists, so no force has an "
              "equilibrium: fix one more control point (rigidity alone needs two), or give alpha "
              "or beta above 0");
    const BasisAt r = basis(u);
    Eigen::MatrixX2d load = Eigen::MatrixX2d::Zero(index(points()), 2);
    for (std::size_t i = 0; i < r.value.size(); ++i) {
        load.row(index(r.first + i)) << r.value[i] * force.x, r.value[i] * force.y;
    }
    const Eigen::MatrixX2d side = load(moving_, Eigen::all);
    Eigen::MatrixX2d found = factor.solve(side);
    found += factor.solve(side - k * found);  // what rounding left
    std::vector<Vec2> displaced(points());
    for (std::size_t i = 0; i < moving_.size(); ++i) {
        displaced[moving_[i]] = {found(index(i), 0), found(index(i), 1)};
    }
    return displaced;
}

double Dnurbs::slowest_motion() const {
    const Matrix k = of_moving(*this, stiffness_);
    if (moving_.empty() ||
        !(Eigen::LDLT<Matrix>(k).vectorD().minCoeff() > kFree * k.diagonal().maxCoeff())) {
        return 0.0;
    }
    // Of a density of 1: the squares of none are too small then. The inverse of what is asked for:
    // of its eigenvalues the largest is the one that is right to its last digits.
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> modes(of_moving(*this, gram_), k,
                                                                 Eigen::EigenvaluesOnly);
    return 1.0 / (std::sqrt(modes.eigenvalues().maxCoeff()) * std::sqrt(spec_.mu));
}

DnurbsMotion::DnurbsMotion(const Dnurbs& curve, double step)
    : h_(step),
      moving_(curve.moving()),
      place_(curve.points(), moving_.size()),
      q_(curve.points()),
      v_(curve.points()),
      side_(moving_.size()) {
    refuse_if(!(curve.spec().mu > 0.0),
              "mu is 0: a motion needs mass, give a number above 0 (or static = true)");
    require(std::isfinite(step) && step > 0.0, "dt_s", step, "give a number above 0");
    for (std::size_t i = 0; i < moving_.size(); ++i) {
        place_[moving_[i]] = i;
    }
    const auto entries = [&](double mass, double damping, double stiffness) {
        Matrix m(index(moving_.size()), index(moving_.size()));
        for (std::size_t i = 0; i < moving_.size(); ++i) {
            for (std::size_t j = 0; j < moving_.size(); ++j) {
                m(index(i), index(j)) = mass * curve.mass(moving_[i], moving_[j]) +
                                        damping * curve.damping(moving_[i], moving_[j]) +
                                        stiffness * curve.stiffness(moving_[i], moving_[j]);
            }
        }
        return m;
    };
    const double quarter = 0.25 * h_ * h_;
    keep_ = row_by_row(entries(1.0, -0.5 * h_, -quarter));
    pull_ = row_by_row(entries(0.0, 0.0, h_));
    lower_ = row_by_row(Eigen::LLT<Matrix>(entries(1.0, 0.5 * h_, quarter)).matrixL());
}

void DnurbsMotion::advance(const BasisAt& where, const Vec2& force) noexcept {
    const std::size_t n = moving_.size();
    // M (v1 - v0) = h F - h/2 D (v0 + v1) - h/2 K (q0 + q1), q1 = q0 + h/2 (v0 + v1)
    for (std::size_t i = 0; i < n; ++i) {
        Vec2 sum{};
        for (std::size_t j = 0; j < n; ++j) {
            sum += keep_[i * n + j] * v_[moving_[j]] - pull_[i * n + j] * q_[moving_[j]];
        }
        side_[i] = sum;
    }
    for (std::size_t i = 0; i < where.value.size(); ++i) {
        if (const std::size_t place = place_[where.first + i]; place < n) {
            side_[place] += h_ * where.value[i] * force;
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            side_[i] -= lower_[i * n + j] * side_[j];
        }
        side_[i] /= lower_[i * n + i];
    }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t j = i + 1; j < n; ++j) {
            side_[i] -= lower_[j * n + i] * side_[j];
        }
        side_[i] /= lower_[i * n + i];
    }
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t point = moving_[i];
        q_[point] += 0.5 * h_ * (v_[point] + side_[i]);
        v_[point] = side_[i];
    }
}

}  // namespace palpate::engine
