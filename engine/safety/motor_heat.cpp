#include "engine/safety/motor_heat.hpp"

namespace palpate::engine {

Vec3 heated(const Vec3& heat, const Vec3& load, double step) noexcept {
    const double kept = 1.0 / (1.0 + step * (1.0 + 0.5 * step));  // 0 after an infinite time
    return heat + (1.0 - kept) * (load * load - heat);
}

}  // namespace palpate::engine
