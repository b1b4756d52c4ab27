#pragma once

#include "engine/geometry/nurbs_curve.hpp"
#include "tests/support/std.hpp"

/// The thesis' own ways to find the closest point, kept so that their difference to the certified
/// one (engine/contact) can be seen, measured and felt. Nothing here is used unless chosen by name.
namespace palpate::figures {

using engine::NurbsCurve;
using engine::Vec2;

/// How a test point follows the closest point (CP) of HIP along one curve f(u).
///
///     Psi = (f(u) - h) . f'(u)             projection error, m^2 per unit of u
///     c   = |f'|^2 + (f - h) . f''         its derivative along u: > 0 at a minimum of the
///     distance
enum class TrackerKind : std::uint8_t {
    feedback,      ///< u' = -K Psi                                   thesis 2.1.2
    feed_forward,  ///< u' = -K Psi + f' . v / |f'|^2                 thesis 2.1.2, last paragraph
    /// u' = (-K Psi + f' . v) / c                    Patoglu & Gillespie 2005
    feedback_linearised,
    /// projection on a plane held between refreshes  thesis 2.1.3, figure 2.1.2 (b)
    tangent_plane,
    newton,  ///< u <- u - Psi / c, some times a tick
};

/// "feedback", "feed_forward", "feedback_linearised", "tangent_plane" or "newton".
[[nodiscard]] std::string_view to_string(TrackerKind kind) noexcept;

/// A tracker as chosen. Only the numbers that its kind reads are checked.
struct TrackerSpec {
    TrackerKind kind = TrackerKind::feedback;
    /// K, > 0. feedback, feed_forward: 1/(m^2 s), because Psi is taken with the derivative f' as
    /// the proof of theorem 2.1.1 needs it (the thesis also calls f' a unit tangent; then K would
    /// be in 1/(m s)). feedback_linearised: 1/s.
    double gain = 1e5;
    int sub_steps = 1;       ///< explicit Euler steps a tick, 1 to 1000
    double rate_hz = 100.0;  ///< tangent_plane: refreshes a second, > 0
    int iterations = 1;      ///< newton: steps a tick, 1 to 100

    friend bool operator==(const TrackerSpec&, const TrackerSpec&) = default;
};

/// What lives on from tick to tick. A plain value.
struct TrackerState {
    double u = 0.0;
    Vec2 last_hip{};         ///< m
    Vec2 plane_point{};      ///< tangent_plane: a point of the held plane, m
    Vec2 plane_tangent{};    ///< unit; zero until the first refresh
    double plane_u = 0.0;    ///< where the plane touches
    double plane_age = 0.0;  ///< s since the last refresh
    bool moving = false;     ///< last_hip holds a HIP
};

/// The tracked point and its frame.
struct TrackedFoot {
    double u = 0.0;
    Vec2 point{};            ///< f(u), m; tangent_plane: on the held plane, beside the curve
    Vec2 tangent{1.0, 0.0};  ///< unit, direction of travel
    Vec2 normal{0.0, 1.0};   ///< unit, outward
    double psi = 0.0;  ///< (point - h) . tangent, m: projection error left over, with unit tangent
    double depth = 0.0;  ///< (point - h) . normal, m: > 0 inside
};

/// Follows the closest point of HIP on one curve. Local: it slides downhill to the next minimum of
/// the distance and knows nothing of farther, nearer ones. u never leaves the domain of the curve.
///
/// A feedback tracker is stable only for K below critical_gain(); above it jumps to and fro (that
/// is kept). c is not let below 0.2 |f'|^2, so that Newton and the linearised law stay finite near
/// a centre of curvature. The feed-forward kinds take Psi at the HIP of the tick before and let v
/// carry u over; with sub-steps HIP moves on a straight line within the tick. With K T |f'|^2 = 1
/// feedback is one Gauss-Newton step, and the linearised law with K T = 1 is one Newton step: the
/// difference between the thesis' method and theirs is a choice of gain.
class CurveTracker {
public:
    /// @throws std::invalid_argument for a number out of range, with its name, value and remedy
    CurveTracker(NurbsCurve<2> curve, const TrackerSpec& spec);

    /// A state at the nearest of 32 samples a span, to begin with. No allocation.
    [[nodiscard]] TrackerState start(const Vec2& hip) const noexcept;
    /// A state at `u` (clamped to the domain; the front for NaN).
    [[nodiscard]] TrackerState start_at(double u) const noexcept;

    /// One tick: HIP is now at `hip`, `dt` s after the last step. Non-finite input leaves u alone.
    TrackedFoot step(TrackerState& state, const Vec2& hip, double dt) const noexcept;

    /// Frame of the curve at u, seen from `hip`.
    [[nodiscard]] TrackedFoot foot_at(double u, const Vec2& hip) const noexcept;

    /// The curve that was given.
    [[nodiscard]] const NurbsCurve<2>& curve() const noexcept { return curve_; }
    /// The spec that was given.
    [[nodiscard]] const TrackerSpec& spec() const noexcept { return spec_; }

private:
    [[nodiscard]] double clamped(double u, double fallback) const noexcept;
    void follow(TrackerState& state, const Vec2& hip, double dt) const noexcept;
    TrackedFoot on_plane(TrackerState& state, const Vec2& hip, double dt) const noexcept;

    NurbsCurve<2> curve_;
    TrackerSpec spec_;
};

/// Largest K with which one explicit Euler step a tick of T settles on the closest point at u when
/// HIP rests at `hip`, 1/(m^2 s):
///
///     K_crit = 2 / (T (|f'|^2 + (f - h) . f''))
///
/// from the factor 1 - K T c by which a small error is multiplied every tick. Measured by bisection
/// to 1e-3 in tests/figures/tests/thesis_tracker_test.cpp. 0 where c <= 0: there u is no minimum of the
/// distance and every gain leaves it. @param period T, s, > 0
[[nodiscard]] double critical_gain(const NurbsCurve<2>& curve,
                                   double u,
                                   const Vec2& hip,
                                   double period) noexcept;

/// Gain K, 1/(m^2 s), of loop gain `kappa` = K max|f'|^2 T where the curve is fastest (256 samples
/// a span). kappa near 1 is best with one step a tick; 2 is the limit on a straight edge.
/// @throws std::invalid_argument unless kappa and period are finite and > 0 and the curve has a
///       length
[[nodiscard]] double feedback_gain(const NurbsCurve<2>& curve, double kappa, double period);

/// Gain that theorem 2.1.1 asks for, 1/s (a curve parametrised by its arc length, |f'| = 1):
///
///     K = 2 reach hip_speed / epsilon^2                          thesis, inequality (2.16)
///
/// For continuous time. Stepped, it also needs K dt < 2: reach 0.05, speed 0.5 and epsilon 0.001 at
/// 1 kHz ask for 25 sub-steps or more. On a curve of constant |f'| divide by |f'|^2.
/// @param reach      largest |HIP - test point|, m, > 0
/// @param hip_speed  largest speed of HIP, m/s, >= 0
/// @param epsilon    projection error to accept, m, > 0
/// @throws std::invalid_argument if an argument is outside its range or not finite
[[nodiscard]] double theorem_gain(double reach, double hip_speed, double epsilon);

}  // namespace palpate::figures
