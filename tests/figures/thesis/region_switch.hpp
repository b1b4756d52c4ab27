#pragma once

#include "tests/figures/thesis/curve_tracker.hpp"

namespace palpate::figures {

/// Most curves whose trackers fit the state of a ThesisScene: the thesis joins two and three
/// curves.
inline constexpr std::size_t kMaxRegions = 16;

/// Where the region of one curve ends and that of the next begins.
enum class RegionRule : std::uint8_t {
    /// The curve whose tracked foot is nearer. Outside a convex vertex this gives the thesis'
    /// borders, the normals at the ends, since between them both feet rest in the vertex; inside it
    /// gives the bisector (medial axis).
    nearest_feature,
    /// The normals at the curve ends as straight lines, outside and inside (thesis 2.1.4 and figure
    /// 3.2.1): a curve is left when HIP lies past its own end normal and past the start normal of
    /// the next. Inside a convex vertex the two regions overlap, so that the active one keeps what
    /// it has.
    end_normals,
};

/// Which curve of an outline is active: the state machine of thesis 2.1.4, figure 2.1.5. It goes
/// from a curve to a neighbour only, as the connectivity graph of the thesis does.
class RegionSwitch {
public:
    /// @param curves  1 to kMaxRegions curves, each starting where the one before ends within 1e-9
    ///                m, the object on the right of travel
    /// @param closed  the last one ends where the first starts
    /// @throws std::invalid_argument if the ends do not meet, or a closed outline runs
    ///       anticlockwise
    RegionSwitch(const std::vector<NurbsCurve<2>>& curves, bool closed, RegionRule rule);

    /// The curve with the nearest foot: of all, or of `active` and its two neighbours. A tie stays.
    /// @pre feet has one foot a curve, active is one of them
    [[nodiscard]] std::size_t nearest(std::size_t active,
                                      std::span<const TrackedFoot> feet,
                                      const Vec2& hip,
                                      bool everywhere) const noexcept;

    /// The active curve after HIP moved to `hip`. `locked` holds the region whatever HIP does:
    /// while the contact is STUCK, Voronoi switching is off (thesis 3.1.2).
    [[nodiscard]] std::size_t next(std::size_t active,
                                   std::span<const TrackedFoot> feet,
                                   const Vec2& hip,
                                   bool locked) const noexcept;

    /// Is HIP in the object, judged at the foot of curve `nearest`? At a vertex both curves are
    /// asked: inside a convex one means behind both, inside a concave one behind either. Past an
    /// open end there is no surface and so no inside.
    [[nodiscard]] bool inside(std::size_t nearest,
                              std::span<const TrackedFoot> feet,
                              const Vec2& hip) const noexcept;

    [[nodiscard]] std::optional<std::size_t> after(std::size_t i) const noexcept;
    [[nodiscard]] std::optional<std::size_t> before(std::size_t i) const noexcept;
    [[nodiscard]] RegionRule rule() const noexcept { return rule_; }

private:
    /// One end of a curve.
    struct End {
        double u = 0.0;
        Vec2 point{};
        Vec2 tangent{};  ///< unit
    };
    struct Ends {
        End front;
        End back;
    };
    [[nodiscard]] bool past_front(std::size_t i, const Vec2& hip) const noexcept;
    [[nodiscard]] bool past_back(std::size_t i, const Vec2& hip) const noexcept;
    [[nodiscard]] bool inside_vertex(const End& in, const End& out, const Vec2& hip) const noexcept;

    std::vector<Ends> ends_;
    bool closed_ = false;
    RegionRule rule_ = RegionRule::nearest_feature;
};

}  // namespace palpate::figures
