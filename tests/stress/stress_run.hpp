#pragma once

#include "tests/stress/surface_cases.hpp"
#include "tests/stress/tick_laws.hpp"

/// One random hand in one random scene, and how a failure becomes small enough to look at.
namespace palpate::stress {

struct Tally {
    std::uint64_t scenes = 0;
    std::uint64_t refused_scenes =
        0;  ///< no outline: a seam that runs back along itself, a mere point
    std::uint64_t ticks = 0;
    std::uint64_t in_contact = 0;
    std::uint64_t on_vertex = 0;
    std::uint64_t certified = 0;
    std::uint64_t walks = 0;      ///< held to the first root
    std::uint64_t ties = 0;       ///< of them, where rounding left more than one stop
    std::uint64_t unproven = 0;   ///< ticks whose closest point is not proven
    std::uint64_t unsettled = 0;  ///< ticks whose walk was ended by its work limit
    double slowest_s = 0.0;       ///< a tick, the best of several tries
    std::uint64_t slowest_seed = 0;
};

struct Case {
    std::uint64_t seed = 0;
    StressScene scene;
    std::shared_ptr<const engine::Outline> outline;
    std::vector<engine::Vec2> path;
};

/// Scene and hand of a seed; nothing if Outline refuses the chain.
[[nodiscard]] std::optional<Case> random_case(std::uint64_t seed, Mood mood);

/// The renderer of a case.
[[nodiscard]] engine::Scene renderer_of(const Case& c);

/// Feels the path and holds every tick to the laws; and feels it again beside that, bit for bit.
/// @param watch  ticks that seem slow are timed again
[[nodiscard]] std::optional<Breach> feel(const Case& c, Tally& tally, bool watch);
/// The same over a surface.
[[nodiscard]] std::optional<Breach> feel(const SurfaceCase& c, Tally& tally, bool watch);

/// The same breach in a path as short as it can be made by leaving ticks out: the last few ticks
/// that suffice, then these without what is not needed.
template <class AnyCase>
[[nodiscard]] AnyCase shrunk(AnyCase c, const Breach& breach) {
    const auto still = [&breach](const AnyCase& tried) {
        Tally none;
        const auto found = feel(tried, none, false);
        return found && found->law == breach.law;
    };
    c.path.resize(std::min(c.path.size(), breach.tick + 1));
    for (std::size_t keep = 1; keep < c.path.size(); keep *= 2) {
        AnyCase tail = c;
        tail.path.erase(tail.path.begin(), tail.path.end() - static_cast<std::ptrdiff_t>(keep));
        if (still(tail)) {
            c = tail;
            break;
        }
    }
    for (std::size_t chunk = c.path.size() / 2; chunk > 0; chunk /= 2) {
        for (std::size_t from = 0; from + chunk <= c.path.size();) {
            AnyCase less = c;
            const auto first = less.path.begin() + static_cast<std::ptrdiff_t>(from);
            less.path.erase(first, first + static_cast<std::ptrdiff_t>(chunk));
            if (!less.path.empty() && still(less)) {
                c = less;
            } else {
                from += chunk;
            }
        }
    }
    return c;
}

/// As `palpate render` reads it, every number with all its digits.
[[nodiscard]] std::string scene_text(const Case& c);
/// The path as `palpate render` reads it; ticks that are not finite are left out.
[[nodiscard]] std::string path_text(const Case& c);

}  // namespace palpate::stress
