#include "tests/figures/thesis/curve_tracker.hpp"

#include "engine/base/text.hpp"

namespace palpate::figures {
namespace {

using namespace palpate::engine;

constexpr std::array<std::string_view, 5> kTrackerNames{
    "feedback", "feed_forward", "feedback_linearised", "tangent_plane", "newton"};

/// Share of |f'|^2 below which c is not let: 1 - kappa d, at most five times a Gauss-Newton step.
constexpr double kMinCurving = 0.2;

bool positive(double value) noexcept {
    return std::isfinite(value) && value > 0.0;
}

bool finite(const Vec2& v) noexcept {
    return std::isfinite(v.x) && std::isfinite(v.y);
}

const TrackerSpec& checked(const TrackerSpec& spec) {
    require(static_cast<std::size_t>(spec.kind) < kTrackerNames.size(), "tracker kind",
            static_cast<double>(spec.kind), "give one of the five");
    const bool newton = spec.kind == TrackerKind::newton;
    const bool plane = spec.kind == TrackerKind::tangent_plane;
    if (newton) {
        require(spec.iterations >= 1 && spec.iterations <= 100, "newton iterations",
                spec.iterations, "give 1 to 100");
    } else if (plane) {
        require(positive(spec.rate_hz), "tangent plane rate", spec.rate_hz, "give Hz above 0");
    } else {
        require(positive(spec.gain), "tracker gain", spec.gain,
                spec.kind == TrackerKind::feedback_linearised ? "give 1/s above 0"
                                                              : "give 1/(m^2 s) above 0");
        require(spec.sub_steps >= 1 && spec.sub_steps <= 1000, "tracker sub-steps", spec.sub_steps,
                "give 1 to 1000");
    }
    return spec;
}

/// Psi, |f'|^2 and c of one jet.
struct Error {
    double psi = 0.0;
    double speed2 = 0.0;
    double c = 0.0;

