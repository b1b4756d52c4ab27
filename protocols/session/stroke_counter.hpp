#pragma once

#include <array>
#include <cstdint>

#include "engine/realtime/tick_record.hpp"

namespace palpate::protocols {

/// Counts how often a hand stroked along a surface in one direction.
///
/// Per contact tick the hand moves s = (h[k] - h[k-1]) . t along the surface, t the tangent at the
/// god-object in the direction of travel. A stroke is counted when the sum of s has gone kStroke
/// from where it last turned; the next one when it has come back as far, or when it goes on after
/// the hand was off the surface for longer than kLift. Shorter bounces neither end a stroke nor add
/// to it.
///
/// The stroke along the surface is what hands do to feel shape (contour following, S. J. Lederman,
/// R. L. Klatzky, Cognitive Psychology 19:342, 1987). Both numbers are our choice: kStroke is above
/// tremor and a tenth of a side of the default objects, kLift is above the bounces of a stiff
/// contact.
class StrokeCounter {
public:
    static constexpr double kStroke = 0.005;            ///< m
    static constexpr std::int64_t kLift = 100'000'000;  ///< ns

    /// The next tick. Where the force is 0 there is no tangent, and the tick adds nothing.
    void add(const engine::TickRecord& tick) noexcept;
    /// The same on a surface, where a stroke is counted along x, or along y, each by a counter of
    /// its own.
    /// @param axis  unit, in the plane
    void add_along(const engine::TickRecord& tick, const engine::Vec2& axis) noexcept;
    [[nodiscard]] std::int64_t strokes() const noexcept { return strokes_; }
    /// Of these, those that had gone kStroke on segment 0; on a vertex, where the god-object was
    /// before.
    [[nodiscard]] std::int64_t before_vertex() const noexcept { return on_side_[0]; }
    [[nodiscard]] std::int64_t after_vertex() const noexcept { return on_side_[1]; }
    /// Of these, those that came back on the one before without a lift.
    [[nodiscard]] std::int64_t reversals() const noexcept { return reversals_; }

private:
    [[nodiscard]] engine::Vec2 step_to(const engine::TickRecord& tick) noexcept;
    void touch(const engine::TickRecord& tick) noexcept;
    void go(double step) noexcept;
    void count(int direction) noexcept;

    std::int64_t strokes_ = 0;
    std::int64_t reversals_ = 0;
    std::array<std::int64_t, 2> on_side_{};
    int segment_ = -1;    ///< of the god-object, vertices left out
    int direction_ = 0;   ///< of the stroke that goes on; 0: none yet
    double place_ = 0.0;  ///< along the surface, m
    double low_ = 0.0;    ///< of place_ since the last turn
    double high_ = 0.0;
    bool started_ = false;
    engine::Vec2 last_hip_{};
    std::int64_t last_contact_ = 0;  ///< ns
};

}  // namespace palpate::protocols
