#include <CLI/CLI.hpp>

#include "tests/stress/stress_run.hpp"

/// Hours of random hands in minutes: every tick of random contacts held to the laws.
namespace {

using namespace palpate::stress;

struct Options {
    double seconds = 60.0;
    std::uint64_t seed = 1;
    std::uint64_t scenes = UINT64_MAX;
    std::string out = ".";
    std::string mood = "wild";
    std::string object = "outline";
};

void declare(CLI::App& app, Options& options) {
    app.description(
        "Random scenes from seed S on, until N seconds are over or so many scenes were felt.\n"
        "A failure writes DIR/stress_SEED.toml and .csv, which `palpate render` reads if they do "
        "not cross themselves.");
    app.add_option("--seconds", options.seconds, "N");
    app.add_option("--seed", options.seed, "S");
    app.add_option("--scenes", options.scenes, "so many");
    app.add_option("--mood", options.mood)
        ->check(CLI::IsMember(std::vector<std::string>(kMoods.begin(), kMoods.end())));
    app.add_option("--object", options.object)
        ->check(CLI::IsMember({"outline", "surface", "patches"}));
    app.add_option("--out", options.out, "DIR");
}

/// At most so many reproducers of one law are written.
constexpr int kKept = 5;

template <class AnyCase>
void report(const AnyCase& c, const Breach& breach, const std::string& folder) {
    const AnyCase small = shrunk(c, breach);
    Tally none;
    const auto found = feel(small, none, false);
    const Breach& last = found ? *found : breach;
    const std::string name = fmt::format("{}/stress_{}", folder, c.seed);
    std::ofstream(name + ".toml") << scene_text(small);
    std::ofstream(name + ".csv") << path_text(small);
    fmt::print(
        "BROKEN: {}: {} above {}, seed {} tick {}; in {}.toml and .csv tick {} of {}, {} above "
        "{}\n",
        breach.law, breach.value, breach.limit, c.seed, breach.tick, name, last.tick,
        small.path.size(), last.value, last.limit);
}

template <class AnyCase>
void judge(const std::optional<AnyCase>& c,
           const Options& options,
           Tally& tally,
           std::map<std::string, int>& broken) {
    tally.refused_scenes += c ? 0U : 1U;
    const auto breach = c ? feel(*c, tally, true) : std::nullopt;
    if (breach && ++broken[breach->law] <= kKept) {
        report(*c, *breach, options.out);
        std::fflush(stdout);
    }
}

}  // namespace

int main(int count, char** arguments) {
    Options options;
    CLI::App app;
    declare(app, options);
    CLI11_PARSE(app, count, arguments);
    const auto mood = static_cast<Mood>(std::ranges::find(kMoods, options.mood) - kMoods.begin());
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&start] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    Tally tally;
    std::map<std::string, int> broken;
    for (std::uint64_t seed = options.seed;
         tally.scenes < options.scenes && seconds() < options.seconds; ++seed) {
        ++tally.scenes;
        if (options.object == "surface") {
            judge(std::optional(random_surface_case(seed, mood)), options, tally, broken);
        } else if (options.object == "patches") {
            judge(random_patches_case(seed, mood), options, tally, broken);
        } else {
            judge(random_case(seed, mood), options, tally, broken);
        }
    }
    fmt::print(
        "{} scenes from seed {} ({} refused), {} ticks, {} in contact, {} on vertices, {} "
        "certified, {} walks ({} ties), {} unproven, {} unsettled; slowest tick {:.3f} ms (seed "
        "{}); {:.0f} s\n",
        tally.scenes, options.seed, tally.refused_scenes, tally.ticks, tally.in_contact,
        tally.on_vertex, tally.certified, tally.walks, tally.ties, tally.unproven, tally.unsettled,
        1e3 * tally.slowest_s, tally.slowest_seed, seconds());
    for (const auto& [law, times] : broken) {
        fmt::print("  broken in {} scenes: {}\n", times, law);
    }
    return broken.empty() ? 0 : 1;
}
