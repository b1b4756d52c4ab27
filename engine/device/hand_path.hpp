#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// A way along straight legs at one speed: where somebody means to be at each moment.
template <int D>
class TimedWay {
public:
    TimedWay() = default;
    /// @param corners  m, at least one   @param speed  m/s, > 0
    TimedWay(std::vector<Vec<D>> corners, double speed) : corners_(std::move(corners)) {
        reached_.push_back(0.0);
        for (std::size_t i = 1; i < corners_.size(); ++i) {
            duration_ += glm::length(corners_[i] - corners_[i - 1]) / speed;
            reached_.push_back(duration_);
            legs_.push_back(
                {.way = corners_[i] - corners_[i - 1], .time = reached_[i] - reached_[i - 1]});
            legs_.back().velocity = legs_.back().way / legs_.back().time;
        }
    }

    struct Moment {
        Vec<D> position{};  ///< m
        Vec<D> velocity{};  ///< m/s
    };

    /// @param t  s since the start; before 0 the start, after the end the last point
    [[nodiscard]] Moment at(double t) const noexcept {
        if (t <= 0.0) {
            return {.position = corners_.front()};
        }
        if (t >= duration_) {
            return {.position = corners_.back()};
        }
        std::size_t i = reached_[last_] < t ? last_ : 0;
        while (reached_[i + 1] < t) {
            ++i;
        }
        last_ = i;
        const Leg& leg = legs_[i];
        return {.position = corners_[i] + leg.way * ((t - reached_[i]) / leg.time),
                .velocity = leg.velocity};
    }
    /// When it ends, s since the start.
    [[nodiscard]] double duration() const noexcept { return duration_; }

private:
    struct Leg {
        Vec<D> way{};
        double time = 0.0;  ///< s
        Vec<D> velocity{};
    };

    std::vector<Vec<D>> corners_;
    std::vector<Leg> legs_;        ///< from each corner to the next
    std::vector<double> reached_;  ///< s, when each corner is reached
    double duration_ = 0.0;
    mutable std::size_t last_ = 0;  ///< the leg of the last moment, where the search begins
};

/// How a simulated hand means to explore. It knows the chords A-V-B (as a person knows the
/// pictures), never the curvature between them.
struct Exploration {
    Vec2 start{0.0, 0.060};  ///< m, above the vertex
    Vec2 a{-0.040, 0.0};     ///< m
    Vec2 vertex{0.0, 0.040};
    Vec2 b{0.040, 0.0};
    double speed = 0.08;         ///< m/s along the path
    double press_depth = 0.007;  ///< m inside the chords that the hand aims for
    int sweeps = 4;              ///< there, back, ...
    double tremor = 0.00005;     ///< m, amplitude of the 9 Hz tremor of a healthy hand
    double tremor_phase = 0.0;   ///< rad
};

/// Where the hand means to be at each moment: down beside A, up and over the
/// vertex, down the other side and back, and off again.
class HandPath {
public:
    /// @param plan  speed > 0, sweeps >= 0
    explicit HandPath(const Exploration& plan);

    using Intention = TimedWay<2>::Moment;  ///< the velocity is of the path alone

    /// @param t  s since the start; before 0 the start, after the end the last point
    [[nodiscard]] Intention at(double t) const noexcept;
    /// At two moments, for little more than the work of one.
    [[nodiscard]] std::array<Intention, 2> at(double t, double later) const noexcept;
    /// When the hand is off again, s since the start.
    [[nodiscard]] double duration() const noexcept { return way_.duration(); }

private:
    Exploration plan_;
    TimedWay<2> way_;
};

}  // namespace palpate::engine
