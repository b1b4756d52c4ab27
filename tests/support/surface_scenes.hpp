#pragma once

#include "engine/surface/surface_scene.hpp"
#include "tests/support/surfaces.hpp"

/// Surface scenes that several tests feel.
namespace palpate::tests {

inline constexpr double kStiffness = 1000.0;
inline constexpr double kPeriod = 1e-3;
inline constexpr engine::Friction kFriction{
    .mu_s = 0.7, .mu_d = 0.5, .tau_slip = 0.02, .tau_heal = 0.1};

inline engine::SurfaceScene scene_of(const SurfaceData& data,
                                     const engine::Friction& friction,
                                     bool skip_far = false) {
    return {made(data),
            engine::SurfaceSceneSpec{.contact = {.friction = friction}, .skip_far = skip_far}};
}

/// Objects for laws that hold on all smooth surfaces.
inline SurfaceData smooth_object(std::uint64_t seed) {
    Random random(seed);
    switch (seed % 5U) {
        case 0:
            return bicubic_8x8(random, 0.0);
        case 1:
            return bicubic_8x8(random, 0.7);
        case 2:
            return torus(0.06, 0.025);
        case 3:
            return sphere(0.04);
        default:
            return bicubic_8x8(random, 0.0, 0.03);
    }
}

inline engine::Friction some_friction(std::uint64_t seed) {
    Random random(seed + 77U);
    const double mu_d = seed % 7U == 6U ? 0.0 : random.in(0.05, 1.0);
    return {.mu_s = mu_d + random.in(0.0, 0.6), .mu_d = mu_d, .tau_slip = 0.02, .tau_heal = 0.1};
}

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
