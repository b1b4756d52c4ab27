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

bool same_bits(const Contact& a, const Contact& b) {
    return std::memcmp(&a.force, &b.force, sizeof a.force) == 0 &&
           std::memcmp(&a.go, &b.go, sizeof a.go) == 0 && a.mode == b.mode;
}

std::optional<Breach> feel_again(const engine::Scene& scene,
                                 ContactState state,
                                 std::size_t from,
                                 const std::vector<Vec2>& path,
                                 const std::vector<Contact>& felt) {
    for (std::size_t i = from; i < felt.size(); ++i) {
        if (!same_bits(scene.tick(state, path[i]), felt[i])) {
            return Breach{.law = "the same path gives the same bits", .tick = i};
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<Case> random_case(std::uint64_t seed, Mood mood) {
    Case c;
    c.scene = random_scene(seed, mood);
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
    ContactState middle;
    const std::size_t half = c.path.size() / 2;
    std::vector<Contact> felt;
    felt.reserve(c.path.size());
    for (std::size_t i = 0; i < c.path.size(); ++i) {
        if (i == half) {
            middle = state;
        }
        const ContactState before = state;
        const auto start = Clock::now();
        const Contact contact = scene.tick(state, c.path[i]);
        if (watch) {
            if (const auto s =
                    too_slow(tally, c.scene.seed, start, kPlane, scene, before, c.path[i])) {
                return Breach{"a tick takes bounded time", i, *s, kPlane.too_slow};
            }
        }
        ++tally.ticks;
        tally.in_contact += contact.mode != engine::Mode::free ? 1U : 0U;
        tally.on_vertex += contact.mode != engine::Mode::free && contact.place.on_seam ? 1U : 0U;
        felt.push_back(contact);
        if (auto breach = laws.look(c.path[i], before, state, contact)) {
            return breach;
        }
    }
    tally.certified += laws.certified();
    tally.walks += laws.walks;
    tally.ties += laws.ties;
    return feel_again(scene, middle, half, c.path, felt);
}

std::optional<Breach> feel(const SurfaceCase& c, Tally& tally, bool watch) {
    const engine::SurfaceScene scene(surfaces_of(c), engine::SurfaceSceneSpec{.contact = c.spec});
    SurfaceLaws laws(scene, c.pieces.empty() ? std::vector{c.data} : c.pieces);
    engine::SurfaceState state;
    for (std::size_t i = 0; i < c.path.size(); ++i) {
        const engine::SurfaceState before = state;
        const auto start = Clock::now();
        const engine::SurfaceContact contact = scene.tick(state, c.path[i]);
        if (watch) {
            const auto s = too_slow(tally, c.seed, start, kSurface, scene, before, c.path[i]);
            if (s && contact.settled && contact.cp.proven) {
                return Breach{"a tick takes bounded time, or says that it was ended", i, *s,
                              kSurface.too_slow};
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

std::string scene_text(const Case& c) {
    return scene_text(c.scene);
}

std::string path_text(const Case& c) {
    return path_text(c.path, c.scene.period);
}

}  // namespace palpate::stress
