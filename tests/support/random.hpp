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

}  // namespace palpate::tests
