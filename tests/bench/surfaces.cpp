#include "tests/bench/surfaces.hpp"

#include "engine/surface/surface_scene.hpp"
#include "tests/figures/thesis/surface_tracker.hpp"
#include "tests/support/outlines.hpp"
#include "tests/support/surface_cuts.hpp"

namespace palpate::bench {
namespace {

Surface hills(const std::string& name, bool rational) {
    Surface surface;
    surface.name = name;
    surface.columns = surface.rows = 8;
    surface.knots_u = surface.knots_v = {0, 0, 0, 0, 0.2, 0.4, 0.6, 0.8, 1, 1, 1, 1};
    tests::Random random(8);
    for (std::size_t j = 0; j < surface.rows; ++j) {
        for (std::size_t i = 0; i < surface.columns; ++i) {
            surface.points.push_back({0.1 * (static_cast<double>(i) / 7.0 - 0.5),
                                      0.1 * (static_cast<double>(j) / 7.0 - 0.5),
                                      random.in(-0.008, 0.008)});
            const double weight = std::exp(random.in(-0.7, 0.7));
            surface.weights.push_back(rational ? weight : 1.0);
        }
    }
    return surface;
}

tests::SurfaceData data_of(const Surface& surface) {
    std::vector<std::vector<Vec3>> points(surface.columns);
    std::vector<std::vector<double>> weights(surface.columns);
    for (std::size_t i = 0; i < surface.columns; ++i) {
        for (std::size_t j = 0; j < surface.rows; ++j) {
            points[i].push_back(surface.points[j * surface.columns + i]);
            weights[i].push_back(surface.weights[j * surface.columns + i]);
        }
    }
    return {kSurfaceDegree, kSurfaceDegree, surface.knots_u, surface.knots_v, points, weights};
}

/// S and its five derivatives, each evaluation waiting for the one before.
struct SurfaceEvaluation {
    std::shared_ptr<const engine::NurbsSurface> surface;
    engine::SurfacePlace at{.i = 0, .j = 0, .u = 0.4, .v = 0.6};

    void reset(const Vec3& /*first*/) {}
    Answer<3> answer(const Vec3& /*hip*/) {
        const engine::SurfaceJet jet = surface->local_jet(at);
        keep(jet);
        at.u = 0.4 + 1e-30 * jet.point.x;
        return {jet.point, at.u};
    }
};

struct CertifiedSurface {
    std::shared_ptr<const engine::SurfaceFeet> feet;
    engine::SurfaceTrack track{};

    void reset(const Vec3& /*first*/) { track = {}; }
    Answer<3> answer(const Vec3& hip) {
        const engine::SurfaceClosest found = feet->track(track, hip);
        return {found.point, found.distance};
    }
};

/// The thesis' tracker, with its state machine of features where there are several surfaces.
struct ThesisSurface {
    std::shared_ptr<const figures::SurfaceTracker> tracker;
    figures::SurfaceTrackerState state{};

    void reset(const Vec3& first) { state = tracker->start(first); }
    Answer<3> answer(const Vec3& hip) {
        const figures::TrackedSpot found = tracker->step(state, hip, 1e-3);
        return {found.point, found.distance};
    }
};

struct GlobalSurface {
    std::shared_ptr<const engine::SurfaceFeet> feet;

    void reset(const Vec3& /*first*/) {}
    Answer<3> answer(const Vec3& hip) {
        const engine::SurfaceClosest found = feet->closest(hip);
        return {found.point, found.distance};
    }
};

/// A whole tick of a scene in space.
struct SurfaceTick {
    std::shared_ptr<const engine::SurfaceScene> scene;
    engine::SurfaceState state{};

