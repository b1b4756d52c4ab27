#pragma once

#include "engine/surface/surface_scene.hpp"
#include "tests/stress/exact_flow.hpp"
#include "tests/stress/tick_laws.hpp"

/// What must hold on every tick of every contact with a surface. Points, tangents and normals are
/// those of the definition in long double, which shares no code with the engine.
namespace palpate::stress {

class SurfaceLaws : private Ledger {
public:
    SurfaceLaws(const engine::SurfaceScene& scene, const std::vector<tests::SurfaceData>& data);

    /// The first law that the tick broke. @param before, after  the states round it
    [[nodiscard]] std::optional<Breach> look(const engine::Vec3& h,
                                             const engine::SurfaceState& before,
                                             const engine::SurfaceState& after,
                                             const engine::SurfaceContact& contact);

    /// Slides that were held to the end of their flow, and those of them whose end hangs on
    /// rounding.
    std::uint64_t walks = 0;
    std::uint64_t ties = 0;

private:
    struct Tick {
        engine::Vec3 h{};
        engine::SurfaceContact contact{};
    };
    void check_contact(const Tick& now);
    void check_walk(const Tick& now,
                    const engine::SurfaceState& before,
                    const engine::SurfaceState& after);
    void check_rest(const Tick& now,
                    const engine::SurfaceState& before,
                    const engine::SurfaceState& after);
    void check_flow(const Tick& now, const engine::SurfaceState& before);
    [[nodiscard]] const tests::SurfaceOracle& oracle(const engine::SurfaceContact& c) const {
        return oracles_[static_cast<std::size_t>(c.surface)];
    }
    [[nodiscard]] bool singular(const engine::SurfaceContact& c) const;
    [[nodiscard]] bool held_for_a_reason(const Tick& now) const;
    [[nodiscard]] bool step_bends(const Tick& now) const;
    [[nodiscard]] double foot_open(const Tick& now) const;

    const engine::SurfaceScene* scene_;
    std::vector<tests::SurfaceOracle> oracles_;
    double extent_ = 0.0;
    double same_ = 0.0;
    Tick last_{};
};

}  // namespace palpate::stress
