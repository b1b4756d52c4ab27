#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/geometry/vec.hpp"

namespace palpate::engine {
template <int D>
class NurbsCurve;
class Outline;
}  // namespace palpate::engine

/// Objects of any shape: an outline from control points, placed by size, turn and offset.
namespace palpate::stimuli {

/// Where an object stands and how large it is: p -> offset + R(turn) (size p).
struct Pose {
    double size = 1.0;      ///< factor, > 0
    engine::Vec2 offset{};  ///< m
    double turn = 0.0;      ///< rad, anticlockwise about the origin

    friend bool operator==(const Pose&, const Pose&) = default;
};

/// `point` of an object's own frame in the frame of the study, m.
[[nodiscard]] engine::Vec2 placed(const Pose& pose, const engine::Vec2& point) noexcept;

/// One curve of an outline, before it is placed.
struct Segment {
    enum class Kind : std::uint8_t { nurbs, line, arc };

    Kind kind = Kind::line;
    int degree = 1;                      ///< of a nurbs
    std::vector<double> knots{};         ///< of a nurbs
    std::vector<engine::Vec2> points{};  ///< m; control points, or the two ends of a line or an arc
    std::vector<double> weights{};       ///< of a nurbs; empty: all 1
    double curvature = 0.0;              ///< of an arc, 1/m: > 0 convex

    friend bool operator==(const Segment&, const Segment&) = default;
};

/// The placed curve; an arc keeps its angle, so that its curvature is divided by the size.
/// @throws std::invalid_argument saying what is wrong: NurbsCurve's and make_arc's words
[[nodiscard]] engine::NurbsCurve<2> curve_of(const Segment& segment, const Pose& pose = {});

/// The placed, closed outline. @throws std::invalid_argument as Outline does
[[nodiscard]] std::shared_ptr<const engine::Outline> make_outline(std::span<const Segment> segments,
                                                                  const Pose& pose = {});

/// Any outline as a polyline for pictures, at most `tolerance` m away from it: a span is halved
/// until its control points, and so the whole of it, are that near to its chord. Ends of spans are
/// kept exactly; of an open outline the last end too. Outlines that would need more than 8192
/// points are met less closely.
/// @pre tolerance > 0
[[nodiscard]] std::vector<engine::Vec2> silhouette(const engine::Outline& outline,
                                                   double tolerance = 20e-6);

/// A place where a polyline crosses or touches itself, m; nothing if it does neither.
/// @param closed  an edge leads from its last point to its first
[[nodiscard]] std::optional<engine::Vec2> self_crossing(std::span<const engine::Vec2> polyline,
                                                        bool closed = true);

}  // namespace palpate::stimuli
