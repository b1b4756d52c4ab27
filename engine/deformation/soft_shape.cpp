#include "engine/deformation/soft_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/deformation/dnurbs.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

constexpr double kRate = 200.0;          ///< of the slowest mode, rad/s
constexpr double kRigidity = 1.0 / 400;  ///< beta / alpha
constexpr double kDeepest = 0.25;        ///< of the shorter chord
constexpr double kStill = 1e-8;          ///< m
constexpr double kStillSpeed = 1e-5;     ///< m/s

double squared(const Vec2& a) noexcept {
    return glm::dot(a, a);
}

/// The displacements of A-V-B as one curve of 15 control points, with a kink at V, u = 1.
DnurbsSpec displacements(double compliance) {
    DnurbsSpec spec{.knots = {0.0, 0.0, 0.0, 0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.0, 1.0, 1.2, 1.4, 1.6,
                              1.8, 2.0, 2.0, 2.0, 2.0}};
    for (std::size_t i = 0; i < SoftState::kPoints; ++i) {
        spec.points.push_back({static_cast<double>(i), 0.0});  // any: equal weights do not ask
    }
    // A force at V bends nothing: what it makes is a hat of two straight lines, of energy alpha
    // y^2.
    spec.alpha = 1.0 / (2.0 * compliance);
    spec.beta = kRigidity * spec.alpha;
    const double wave = 0.5 * kPi;  // of half a sine from u = 0 to 2
    spec.mu = (spec.alpha + spec.beta * wave * wave) * wave * wave / (kRate * kRate);
    spec.gamma = 2.0 * spec.mu * kRate;
    spec.fixed = {0, SoftState::kPoints - 1};
    return spec;
}

/// v^T M v / 2 of the points that move.
template <class Square, class Points>
double half_form(const Square& m, const Points& v) noexcept {
    double twice = 0.0;
    for (std::size_t i = 0; i < m.size(); ++i) {
        for (std::size_t j = 0; j < m.size(); ++j) {
            twice += m[i][j] * glm::dot(v[i + 1], v[j + 1]);
        }
    }
    return 0.5 * twice;
}

template <class Square>
double times(const Square& m, std::size_t row, std::size_t column, const Square& n) noexcept {
    double sum = 0.0;
    for (std::size_t k = 0; k < m.size(); ++k) {
        sum += m[row][k] * n[k][column];
    }
    return sum;
}

/// The inverse of a positive definite matrix by elimination, in an order that no build changes.
template <class Square>
Square inverse_of(Square m) noexcept {
    const std::size_t n = m.size();
    Square inverse{};
    for (std::size_t i = 0; i < n; ++i) {
        inverse[i][i] = 1.0;
    }
    for (std::size_t pivot = 0; pivot < n; ++pivot) {
        const double share = 1.0 / m[pivot][pivot];
        for (std::size_t j = 0; j < n; ++j) {
            m[pivot][j] *= share;
            inverse[pivot][j] *= share;
        }
        for (std::size_t i = 0; i < n; ++i) {
            const double factor = m[i][pivot];
            if (i == pivot || factor == 0.0) {
                continue;
            }
            for (std::size_t j = 0; j < n; ++j) {
                m[i][j] -= factor * m[pivot][j];
                inverse[i][j] -= factor * inverse[pivot][j];
            }
        }
    }
    return inverse;
}

const Outline& checked(const Outline& outline) {
    bool whole = outline.closed() && outline.spans().size() == SoftShape::kSoftSpans + 1;
    for (std::size_t i = 0; whole && i < outline.spans().size(); ++i) {
        whole = outline.name(i).segment == i;
    }
    refuse_if(!whole,
              "a compliance is for two curves on a base line: give a closed outline of three "
              "segments that are one span each, or leave the compliance out");
    return outline;
}

}  // namespace

SoftShape::SoftShape(std::shared_ptr<const Outline> outline, double compliance, double period)
    : outline_(std::move(outline)), period_(period) {
    static_cast<void>(checked(*outline_));
    require(std::isfinite(compliance) && compliance > 0.0 && compliance <= kMaxCompliance,
            "compliance", compliance, "give m/N above 0, at most 0.005");
    require(std::isfinite(period) && period > 0.0, "tick period", period, "give seconds above 0");
    double chord = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < kSoftSpans; ++i) {
        const RationalBezier<2>& span = outline_->spans()[i];
        chord = std::min(chord, glm::length(span.at(1.0).point - span.at(0.0).point));
    }
    deepest_ = kDeepest * chord;
    compile(compliance);
    set_looks();
}

