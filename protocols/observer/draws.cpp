#include "protocols/observer/draws.hpp"

#include <cmath>
#include <cstdint>

#include "engine/math/elementary.hpp"

namespace palpate::protocols {

double uniform_draw(Pcg32& random) noexcept {
    const std::uint64_t upper = random.next();
    const std::uint64_t word = (upper << 32U) | random.next();
    return static_cast<double>(word >> 11U) * 0x1p-53;
}

double normal_draw(Pcg32& random) noexcept {
    for (;;) {
        const double x = 2.0 * uniform_draw(random) - 1.0;
        const double y = 2.0 * uniform_draw(random) - 1.0;
        const double s = x * x + y * y;
        if (s > 0.0 && s < 1.0) {
            return x * std::sqrt(-2.0 * engine::natural_log(s) / s);
        }
    }
}

double exponential_draw(Pcg32& random) noexcept {
    return -engine::natural_log(1.0 - uniform_draw(random));  // (0, 1]: never the logarithm of 0
}

}  // namespace palpate::protocols
