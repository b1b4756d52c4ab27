#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/geometry/arc.hpp"
#include "engine/geometry/nurbs_curve.hpp"

namespace palpate::engine {

/// What two neighbouring spans make of their common end.
enum class SeamKind : std::uint8_t {
    convex,   ///< the outline turns towards the object: an external fan of normals
    concave,  ///< it turns away: the vertex owns an internal fan
    smooth,   ///< the tangents agree within kSmoothTurn: no vertex region at all
};

/// Turns below this, rad, count as smooth: 1e-9 rad at 10 N is 1e-8 N, far below anything felt.
inline constexpr double kSmoothTurn = 1e-9;

/// Where one span ends and the next begins.
struct Seam {
    Vec2 point{};
    std::size_t before = 0;  ///< span that ends here
    std::size_t after = 0;   ///< span that starts here
    /// `after` begins a segment: two segments meet here, not two spans of one
    bool is_vertex = false;
    Vec2 tangent_in{};   ///< unit tangent at the end of `before`
    Vec2 tangent_out{};  ///< unit tangent at the start of `after`
    SeamKind kind = SeamKind::smooth;
    double turn = 0.0;  ///< angle between the tangents, rad in [0, pi]
};

/// Curves joined end to end, the object on the right of travel. Closed: the last joins the first,
/// so that inside and outside are defined everywhere. An open outline ends in two open ends.
///
/// Segments are what an experimenter names; spans are the rational Bezier pieces they consist of.
/// Spans meet at seams; the seam between two segments is a vertex. A kink or a cusp within a
/// segment is a seam that acts like a vertex: at a cusp the outline turns by pi, convex where the
/// object fills the spike, concave where it surrounds it.
class Outline {
public:
    /// A tick records its segment, or -1 - j on vertex j, in 16 bits.
    static constexpr std::size_t kMaxSegments = 0x7FFF;

    /// @param segments  each starts where the one before ends, within 1e-9 m; 1 to kMaxSegments
    /// @param closed    the last one ends where the first starts
    /// @throws std::invalid_argument if ends do not meet, a seam runs back along itself, a segment
    ///         is a mere point, or a closed outline runs anticlockwise (the object would be
    ///         outside)
    Outline(const std::vector<NurbsCurve<2>>& segments, bool closed);
    /// Segments of one span each.
    Outline(std::vector<RationalBezier<2>> segments, bool closed);

    /// All spans in the direction of travel.
    [[nodiscard]] const std::vector<RationalBezier<2>>& spans() const noexcept { return spans_; }
    /// A span as the arc or line that it is; null: it is neither.
    [[nodiscard]] const Arc* arc(std::size_t span) const noexcept {
        return arcs_[span] ? &*arcs_[span] : nullptr;
    }
    /// Which part of which segment a span is.
    [[nodiscard]] const SpanName& name(std::size_t span) const noexcept { return names_[span]; }
    /// Where spans meet: seam i is at the end of span i.
    [[nodiscard]] const std::vector<Seam>& seams() const noexcept { return seams_; }
    /// The last segment ends where the first starts.
    [[nodiscard]] bool closed() const noexcept { return closed_; }

    /// Seam at the end (forward) or at the start of span i; none at an open end.
    [[nodiscard]] std::optional<std::size_t> seam_beyond(std::size_t span,
                                                         bool forward) const noexcept;

private:
    void add_segment(const NurbsCurve<2>& curve, std::size_t index);
    void join_all();

    std::vector<RationalBezier<2>> spans_;
    std::vector<std::optional<Arc>> arcs_;
    std::vector<SpanName> names_;
    std::vector<Seam> seams_;
    bool closed_ = false;
};

}  // namespace palpate::engine
