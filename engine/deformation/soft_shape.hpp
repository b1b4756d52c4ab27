#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "engine/contact/closest_point.hpp"
#include "engine/geometry/outline.hpp"

/// An object of two curves that yield to a force, compiled for one tick period.
///
/// Each of the curves A-V and V-B moves by a cubic B-spline of 8 control points over its own u;
/// they share the one of V, those of A and B do not move, and the base line B-A stands firm. So the
/// curve at rest may be of any kind, an arc stays an exact one, and what moves is the D-NURBS of
/// the displacements (engine/deformation/dnurbs.hpp):
///
///     C(u) = C_rest(u) + R(u) q,      M q'' + D q' + K q = R(u)^T F
///
/// One number says how soft the object is: its compliance c, m/N, is how far the vertex gives way
/// to a force at rest there, in any direction. Everything else follows from it by fixed rules:
///
///     tension   alpha: R(V) K^-1 R(V)^T = c          the vertex is softest; see compliance_at()
///     rigidity  beta = alpha / 400                   a dent is about 1/20 of a curve wide
///     mass      mu: slowest mode 200 rad/s (32 Hz)   of two strings and two beams, in closed form
///     damping   gamma = 2 mu 200 rad/s               the slowest mode is critically damped
///
/// so that a surface that is let go is back in some 30 ms whatever its compliance, and a hand that
/// explores feels a spring. A contact of stiffness K gives way by the spring and the surface in
/// series: 1 / (1 / K + c) in all.
///
/// A step is the trapezoid rule with the force at the middle of the tick, and the spring of the
/// contact is part of it: F = K (h - C(u)) at the middle depends on the step by one number, the
/// compliance c_1 of a single tick, so that
///
///     F = K (h - C_free(u)) / (1 + K c_1)
///
/// solves the coupled step exactly. Curve and spring together lose gamma times the squared
/// velocities and gain nothing, whatever K, c and T: no condition ties them together.
namespace palpate::engine {

/// Softest object, m/N: at 2 N it gives way by the 10 mm that a curve of 40 mm can bear.
inline constexpr double kMaxCompliance = 0.005;

/// Displacements and velocities of the control points. A plain value.
struct SoftState {
    static constexpr std::size_t kPoints = 15;  ///< 8 of each curve, that of V shared

    std::array<Vec2, kPoints> q{};  ///< m; the first and the last stay 0
    std::array<Vec2, kPoints> v{};  ///< m/s
    bool moving = false;            ///< false: at rest, where all are 0
    double clear = 0.0;             ///< out of contact HIP is known to be as far outside, m
};

/// A point of the material: of the spans that yield, or of the base line.
struct Material {
    std::size_t span = 0;
    double u = 0.0;
};

/// The material at a place: a seam is the end of the span before it.
[[nodiscard]] inline Material material_at(const Outline& outline, const Place& place) noexcept {
    return place.on_seam ? Material{outline.seams()[place.index].before, 1.0}
                         : Material{place.index, place.parameter};
}

/// How an outline of two curves on a base line gives way to a force: unchanging, made once; what
/// moves is a SoftState.
class SoftShape {
public:
    /// Spans of the outline that yield.
    static constexpr std::size_t kSoftSpans = 2;
    static constexpr std::size_t kMoving = SoftState::kPoints - 2;

    /// @param outline     three spans, closed: A-V, V-B and the base line
    /// @param compliance  c, m/N, > 0, at most kMaxCompliance
    /// @param period      of a tick, s, > 0
    /// @throws std::invalid_argument for another outline, or a value out of range
    SoftShape(std::shared_ptr<const Outline> outline, double compliance, double period);

    /// Its shape as nobody presses it.
    [[nodiscard]] const Outline& outline() const noexcept { return *outline_; }
    /// A control point moves no farther than this, m: a quarter of the shorter chord. There the
    /// surface stops, and stays as it is until it may go back.
    [[nodiscard]] double deepest() const noexcept { return deepest_; }
    /// How far a point gives way to a force at rest on itself, m/N; 0 on the base line.
    [[nodiscard]] double compliance_at(const Material& at) const noexcept;
    /// Energy of the motion and of the deformation, J.
    [[nodiscard]] double energy(const SoftState& state) const noexcept;
    /// Of the deformation alone, J.
    [[nodiscard]] double stored(const SoftState& state) const noexcept;

