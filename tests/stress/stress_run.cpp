#include "tests/stress/stress_run.hpp"

#include <ctime>

#include "tests/stress/stress_scene.hpp"
#include "tests/stress/surface_laws.hpp"

namespace palpate::stress {
namespace {

using namespace palpate::engine;
using Clock = std::chrono::steady_clock;

/// What a tick may take, s.
struct Patience {
    double seems_slow = 0.0;  ///< one that takes longer is timed again
    double too_slow = 0.0;    ///< and may not take longer than this
    int tries = 0;            ///< of which the best counts
};
/// A hundred times what a nasty one needs.
constexpr Patience kPlane{.seems_slow = 2e-4, .too_slow = 0.02, .tries = 5};
/// Unless it says that its work limit ended it.
constexpr Patience kSurface{.seems_slow = 1e-4, .too_slow = 2e-4, .tries = 20};

/// Ends within 1e-9 m of each other are one: smaller objects fall into themselves, m.
constexpr double kMinSize = 1e-8;

/// Of the processor, by this thread alone, s: on a busy machine the clock on the wall tells of
/// others.
double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A tick that began at `start` in `before`: where it seemed slow it is timed again, without what
/// else the machine does, the best of a few tries. @return s if that is too slow as well
template <class Scene, class State, class Point>
std::optional<double> too_slow(Tally& tally,
                               std::uint64_t seed,
                               Clock::time_point start,
                               const Patience& patience,
                               const Scene& scene,
                               const State& before,
                               const Point& h) {
    if (std::chrono::duration<double>(Clock::now() - start).count() <= patience.seems_slow) {
        return std::nullopt;
    }
    double best = 1.0;
    for (int i = 0; i < patience.tries; ++i) {
        State state = before;
        const double from = processor_seconds();
        static_cast<void>(scene.tick(state, h));
        best = std::min(best, processor_seconds() - from);
    }
    if (best > tally.slowest_s) {
        tally.slowest_s = best;
        tally.slowest_seed = seed;
    }
    return best > patience.too_slow ? std::optional(best) : std::nullopt;
}

template <class AnyContact>
bool same_bits(const AnyContact& a, const AnyContact& b) {
    return std::memcmp(&a.force, &b.force, sizeof a.force) == 0 &&
           std::memcmp(&a.go, &b.go, sizeof a.go) == 0 && a.mode == b.mode;
}

/// A tick that says that its work limit ended it may be slow.
bool was_ended(const Contact& /*contact*/) {
    return false;
}
bool was_ended(const SurfaceContact& contact) {
    return !contact.settled || !contact.cp.proven;
}

void count(const Contact& contact, Tally& tally) {
    tally.on_vertex += !free(contact) && contact.place.on_seam ? 1U : 0U;
}
void count(const SurfaceContact& contact, Tally& tally) {
    tally.unproven += contact.cp.proven && contact.on_flow ? 0U : 1U;
    tally.unsettled += contact.settled ? 0U : 1U;
}

template <class AnyCase, class Scene, class Laws, class State>
std::optional<Breach> feel_all(const AnyCase& c,
                               const Scene& scene,
                               Laws& laws,
                               State& state,
                               const Patience& patience,
                               Tally& tally,
                               bool watch) {
    State twin = state;
    for (std::size_t i = 0; i < c.path.size(); ++i) {
        const State before = state;
        const auto start = Clock::now();
        const auto contact = scene.tick(state, c.path[i]);
        if (watch) {
            const auto s = too_slow(tally, c.seed, start, patience, scene, before, c.path[i]);
            if (s && !was_ended(contact)) {
                return Breach{"a tick takes bounded time, or says that it was ended", i, *s,
                              patience.too_slow};
            }
        }
        ++tally.ticks;
        tally.in_contact += free(contact) ? 0U : 1U;
        count(contact, tally);
        if (!same_bits(scene.tick(twin, c.path[i]), contact)) {
            return Breach{.law = "the same path gives the same bits", .tick = i};
        }
        if (auto breach = laws.look(c.path[i], before, state, contact)) {
            return breach;
        }
    }
    tally.walks += laws.walks;
    tally.ties += laws.ties;
    return std::nullopt;
}

}  // namespace

std::optional<Case> random_case(std::uint64_t seed, Mood mood) {
    Case c{.seed = seed, .scene = random_scene(seed, mood), .outline = {}, .path = {}};
    for (int i = 0; i < 2 && !c.outline; ++i) {
        try {
            c.outline =
                std::make_shared<const Outline>(protocols::outline_of(scene_file_of(c.scene)));
        } catch (const std::invalid_argument&) {
            reverse(c.scene);
        }
    }
    if (!c.outline || size_of(*c.outline) < kMinSize) {
        return std::nullopt;
    }
    tests::Random random(seed ^ 0x5EEDU);
    c.path = random_path(random, *c.outline,
                         {.ticks = 100 + random.index(500),
                          .period = c.scene.period,
                          .broken = random.coin(),
                          .far = random.below(8) == 0,
                          .leaps = mood == Mood::huge,
                          .gentle = mood == Mood::gentle || mood == Mood::study});
    return c;
}

engine::Scene renderer_of(const Case& c) {
    return {c.outline, protocols::spec_of(scene_file_of(c.scene), c.scene.period)};
}

std::optional<Breach> feel(const Case& c, Tally& tally, bool watch) {
    const engine::Scene scene = renderer_of(c);
    TickLaws laws(scene);
    ContactState state;
    const auto breach = feel_all(c, scene, laws, state, kPlane, tally, watch);
    tally.certified += laws.certified();
    return breach;
}

std::optional<Breach> feel(const SurfaceCase& c, Tally& tally, bool watch) {
    const engine::SurfaceScene scene(surfaces_of(c), engine::SurfaceSceneSpec{.contact = c.spec});
    SurfaceLaws laws(scene, c.pieces.empty() ? std::vector{c.data} : c.pieces);
    engine::SurfaceState state;
    const auto breach = feel_all(c, scene, laws, state, kSurface, tally, watch);
    tally.certified += state.track.certified_calls;
    return breach;
}

std::string scene_text(const Case& c) {
    return scene_text(c.scene);
}

std::string path_text(const Case& c) {
    return path_text(c.path, c.scene.period);
}

}  // namespace palpate::stress
