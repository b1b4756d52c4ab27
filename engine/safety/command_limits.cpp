#include "engine/safety/command_limits.hpp"

#include <algorithm>

namespace palpate::engine {

Vec2 saturated(const Vec2& force, double most) noexcept {
    const double length = glm::length(force);
    return length > most ? force * (most / length) : force;
}

Vec2 within_slew(const Vec2& last, const Vec2& target, double slew) noexcept {
    const Vec2 change = target - last;
    const double length = glm::length(change);
    return length > slew ? last + change * (slew / length) : target;
}

double ramped(double gain, double step, bool enable) noexcept {
    return std::clamp(enable ? gain + step : gain - step, 0.0, 1.0);
}

}  // namespace palpate::engine