    /// C, C' and C'' of the shape as it is.
    [[nodiscard]] Jet<2> jet(const SoftState& state, const Material& at) const noexcept;

    /// One tick with nothing on the surface. @return how far a control point moved at the most, m
    double advance(SoftState& state) const noexcept;
    /// One tick with a spring between the material and HIP.
    void advance(SoftState& state,
                 const Material& at,
                 const Vec2& hip,
                 double stiffness) const noexcept;

    /// A touch of a surface that moves.
    struct Met {
        bool touches = false;
        Material at{};
        Vec2 normal{};       ///< unit, outward
        double depth = 0.0;  ///< of HIP below the surface, m, < 0 outside
        Vec2 point{};        ///< of the surface, the nearest to HIP
    };
    /// One tick with nothing on the surface but a hand that may be in its way: where the surface
    /// would run over HIP it pushes it instead, by a spring that takes from the surface what it
    /// stores: F = (E_1 - E_0) / (x_1 - x_0).
    /// @pre HIP is outside of the shape as it is
    Met advance_to(SoftState& state, const Vec2& hip, double stiffness) const noexcept;

    /// The point of the shape that is nearest to HIP, and how deep HIP is below it: by 21 points of
    /// each curve, then by Newton's iteration.
    [[nodiscard]] Met nearest(const SoftState& state, const Vec2& hip) const noexcept;

    /// All but at rest: below 10 nm and 10 um/s.
    [[nodiscard]] static bool all_but_still(const SoftState& state) noexcept;

private:
    using Row = std::array<double, kMoving>;
    using Square = std::array<Row, kMoving>;
    static constexpr std::size_t kCuts = 5;   ///< intervals of a curve's knots
    static constexpr std::size_t kLooks = 4;  ///< points looked at in each

    /// The four splines that are not zero at a point, and their derivatives by u.
    struct Splines {
        std::size_t first = 0;  ///< control point
        std::array<double, 4> value{};
        std::array<double, 4> slope{};
        std::array<double, 4> bend{};
    };
    /// A point of a curve that is looked at: fixed on the material.
    struct Look {
        Material at{};
        Vec2 rest{};
        std::size_t first = 0;
        std::array<double, 4> value{};
    };
    using Velocities = std::array<Vec2, kMoving>;  ///< of the middle of a tick, m/s

    void compile(double compliance);
    void set_looks();
    [[nodiscard]] Splines splines(const Material& at) const noexcept;
    [[nodiscard]] Velocities unforced(const SoftState& state) const noexcept;
    [[nodiscard]] static double weighed(const Square& by, const Splines& at) noexcept;
    [[nodiscard]] double once(const Splines& at) const noexcept;
    void push(Velocities& mean, const Splines& at, const Vec2& force) const noexcept;
    bool move(SoftState& state, const Velocities& mean) const noexcept;
    [[nodiscard]] Met on_span(const SoftState& state,
                              std::size_t look,
                              const Vec2& hip) const noexcept;

    std::shared_ptr<const Outline> outline_;
    double period_;
    double deepest_ = 0.0;
    /// Of each interval the four splines as polynomials of its own share.
    std::array<std::array<std::array<double, 4>, 4>, kCuts * kSoftSpans> polynomials_{};
    Square mass_{};
    Square stiffness_{};
    Square soft_{};    ///< K^-1, m/N
    Square keep_{};    ///< A^-1 M,          A = M + T/2 D + T^2/4 K
    Square pull_{};    ///< A^-1 K T/2, 1/s
    Square answer_{};  ///< A^-1 T/2, m/(N s): the velocity that a force gives within the tick
    std::vector<Look> looks_;
};

}  // namespace palpate::engine
