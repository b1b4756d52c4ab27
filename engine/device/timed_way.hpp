#pragma once

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
        std::size_t i = 0;
        while (reached_[i + 1] < t) {
            ++i;
        }
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
};

}  // namespace palpate::engine
