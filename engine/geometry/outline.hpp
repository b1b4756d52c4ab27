#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/geometry/rational_bezier.hpp"

namespace palpate::engine {

/// Tangent, normal and curvature of a plane curve at one point.
struct Frame {
    Vec2 point{};
    Vec2 tangent{1.0, 0.0};  ///< unit, direction of travel
    Vec2 normal{0.0, 1.0};   ///< unit, outward: the tangent turned by +90 degrees
    double speed = 0.0;      ///< |C'|, m per unit of u
    double curvature = 0.0;  ///< 1/m, > 0 where the object bulges (convex)
};

/// Frame of `curve` at u.
[[nodiscard]] Frame frame_at(const RationalBezier<2>& curve, double u) noexcept;

enum class JointKind : std::uint8_t {
    convex,   ///< the outline turns towards the object: an external fan of normals
    concave,  ///< it turns away: the vertex owns an internal fan
    smooth,   ///< the tangents agree within kSmoothTurn: no vertex region at all
};

/// Turns below this, rad, count as smooth: 1e-9 rad at 10 N is 1e-8 N, far below anything felt.
inline constexpr double kSmoothTurn = 1e-9;

/// Where one segment ends and the next begins.
struct Joint {
    Vec2 point{};
    std::size_t before = 0;  ///< segment that ends here
    std::size_t after = 0;   ///< segment that starts here
    Vec2 tangent_in{};       ///< unit tangent at the end of `before`
    Vec2 tangent_out{};      ///< unit tangent at the start of `after`
    JointKind kind = JointKind::smooth;
    double turn = 0.0;  ///< angle between the tangents, rad in [0, pi)
};

/// Curves joined end to end, the object on the right of travel. Closed: the last joins the first,
/// so that inside and outside are defined everywhere. Open chains end in two open ends.
class Outline {
public:
    /// @param segments  each starts where the one before ends, within 1e-9 m; at least one
    /// @param closed    the last one ends where the first starts
    /// @throws std::invalid_argument if ends do not meet, a joint turns back on itself, or a closed
    ///         outline runs anticlockwise (the object would be outside)
    Outline(std::vector<RationalBezier<2>> segments, bool closed);

    [[nodiscard]] const std::vector<RationalBezier<2>>& segments() const noexcept {
        return segments_;
    }
    [[nodiscard]] const std::vector<Joint>& joints() const noexcept { return joints_; }
    [[nodiscard]] bool closed() const noexcept { return closed_; }

    /// Joint at the end (forward) or at the start of segment i; none at an open end.
    [[nodiscard]] std::optional<std::size_t> joint_beyond(std::size_t segment,
                                                          bool forward) const noexcept;

private:
    std::vector<RationalBezier<2>> segments_;
    std::vector<Joint> joints_;
    bool closed_ = false;
};

}  // namespace palpate::engine
