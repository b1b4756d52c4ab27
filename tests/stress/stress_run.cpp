#include "tests/stress/stress_run.hpp"

#include <ctime>

#include "tests/stress/stress_hand.hpp"

namespace palpate::stress {
namespace {

using namespace palpate::engine;
using Clock = std::chrono::steady_clock;

/// A tick that takes longer than this is timed again, s.
constexpr double kSeemsSlow = 2e-4;

/// A tick may not take longer than this, s: a hundred times what a nasty one needs.
constexpr double kTooSlow = 0.02;

/// Ends within 1e-9 m of each other are one: smaller objects fall into themselves, m.
constexpr double kMinSize = 1e-8;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Without what else the machine does: the best of a few tries.
double time_of(const engine::Scene& scene, const ContactState& before, const Vec2& h) {
    double best = 1.0;
    for (int i = 0; i < 5; ++i) {
        ContactState state = before;
        const double start = processor_seconds();
        static_cast<void>(scene.tick(state, h));
        best = std::min(best, processor_seconds() - start);
    }
    return best;
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

double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

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
        if (watch && seconds_since(start) > kSeemsSlow) {
            const double best = time_of(scene, before, c.path[i]);
            if (best > tally.slowest_s) {
                tally.slowest_s = best;
                tally.slowest_seed = c.scene.seed;
            }
            if (best > kTooSlow) {
                return Breach{.law = "a tick takes bounded time",
                              .tick = i,
                              .value = best,
                              .limit = kTooSlow};
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

std::string scene_text(const Case& c) {
    return scene_text(c.scene);
}

std::string path_text(const Case& c) {
    std::string text = "t_s,x_m,y_m\n";
    for (std::size_t i = 0; i < c.path.size(); ++i) {
        const Vec2& h = c.path[i];
        if (std::isfinite(h.x) && std::isfinite(h.y)) {
            text += fmt::format("{},{},{}\n", static_cast<double>(i) * c.scene.period, h.x, h.y);
        }
    }
    return text;
}

}  // namespace palpate::stress
