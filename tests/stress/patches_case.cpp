#include "tests/stress/surface_cases.hpp"
#include "tests/support/surface_cuts.hpp"

namespace palpate::stress {

using namespace palpate::tests;
using engine::Vec3;

std::optional<SurfaceCase> random_patches_case(std::uint64_t seed, Mood mood) {
    SurfaceCase c = random_surface_case(seed, mood);
    Random random(seed + 5'000'000U);
    const SurfaceData whole = turned_by(c.data, random.below(2));
    // At a knot, mostly: there the surface is as smooth as its pieces allow.
    const auto cut = [&random](const std::vector<double>& knots) {
        const double knot = knots[random.index(knots.size())];
        return knot > knots.front() && knot < knots.back()
                 ? knot
                 : knots.front() + random.in(0.2, 0.8) * (knots.back() - knots.front());
    };
    const double v = cut(whole.knots_v);
    const bool across = random.coin();
    const auto halves = cut_u(whole, cut(whole.knots_u));
    for (const SurfaceData& half : {halves.first, halves.second}) {
        if (!across) {
            c.pieces.push_back(half);
            continue;
        }
        const auto parts = cut_u(turned(half), v);  // u runs as v did
        c.pieces.push_back(parts.first);
        c.pieces.push_back(parts.second);
    }
    if (random.coin()) {
        const double bend = c.surface->size() * random.decade(-3.0, -0.7);
        for (SurfaceData& d : c.pieces) {
            const double x = random.in(-1.0, 1.0);
            const double y = random.in(-1.0, 1.0);
            const Vec3 by = bend * Vec3{x, y, random.in(-1.0, 1.0)};
            for (std::size_t i = 1; i + 1 < d.points.size(); ++i) {
                for (std::size_t j = 1; j + 1 < d.points[i].size(); ++j) {
                    d.points[i][j] += by;
                }
            }
        }
    }
    for (SurfaceData& d : c.pieces) {
        d = turned_by(d, random.below(4));
    }
    try {
        static_cast<void>(engine::SurfaceObject(surfaces_of(c)));
    } catch (const std::invalid_argument&) {
        return std::nullopt;
    }
    return c;
}

std::vector<std::shared_ptr<const engine::NurbsSurface>> surfaces_of(const SurfaceCase& c) {
    if (c.pieces.empty()) {
        return {c.surface};
    }
    return made(c.pieces);
}

}  // namespace palpate::stress