void SoftShape::compile(double compliance) {
    const Dnurbs curve(displacements(compliance));
    Square whole{};
    for (std::size_t i = 0; i < kMoving; ++i) {
        for (std::size_t j = 0; j < kMoving; ++j) {
            mass_[i][j] = curve.mass(i + 1, j + 1);
            stiffness_[i][j] = curve.stiffness(i + 1, j + 1);
            whole[i][j] = mass_[i][j] + 0.5 * period_ * curve.damping(i + 1, j + 1) +
                          0.25 * period_ * period_ * stiffness_[i][j];
        }
    }
    soft_ = inverse_of(stiffness_);
    const Square inverse = inverse_of(whole);
    for (std::size_t i = 0; i < kMoving; ++i) {
        for (std::size_t j = 0; j < kMoving; ++j) {
            keep_[i][j] = times(inverse, i, j, mass_);
            pull_[i][j] = 0.5 * period_ * times(inverse, i, j, stiffness_);
            answer_[i][j] = 0.5 * period_ * inverse[i][j];
        }
    }
    constexpr double kWidth = 1.0 / static_cast<double>(kCuts);
    for (std::size_t i = 0; i < polynomials_.size(); ++i) {
        const double lo = curve.spec().knots[3 + i + (i < kCuts ? 0 : 2)];
        const BasisAt start = curve.basis(lo);
        const BasisAt middle = curve.basis(lo + 0.5 * kWidth);
        for (std::size_t k = 0; k < 4; ++k) {
            const double third =
                (middle.second_derivative[k] - start.second_derivative[k]) / (0.5 * kWidth);
            polynomials_[i][k] = {start.value[k], kWidth * start.first_derivative[k],
                                  0.5 * kWidth * kWidth * start.second_derivative[k],
                                  kWidth * kWidth * kWidth * third / 6.0};
        }
    }
}

void SoftShape::set_looks() {
    const auto add = [this](const Material& at) {
        const Splines splines = this->splines(at);
        looks_.push_back({.at = at,
                          .rest = outline_->spans()[at.span].at(at.u).point,
                          .first = splines.first,
                          .value = splines.value});
    };
    constexpr std::size_t kOfCurve = kCuts * kLooks;
    for (std::size_t span = 0; span < kSoftSpans; ++span) {
        for (std::size_t i = 0; i <= kOfCurve; ++i) {
            add({span, static_cast<double>(i) / static_cast<double>(kOfCurve)});
        }
    }
}

/// @pre the span yields
SoftShape::Splines SoftShape::splines(const Material& at) const noexcept {
    constexpr auto kScale = static_cast<double>(kCuts);
    const double x = kScale * at.u;
    const auto cut = static_cast<std::size_t>(std::clamp(x, 0.0, kScale - 1.0));
    const double t = x - static_cast<double>(cut);
    Splines s{.first = 7 * at.span + cut};
    const auto& polynomials = polynomials_[kCuts * at.span + cut];
    for (std::size_t k = 0; k < 4; ++k) {
        const auto& c = polynomials[k];
        s.value[k] = c[0] + t * (c[1] + t * (c[2] + t * c[3]));
        s.slope[k] = kScale * (c[1] + t * (2.0 * c[2] + 3.0 * t * c[3]));
        s.bend[k] = kScale * kScale * (2.0 * c[2] + 6.0 * t * c[3]);
    }
    return s;
}

Jet<2> SoftShape::jet(const SoftState& state, const Material& at) const noexcept {
    Jet<2> jet = outline_->spans()[at.span].at(at.u);
    if (at.span >= kSoftSpans) {
        return jet;
    }
    const Splines s = splines(at);
    for (std::size_t k = 0; k < 4; ++k) {
        const Vec2& q = state.q[s.first + k];
        jet.point += s.value[k] * q;
        jet.first += s.slope[k] * q;
        jet.second += s.bend[k] * q;
    }
    return jet;
}

/// The quadratic form of a matrix at the splines of a place.
double SoftShape::weighed(const Square& by, const Splines& at) noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            const std::size_t a = at.first + i - 1;
            const std::size_t b = at.first + j - 1;
            sum += a < kMoving && b < kMoving ? at.value[i] * at.value[j] * by[a][b] : 0.0;
        }
    }
    return sum;
}

double SoftShape::compliance_at(const Material& at) const noexcept {
    if (at.span >= kSoftSpans) {
        return 0.0;
    }
    return weighed(soft_, splines(at));
}

