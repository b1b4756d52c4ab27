#pragma once

#include "engine/rendering/mode.hpp"
#include "tests/support/outlines.hpp"

/// What runs over a curve and over a surface have in common: their numbers, HIP's straight ways,
/// and the instants that the thesis' figures mark.
namespace palpate::figures {

inline constexpr double kFrictionTick = 0.001;        ///< s
inline constexpr double kFrictionStiffness = 1000.0;  ///< N/m
inline constexpr double kFrictionStatic = 0.7;        ///< mu_s
inline constexpr double kFrictionDynamic = 0.5;       ///< mu_d

inline constexpr double kDepth = 0.005;     ///< m, of the first slide
inline constexpr double kDeeper = 0.0085;   ///< m, of the second
inline constexpr double kAlong = 0.02;      ///< m/s
inline constexpr double kInwards = 0.02;    ///< m/s, along the normal
inline constexpr double kPress = 0.01;      ///< m/s, from the first depth to the second
inline constexpr double kFirst = 0.30;      ///< parameter of the first touch
inline constexpr double kSlideOne = 0.012;  ///< m along, before pressing
inline constexpr double kSlideTwo = 0.014;  ///< m along, after pressing

/// On to a place, a place a tick.
template <class Point>
void go_straight(std::vector<Point>& path, const Point& to, double speed) {
    const Point from = path.back();
    const double length = glm::length(to - from);
    const int ticks = std::max(1, static_cast<int>(std::ceil(length / (speed * kFrictionTick))));
    for (int i = 1; i <= ticks; ++i) {
        path.push_back(from + (static_cast<double>(i) / ticks) * (to - from));
    }
}

/// What may begin or end at a tick.
enum class Instant {
    touches,  ///< contact begins
    lifts,    ///< it ends
    moves,    ///< HIP begins to move along: friction follows
    breaks,   ///< GO breaks away
    relaxed,  ///< mu is mu_d
    sticks,   ///< the first stuck tick
    deepens,  ///< HIP goes deeper
    is_deep,  ///< it stops going deeper
    leaves,   ///< it begins to leave
};

template <class Tick>
[[nodiscard]] bool is_at(Instant what, const Tick& before, const Tick& now, const Tick& next) {
    constexpr double kFriction = 1e-6;  // N: less is rounding
    constexpr double kDeeperBy = 1e-6;  // m a tick: less is rounding
    using engine::Mode;
    switch (what) {
        case Instant::touches:
            return now.mode != Mode::free;
        case Instant::lifts:
            return now.mode == Mode::free;
        case Instant::moves:
            return std::fabs(next.friction_force) > kFriction;
        case Instant::breaks:
            return now.mode == Mode::transition || now.mode == Mode::slip;
        case Instant::relaxed:
            return now.mode == Mode::slip;
        case Instant::sticks:
            return now.mode == Mode::stuck;
        case Instant::deepens:
            return next.depth > now.depth + kDeeperBy;
        case Instant::is_deep:
            return now.depth > before.depth + kDeeperBy && next.depth <= now.depth + kDeeperBy;
        default:
            return next.depth < now.depth - kDeeperBy;
    }
}

/// The ticks of a run at which these instants come, each after the one before; none where there is
/// no such tick: what follows is looked for after the last one found.
template <class Tick, std::size_t N>
[[nodiscard]] std::array<std::optional<std::size_t>, N> instants_of(
    const std::vector<Tick>& run, const std::array<Instant, N>& wanted) {
    std::array<std::optional<std::size_t>, N> found{};
    std::size_t last = 0;
    for (std::size_t k = 0; k < N; ++k) {
        for (std::size_t i = last + 1; i + 1 < run.size() && !found[k]; ++i) {
            if (is_at(wanted[k], run[i - 1], run[i], run[i + 1])) {
                found[k] = last = i;
            }
        }
    }
    return found;
}

}  // namespace palpate::figures
