#pragma once

#include "engine/surface/surface_scene.hpp"
#include "tests/support/surfaces.hpp"

/// Surface scenes that several tests feel.
namespace palpate::tests {

inline constexpr double kStiffness = 1000.0;
inline constexpr double kPeriod = 1e-3;
inline constexpr engine::Friction kFriction{
    .mu_s = 0.7, .mu_d = 0.5, .tau_slip = 0.02, .tau_heal = 0.1};

inline std::shared_ptr<const engine::NurbsSurface> shared(const SurfaceData& data) {
    return std::make_shared<const engine::NurbsSurface>(make_surface(data));
}

inline engine::SurfaceScene scene_of(const SurfaceData& data,
                                     const engine::Friction& friction,
                                     bool skip_far = false) {
    return {shared(data),
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

inline double energy(const engine::SurfaceContact& c, const engine::Vec3& h) {
    return 0.5 * kStiffness * glm::dot(c.go - h, c.go - h);
}

}  // namespace palpate::tests