double SoftShape::stored(const SoftState& state) const noexcept {
    return half_form(stiffness_, state.q);
}

double SoftShape::energy(const SoftState& state) const noexcept {
    return half_form(mass_, state.v) + stored(state);
}

/// v_m = A^-1 (M v - T/2 K q): the velocities of the middle of a tick without a force.
SoftShape::Velocities SoftShape::unforced(const SoftState& state) const noexcept {
    Velocities mean{};
    for (std::size_t i = 0; i < kMoving; ++i) {
        Vec2 sum{};
        for (std::size_t j = 0; j < kMoving; ++j) {
            sum += keep_[i][j] * state.v[j + 1] - pull_[i][j] * state.q[j + 1];
        }
        mean[i] = sum;
    }
    return mean;
}

/// c_1, m/N: how far the material is at the middle of a tick by a force on it.
double SoftShape::once(const Splines& at) const noexcept {
    return 0.5 * period_ * weighed(answer_, at);
}

void SoftShape::push(Velocities& mean, const Splines& at, const Vec2& force) const noexcept {
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t b = at.first + k - 1;
        if (b >= kMoving) {
            continue;
        }
        const Vec2 share = at.value[k] * force;
        for (std::size_t i = 0; i < kMoving; ++i) {
            mean[i] += answer_[b][i] * share;  // symmetric
        }
    }
}

/// To the end of the tick; false, and all stays but the velocities, which are lost, where that were
/// too deep.
bool SoftShape::move(SoftState& state, const Velocities& mean) const noexcept {
    const SoftState before = state;
    bool fits = true;
    for (std::size_t i = 0; i < kMoving; ++i) {
        state.q[i + 1] += period_ * mean[i];
        state.v[i + 1] = 2.0 * mean[i] - state.v[i + 1];
        fits = fits && squared(state.q[i + 1]) <= deepest_ * deepest_;
    }
    if (!fits) {
        state.q = before.q;
        state.v = {};
    }
    return fits;
}

double SoftShape::advance(SoftState& state) const noexcept {
    const Velocities mean = unforced(state);
    double max = 0.0;
    for (const Vec2& v : mean) {
        max = std::max(max, squared(v));
    }
    return move(state, mean) ? period_ * std::sqrt(max) : 0.0;
}

void SoftShape::advance(SoftState& state,
                        const Material& at,
                        const Vec2& hip,
                        double stiffness) const noexcept {
    Velocities mean = unforced(state);
    if (at.span < kSoftSpans) {
        const Splines s = splines(at);
        Vec2 point = outline_->spans()[at.span].at(at.u).point;
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t b = s.first + k - 1;
            if (b < kMoving) {
                point += s.value[k] * (state.q[b + 1] + 0.5 * period_ * mean[b]);
            }
        }
        push(mean, s, (hip - point) * (stiffness / (1.0 + stiffness * once(s))));
    }
    move(state, mean);
}

SoftShape::Met SoftShape::advance_to(SoftState& state,
                                     const Vec2& hip,
                                     double stiffness) const noexcept {
    const SoftState before = state;
    Velocities mean = unforced(state);
    const bool moved = move(state, mean);
    Met met = nearest(state, hip);
    if (!(met.depth > 0.0)) {
        return met;
    }
    const double gap = glm::dot(jet(before, met.at).point - hip, met.normal);
    state = before;
    if (moved && gap < 0.0 && met.at.span < kSoftSpans) {
        // (x - x_free) (x - gap) + K c_1 x^2 = 0: one root lies between 0 and x_free.
        const Splines s = splines(met.at);
        const double more = 1.0 + stiffness * once(s);
        const double sum = gap + met.depth;
        const double x = (sum + std::sqrt(sum * sum - 4.0 * more * gap * met.depth)) / (2.0 * more);
        push(mean, s, (-0.5 * stiffness * x * x / (x - gap)) * met.normal);
        if (move(state, mean)) {
            met.touches = true;
            met.depth = x;
            met.point = jet(state, met.at).point;
            return met;
        }
        state.q = before.q;
    }
    state.v = {};  // the surface stops before it reaches the hand
    met = nearest(state, hip);
    return met;
}

bool SoftShape::all_but_still(const SoftState& state) noexcept {
    for (std::size_t i = 0; i < SoftState::kPoints; ++i) {
        if (squared(state.q[i]) > kStill * kStill ||
            squared(state.v[i]) > kStillSpeed * kStillSpeed) {
            return false;
        }
    }
    return true;
}

}  // namespace palpate::engine
