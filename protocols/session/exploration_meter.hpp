#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/geometry/outline.hpp"
#include "engine/realtime/tick_record.hpp"
#include "protocols/session/recorder.hpp"

namespace palpate::protocols {

/// The ceil(q n)-th smallest of n values, q = .1, .5, .9.
[[nodiscard]] Deciles deciles_of(std::vector<double> values) noexcept;

/// How much of an outline the god-object visited. The outline is cut into cells of about kCell; a
/// contact tick visits the cell that its god-object lies in, on a vertex the last one before it. A
/// straight last segment that closes the outline is the base on which the object stands, and does
/// not count.
class OutlineCover {
public:
    static constexpr double kCell = 1e-3;  ///< m; a hand goes 0.1 to 0.3 mm a tick of 1 kHz

    /// Cuts each segment into cells of kCell or less, by chords of 1/64 of a span.
    explicit OutlineCover(const engine::Outline& outline);

    /// The next tick of the same object.
    void add(const engine::TickRecord& tick) noexcept;
    /// Visited length by all length, 0 to 1; the cells' lengths are those of chords, 1e-4 of the
    /// arc or nearer for any curve with a radius above 10 mm.
    [[nodiscard]] double share() const noexcept;

private:
    struct Cell {
        std::int16_t segment = 0;
        double end = 1.0;  ///< of the segment's own parameter
        double length = 0.0;
        bool visited = false;
    };
    std::vector<Cell> cells_;         ///< along the outline
    std::vector<std::size_t> first_;  ///< of each segment; one more at the end
    std::size_t at_ = 0;              ///< where the last one was found
};

/// How much of a patch (stimuli/surface_patch.hpp) the god-object visited: of kSide x kSide cells,
/// each as large in u and v, those in which it was. The rim does not count.
class PatchCover {
public:
    static constexpr std::size_t kSide = 12;  ///< 5 mm of a patch of 60 mm: a finger's breadth

    /// The next tick of the same patch; and the share of cells visited so far, 0 to 1.
    void add(const engine::TickRecord& tick) noexcept;
    [[nodiscard]] double share() const noexcept;
    /// The i-th cell along u, the j-th along v, both from 0 and below kSide.
    [[nodiscard]] bool visited(std::size_t i, std::size_t j) const noexcept {
        return visited_[i * kSide + j];
    }

private:
    std::array<bool, kSide * kSide> visited_{};
};

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
