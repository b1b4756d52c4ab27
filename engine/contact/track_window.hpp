#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/contact/closest_point.hpp"
#include "engine/math/bend.hpp"

namespace palpate::engine {

/// A stretch of an outline over which the distance to HIP has one minimum only, and that minimum,
/// as it is followed. A plain value.
struct TrackWindow {
    std::size_t span = 0;  ///< of the foot
    double u = 0.0;        ///< where the jet was taken: a step of less than 2e-6 beside the foot
    Jet<2> jet{};
    Bend bend{};  ///< of (C - h) . C' over u, when last seen

    PieceRange pieces{};
    std::size_t first_span = 0;  ///< in the direction of travel
    std::size_t last_span = 0;
    double first_u = 0.0;
    double last_u = 1.0;
    std::array<std::size_t, 2> vertices{};  ///< true vertices within
    std::uint32_t vertex_count = 0;
};

/// What following a window's minimum gave.
struct Followed {
    bool settled = false;  ///< else: no minimum was reached, a search is due
    bool on_seam = false;
    std::size_t seam = 0;
    Foot<2> foot{};
};

/// Opens windows on an outline and follows the minima in them.
///
/// Over a piece the distance has one minimum while f(u) = (C - h) . C' W^k rises, a set of
/// half-planes of h (Pieces::rise_slack); over joined pieces as long as no vertex between them is a
/// maximum: not falling behind it while rising ahead.
class WindowTracker {
public:
    /// @param feet  must live as long as this
    explicit WindowTracker(const OutlineFeet& feet);

    /// The window around `foot`, the closest point of some part of the outline to h, as far as it
    /// can be had with some slack, and not into `taken`.
    /// @return how far h may move while the window keeps its single minimum, m; <= 0: there is none
    [[nodiscard]] double open(TrackWindow& window,
                              const Foot<2>& foot,
                              const Vec2& h,
                              const PieceRange& taken) const noexcept;

    /// On an arc or a line the foot itself, elsewhere Newton's iteration on g(u) = (C - h) . C' from
    /// the last one, its first step along a parabola; across spans, within the window.
    /// @pre h has moved less than the window's slack
    [[nodiscard]] Followed follow(TrackWindow& window, const Vec2& h) const noexcept;

private:
    struct Opening;

    [[nodiscard]] bool one_minimum(const TrackWindow& window, const Vec2& h) const noexcept;
    [[nodiscard]] static Followed here(const TrackWindow& window,
                                       double u,
                                       const Vec2& point,
                                       const Vec2& h) noexcept;
    std::optional<Followed> past_end(TrackWindow& window,
                                     bool forward,
                                     const Vec2& h) const noexcept;

    const OutlineFeet* feet_;
    std::vector<double>
        taylor_;  ///< of each span: steps of u below it are finished by Taylor's series
};

}  // namespace palpate::engine