    Error(const Jet<2>& jet, const Vec2& hip) noexcept {
        const Vec2 gap = jet.point - hip;
        psi = glm::dot(gap, jet.first);
        speed2 = glm::dot(jet.first, jet.first);
        c = speed2 + glm::dot(gap, jet.second);
    }
    [[nodiscard]] double safe_c() const noexcept { return std::max(c, kMinCurving * speed2); }
};

}  // namespace

std::string_view to_string(TrackerKind kind) noexcept {
    const auto i = static_cast<std::size_t>(kind);
    return i < kTrackerNames.size() ? kTrackerNames[i] : "unknown";
}

CurveTracker::CurveTracker(NurbsCurve<2> curve, const TrackerSpec& spec)
    : curve_(std::move(curve)), spec_(checked(spec)) {}

double CurveTracker::clamped(double u, double fallback) const noexcept {
    return std::isnan(u) ? fallback : std::clamp(u, curve_.front(), curve_.back());
}

TrackerState CurveTracker::start_at(double u) const noexcept {
    TrackerState state;
    state.u = clamped(u, curve_.front());
    return state;
}

TrackerState CurveTracker::start(const Vec2& hip) const noexcept {
    constexpr int kSamples = 32;
    double best = std::numeric_limits<double>::infinity();
    double best_u = curve_.front();
    for (const auto& span : curve_.spans()) {
        for (int i = 0; i <= kSamples; ++i) {
            const double s = static_cast<double>(i) / kSamples;
            const Vec2 gap = span.curve.at(s).point - hip;
            const double distance2 = glm::dot(gap, gap);
            if (distance2 < best) {
                best = distance2;
                best_u = span.lo + s * (span.hi - span.lo);
            }
        }
    }
    return start_at(best_u);
}

TrackedFoot CurveTracker::foot_at(double u, const Vec2& hip) const noexcept {
    const Jet<2> jet = curve_.at(u);
    TrackedFoot foot{.u = u, .point = jet.point};
    const double speed = glm::length(jet.first);
    if (speed > 0.0) {
        foot.tangent = jet.first / speed;
    }
    foot.normal = perp(foot.tangent);
    foot.psi = glm::dot(jet.point - hip, foot.tangent);
    foot.depth = glm::dot(jet.point - hip, foot.normal);
    return foot;
}

TrackedFoot CurveTracker::step(TrackerState& state, const Vec2& hip, double dt) const noexcept {
    if (!finite(hip) || !std::isfinite(dt)) {
        return foot_at(state.u, finite(state.last_hip) ? state.last_hip : Vec2{0.0, 0.0});
    }
    if (!state.moving) {
        state.last_hip = hip;
        state.moving = true;
    }
    if (spec_.kind == TrackerKind::tangent_plane) {
        const TrackedFoot foot = on_plane(state, hip, dt);
        state.last_hip = hip;
        return foot;
    }
    follow(state, hip, dt);
    state.last_hip = hip;
    return foot_at(state.u, hip);
}

void CurveTracker::follow(TrackerState& state, const Vec2& hip, double dt) const noexcept {
    if (spec_.kind == TrackerKind::newton) {
        for (int i = 0; i < spec_.iterations; ++i) {
            const Error e(curve_.at(state.u), hip);
            state.u = clamped(state.u - e.psi / e.safe_c(), state.u);
        }
        return;
    }
    const double h = dt / spec_.sub_steps;
    const Vec2 move = (hip - state.last_hip) / static_cast<double>(spec_.sub_steps);
    for (int i = 0; i < spec_.sub_steps; ++i) {
        const bool carried = spec_.kind != TrackerKind::feedback;
        const Vec2 seen = carried ? state.last_hip + static_cast<double>(i) * move : hip;
        const Jet<2> jet = curve_.at(state.u);
        const Error e(jet, seen);
        double du = -(spec_.gain * h) * e.psi;
        if (spec_.kind == TrackerKind::feed_forward) {
            du += glm::dot(jet.first, move) / e.speed2;
        } else if (spec_.kind == TrackerKind::feedback_linearised) {
            // Here K is in 1/s and the whole is divided by c, so that the error decays at K
            // everywhere.
            du = (du + glm::dot(jet.first, move)) / e.safe_c();
        }
        state.u = clamped(state.u + du, state.u);
    }
}

TrackedFoot CurveTracker::on_plane(TrackerState& state, const Vec2& hip, double dt) const noexcept {
    state.plane_age += dt;
    const bool none = state.plane_tangent == Vec2{0.0, 0.0};
    // Ages are sums of ticks: a whole number of them must count as whole.
    if (none || state.plane_age * spec_.rate_hz >= 1.0 - 1e-9) {
        const Error e(curve_.at(none ? state.u : state.plane_u), hip);
        state.u = clamped((none ? state.u : state.plane_u) - e.psi / e.speed2, state.u);
        const TrackedFoot touch = foot_at(state.u, hip);
        state.plane_point = touch.point;
        state.plane_tangent = touch.tangent;
        state.plane_u = state.u;
        state.plane_age = 0.0;
    }
    // The plane ends where the parameter does: unbounded it would reach over the next curve.
    const double along = glm::dot(hip - state.plane_point, state.plane_tangent);
    const double speed = glm::length(curve_.at(state.plane_u).first);
    const double u = clamped(state.plane_u + along / speed, state.plane_u);
    TrackedFoot foot{
        .u = u,
        .point = state.plane_point + ((u - state.plane_u) * speed) * state.plane_tangent,
        .tangent = state.plane_tangent,
        .normal = perp(state.plane_tangent)};
    foot.psi = glm::dot(foot.point - hip, foot.tangent);
    foot.depth = glm::dot(foot.point - hip, foot.normal);
    state.u = foot.u;
    return foot;
}

double critical_gain(const NurbsCurve<2>& curve,
                     double u,
                     const Vec2& hip,
                     double period) noexcept {
    const Error e(curve.at(u), hip);
    return e.c > 0.0 && period > 0.0 ? 2.0 / (period * e.c) : 0.0;
}

double feedback_gain(const NurbsCurve<2>& curve, double kappa, double period) {
    require(positive(kappa), "loop gain", kappa, "give a number above 0, 1 is best");
    require(positive(period), "tick period", period, "give seconds above 0");
    constexpr int kSamples = 256;
    double fastest2 = 0.0;
    for (const auto& span : curve.spans()) {
        for (int i = 0; i <= kSamples; ++i) {
            const double u = span.lo + (span.hi - span.lo) * i / kSamples;
            const Vec2 first = curve.at(u).first;
            fastest2 = std::max(fastest2, glm::dot(first, first));
        }
    }
    require(positive(fastest2), "largest |f'|^2", fastest2, "give a curve that has a length");
    return kappa / (fastest2 * period);
}

double theorem_gain(double reach, double hip_speed, double epsilon) {
    require(positive(reach), "reach", reach, "give m above 0");
    require(std::isfinite(hip_speed) && hip_speed >= 0.0, "HIP speed", hip_speed,
            "give m/s from 0");
    require(positive(epsilon), "projection error", epsilon, "give m above 0");
    return 2.0 * reach * hip_speed / (epsilon * epsilon);
}

}  // namespace palpate::figures
