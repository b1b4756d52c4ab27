#pragma once

#include "engine/surface/nurbs_surface.hpp"
#include "tests/support/random.hpp"

namespace palpate::tests {

/// A hand at 1 kHz that wanders over a surface, `depth` above and below it: a smooth path in (u, v)
/// shifted along the normal, with a tremor, then slowed down to at most `speed` m/s.
inline std::vector<engine::Vec3> surface_hand(const engine::NurbsSurface& s,
                                              std::uint64_t seed,
                                              std::size_t ticks,
                                              double depth,
                                              double speed,
                                              double spread = 0.42) {
    Random random(seed);
    const double hz[3] = {random.in(0.1, 0.5), random.in(0.1, 0.5), random.in(0.6, 2.0)};
    const double phase[3] = {random.in(0.0, 6.0), random.in(0.0, 6.0), random.in(0.0, 6.0)};
    const double lo_u = s.knots_u().front();
    const double lo_v = s.knots_v().front();
    const double width_u = s.knots_u().back() - lo_u;
    const double width_v = s.knots_v().back() - lo_v;
    double time = 0.0;
    const auto at = [&](double t) {
        const auto wave = [&](int k) {
            return std::sin(6.283185307179586 * hz[k] * t + phase[k]);
        };
        const double u = lo_u + width_u * (0.5 + spread * wave(0));
        const double v = lo_v + width_v * (0.5 + spread * wave(1));
        const double tremor = 5e-5 * std::sin(6.283185307179586 * 9.0 * t);
        return s.at(u, v).point + (depth * wave(2) + tremor) * s.normal(u, v);
    };
    std::vector<engine::Vec3> path;
    engine::Vec3 last = at(0.0);
    for (std::size_t k = 0; k < ticks; ++k) {
        double step = 1e-3;
        engine::Vec3 next = at(time + step);
        while (glm::length(next - last) > speed * 1e-3 && step > 1e-9) {
            step *= 0.7;
            next = at(time + step);
        }
        time += step;
        last = next;
        path.push_back(next);
    }
    return path;
}

}  // namespace palpate::tests