    SurfaceTick(const tests::Pieces& surfaces,
                const engine::Friction& friction,
                bool look_in_contact = true)
        : scene(std::make_shared<const engine::SurfaceScene>(
              surfaces,
              engine::SurfaceSceneSpec{.contact = {.friction = friction},
                                       .look_in_contact = look_in_contact})) {}
    void reset(const Vec3& /*first*/) { state = {}; }
    Answer<3> answer(const Vec3& hip) {
        const engine::SurfaceContact contact = scene->tick(state, hip);
        keep(contact.force);
        return {contact.cp.point, contact.cp.distance};
    }
};

}  // namespace

std::vector<Surface> contact_surfaces() {
    return {hills("bicubic 8x8", false), hills("rational bicubic 8x8", true)};
}

std::vector<Vec3> hand_over(const Surface& surface, double seconds) {
    const double tau = 2.0 * std::numbers::pi;
    const auto made = tests::made(data_of(surface));
    const auto at = [&](double phase, double t) {
        const double u = 0.5 + 0.42 * std::sin(phase);
        const double v = 0.5 + 0.42 * std::sin(0.618 * phase + 1.0);
        const double offset =
            1.8e-3 * std::sin(tau * t / 1.7) + 1.2e-3 * std::sin(tau * t / 0.61 + 1.0);
        return made->at(u, v).point + offset * made->normal(u, v);
    };
    double phase = 0.0;
    Vec3 hand = at(phase, 0.0);
    std::vector<Vec3> path;
    const auto ticks = static_cast<std::size_t>(std::lround(seconds * 1000.0));
    for (std::size_t i = 0; i < ticks; ++i) {
        const double t = 1e-3 * static_cast<double>(i);
        const double reach = 1e-3 * (0.1 + 0.07 * std::sin(tau * t / 2.9));
        Vec3 next = at(phase, t);
        for (int step = 0; step < 4000 && glm::length(next - hand) < reach; ++step) {
            phase += 1e-4;
            next = at(phase, t);
        }
        hand = next;
        Vec3 shaken = hand;
        for (int k = 0; k < 3; ++k) {
            shaken[k] += 0.05e-3 * std::sin(tau * 9.0 * t + 2.1 * k);
            shaken[k] = 1e-5 * std::round(shaken[k] / 1e-5);
        }
        path.push_back(shaken);
    }
    return path;
}

std::vector<Vec3> grid_of(const Surface& surface, std::size_t n) {
    const auto made = tests::made(data_of(surface));
    std::vector<Vec3> corners;
    corners.reserve((n + 1) * (n + 1));
    const auto count = static_cast<double>(n);
    for (std::size_t j = 0; j <= n; ++j) {
        for (std::size_t i = 0; i <= n; ++i) {
            const double u = surface.knots_u.back() * static_cast<double>(i) / count;
            const double v = surface.knots_v.back() * static_cast<double>(j) / count;
            corners.push_back(made->at(u, v).point);
        }
    }
    return corners;
}

std::vector<Truth<3>> truths(const Surface& surface, const std::vector<Vec3>& path) {
    tests::SurfaceOracle oracle(data_of(surface));
    std::vector<Truth<3>> all;
    for (const Vec3& hip : path) {
        const tests::LongFoot foot = oracle.closest(hip);
        all.push_back({std::sqrt(foot.distance2), Vec3(foot.point)});
    }
    return all;
}

Methods<3> own_surface_methods(const Surface& surface) {
    Methods<3> methods;
    const tests::SurfaceData data = data_of(surface);
    const auto made = tests::made(data);
    const auto add = [&](const char* name, Kind kind, auto part) {
        methods.push_back(make_method<3>(name, kind, std::move(part)));
    };
    add("one evaluation", Kind::floor, SurfaceEvaluation{made});
    const auto feet = std::make_shared<const engine::SurfaceFeet>(made);
    add("certified", Kind::global, CertifiedSurface{feet});
    add("global, cold", Kind::global, GlobalSurface{feet});
    add("tick, friction", Kind::floor, SurfaceTick({made}, tests::kStudyFriction));
    add("tick, friction, force only", Kind::floor,
        SurfaceTick({made}, tests::kStudyFriction, false));
    add("tick, frictionless", Kind::floor, SurfaceTick({made}, {}));
    add("tick, frictionless, force only", Kind::floor, SurfaceTick({made}, {}, false));
    tests::Random turns(1);  // cut between knots, where no patch of the whole ends
    const tests::Pieces four = tests::made(tests::quarters(data, 0.5, 0.47, turns));
    const auto joined = std::make_shared<const engine::SurfaceObject>(four);
    add("four joined, certified", Kind::global,
        CertifiedSurface{std::make_shared<const engine::SurfaceFeet>(joined)});
    add("four joined, tick, friction", Kind::floor, SurfaceTick(four, tests::kStudyFriction));
    add("four joined, tick, friction, force only", Kind::floor,
        SurfaceTick(four, tests::kStudyFriction, false));
    const figures::TrackerSpec feedback{.gain = figures::feedback_gain(*joined, 1.0, 1e-3)};
    const figures::TrackerSpec newton{.kind = figures::TrackerKind::newton};
    add("four joined, thesis feedback", Kind::tracker,
        ThesisSurface{std::make_shared<const figures::SurfaceTracker>(joined, feedback)});
    add("four joined, thesis newton x1", Kind::tracker,
        ThesisSurface{std::make_shared<const figures::SurfaceTracker>(joined, newton)});
    return methods;
}

}  // namespace palpate::bench
