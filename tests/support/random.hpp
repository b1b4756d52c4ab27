#pragma once

#include "engine/geometry/vec.hpp"
#include "tests/support/std.hpp"

namespace palpate::tests {

/// Seeded numbers for tests. The distributions are written out, so that a seed means the same case
/// with every standard library.
class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed * 0x9E3779B97F4A7C15ULL + 1U) {}

    /// Uniform in [lo, hi).
    double in(double lo, double hi) {
        return lo + (hi - lo) * (static_cast<double>(engine_() >> 11U) * 0x1p-53);
    }
    /// 10^[lo, hi), either sign if `both`.
    double decade(double lo, double hi) { return std::pow(10.0, in(lo, hi)); }
    int below(int n) { return static_cast<int>(in(0.0, n)); }
    /// Below `n`: a place among n.
    std::size_t index(std::size_t n) {
        return static_cast<std::size_t>(in(0.0, static_cast<double>(n)));
    }
    bool coin() { return (engine_() >> 63U) != 0U; }
    engine::Vec2 point(double lo, double hi) {
        const double x = in(lo, hi);
        return engine::Vec2{x, in(lo, hi)};
    }

private:
    std::mt19937_64 engine_;
};

/// A smooth random hand inside a box: sums of sines, 1 kHz by default, as fast as asked for.
inline std::vector<engine::Vec2> random_hand(
    std::uint64_t seed, std::size_t ticks, engine::Vec2 lo, engine::Vec2 hi, double period = 1e-3) {
    Random random(seed);
    struct Wave {
        double hz, phase_x, phase_y, size;
    };
    std::vector<Wave> waves;
    double total = 0.0;
    for (int i = 0; i < 5; ++i) {
        const double size = random.in(0.2, 1.0);
        waves.push_back({random.in(0.1, 1.2), random.in(0.0, 6.3), random.in(0.0, 6.3), size});
        total += size;
    }
    std::vector<engine::Vec2> path;
    path.reserve(ticks);
    const engine::Vec2 middle = 0.5 * (lo + hi);
    const engine::Vec2 half = 0.5 * (hi - lo);
    for (std::size_t k = 0; k < ticks; ++k) {
        engine::Vec2 p{};
        for (const Wave& w : waves) {
            const double t = 2.0 * std::numbers::pi * w.hz * static_cast<double>(k) * period;
            p += w.size / total *
                 engine::Vec2{std::sin(t + w.phase_x), std::sin(1.3 * t + w.phase_y)};
        }
        path.push_back(middle + 1.6 * p * half);
    }
    return path;
}

}  // namespace palpate::tests
