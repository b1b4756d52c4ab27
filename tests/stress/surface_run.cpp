#include "tests/stress/surface_run.hpp"

#include "tests/stress/surface_laws.hpp"

namespace palpate::stress {
namespace {

using Clock = std::chrono::steady_clock;

/// A tick that takes longer than this is timed again, s.
constexpr double kSurfaceSeemsSlow = 1e-4;

/// A tick may not take longer than this, s, unless it says that its work limit ended it.
constexpr double kSurfaceTooSlow = 2e-4;

double wall_seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The best of many tries.
double time_of(const engine::SurfaceScene& scene,
               const engine::SurfaceState& before,
               const engine::Vec3& h) {
    double best = 1.0;
    for (int i = 0; i < 20; ++i) {
        engine::SurfaceState state = before;
        const double start = processor_seconds();
        static_cast<void>(scene.tick(state, h));
        best = std::min(best, processor_seconds() - start);
    }
    return best;
}

}  // namespace

std::optional<Breach> feel(const SurfaceCase& c, Tally& tally, bool watch) {
    const engine::SurfaceScene scene(surfaces_of(c), engine::SurfaceSceneSpec{.contact = c.spec});
    SurfaceLaws laws(scene, c.pieces.empty() ? std::vector{c.data} : c.pieces);
    engine::SurfaceState state;
    for (std::size_t i = 0; i < c.path.size(); ++i) {
        const engine::SurfaceState before = state;
        const auto start = Clock::now();
        const engine::SurfaceContact contact = scene.tick(state, c.path[i]);
        if (watch && wall_seconds_since(start) > kSurfaceSeemsSlow) {
            const double best = time_of(scene, before, c.path[i]);
            if (best > tally.slowest_s) {
                tally.slowest_s = best;
                tally.slowest_seed = c.seed;
            }
            if (best > kSurfaceTooSlow && contact.settled && contact.cp.proven) {
                return Breach{.law = "a tick takes bounded time, or says that it was ended",
                              .tick = i,
                              .value = best,
                              .limit = kSurfaceTooSlow};
            }
        }
        ++tally.ticks;
        tally.in_contact += contact.mode != engine::Mode::free ? 1U : 0U;
        tally.unproven += contact.cp.proven && contact.on_flow ? 0U : 1U;
        tally.unsettled += contact.settled ? 0U : 1U;
        if (i % 8 == 0) {
            engine::SurfaceState again = before;
            const engine::SurfaceContact twin = scene.tick(again, c.path[i]);
            if (std::memcmp(&twin.force, &contact.force, sizeof twin.force) != 0) {
                return Breach{.law = "the same path gives the same bits", .tick = i};
            }
        }
        if (auto breach = laws.look(c.path[i], before, state, contact)) {
            return breach;
        }
    }
    tally.certified += state.track.certified_calls;
    tally.walks += laws.walks();
    tally.ties += laws.ties();
    return std::nullopt;
}

}  // namespace palpate::stress
