#include "engine/safety/motor_heat.hpp"

namespace palpate::engine {

Vec2 heated(const Vec2& heat, const Vec2& load, double step) noexcept {
    const double kept = 1.0 / (1.0 + step * (1.0 + 0.5 * step));  // 0 after an infinite time
    return heat + (1.0 - kept) * (load * load - heat);
}

}  // namespace palpate::engine
