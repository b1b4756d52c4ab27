#include "tests/stress/stress_scene.hpp"

#include "tests/support/nasty_curves.hpp"
#include "tests/support/scene_text.hpp"

namespace palpate::stress {
namespace {

using namespace palpate::tests;
using engine::Vec2;
using Chain = std::vector<NurbsData<2>>;

NurbsData<2> line(const Vec2& from, const Vec2& to) {
    return bezier_data({from, to});
}

/// Random curves that share their ends; weights, repeated knots and points as random_nurbs has
/// them.
Chain random_curves(Random& random) {
    Chain chain;
    const int count = 1 + random.below(4);
    const double decades = std::array<double, 3>{0.0, 1.0, 3.0}.at(random.index(3));
    for (int i = 0; i < count; ++i) {
        NurbsData<2> data = random_nurbs<2>(random, 1.0, decades);
        if (i > 0) {
            data.points.front() = chain.back().points.back();
        }
        chain.push_back(data);
    }
    if (random.coin()) {
        chain.back().points.back() = chain.front().points.front();
    }
    return chain;
}

/// Straight edges with vertices of any angle: hairs, spikes, turns of a billionth.
Chain random_edges(Random& random) {
    Chain chain;
    Vec2 at{};
    double heading = random.in(-std::numbers::pi, std::numbers::pi);
    const int count = 2 + random.below(6);
    for (int i = 0; i < count; ++i) {
        const double length = random.coin() ? random.in(0.1, 0.5) : random.decade(-4.0, -0.3);
        const Vec2 next = at + length * Vec2{std::cos(heading), std::sin(heading)};
        chain.push_back(line(at, next));
        at = next;
        const double sign = random.coin() ? 1.0 : -1.0;
        switch (random.below(4)) {
            case 0:
                heading += sign * random.decade(-12.0, 0.0);
                break;
            case 1:
                heading += sign * (std::numbers::pi - random.decade(-5.0, 0.0));
                break;
            default:
                heading += random.in(-3.1, 3.1);
        }
    }
    if (random.coin()) {
        chain.push_back(line(at, Vec2{}));
    }
    return chain;
}

/// The object of the study in any shape: two arcs over a base line.
Chain two_arcs(Random& random) {
    Chain chain;
    const Vec2 a{-0.5, random.in(-0.2, 0.2)};
    const Vec2 b{0.5, random.in(-0.2, 0.2)};
    const Vec2 tip{random.in(-0.4, 0.4),
                   random.coin() ? random.in(0.3, 1.0) : random.in(-0.3, 0.3)};
    const auto arc = [&](const Vec2& from, const Vec2& to) {
        const double max = 2.0 * engine::kMaxArcSine / glm::length(to - from);
        const double curvature = random.in(-0.95, 0.95) * max;
        const auto span = engine::make_arc(from, to, curvature);
        std::vector<Vec2> points;
        std::vector<double> weights;
        for (std::size_t i = 0; i <= static_cast<std::size_t>(span.degree()); ++i) {
            points.push_back(span.point(i));
            weights.push_back(span.weight(i));
        }
        points.front() = from;
        points.back() = to;
        chain.push_back(bezier_data(points, weights));
    };
    arc(a, tip);
    arc(tip, b);
    if (random.below(4) != 0) {
        chain.push_back(line(b, a));
    }
    return chain;
}

/// A closed blob of one B-spline about the origin, clockwise; smooth but for its seam.
Chain blob(Random& random) {
    NurbsData<2> curve;
    curve.degree = 2 + random.below(4);
    const int count = curve.degree + 4 + random.below(8);
    const auto p = static_cast<std::size_t>(curve.degree);
    curve.knots.assign(p + 1, 0.0);
    const bool even = random.coin();
    double at = 0.0;
    for (int i = 0; i < count - curve.degree - 1; ++i) {
        at += even ? 1.0 : random.decade(-2.0, 1.0);
        const int left = count - curve.degree - 1 - i;
        const int repeats =
            random.below(6) == 0 ? std::min(left, 1 + random.below(curve.degree)) : 1;
        curve.knots.insert(curve.knots.end(), static_cast<std::size_t>(repeats), at);
        i += repeats - 1;
    }
    curve.knots.insert(curve.knots.end(), p + 1, at + 1.0);
    const double rough = random.in(0.0, 0.8);
    const double decades = random.coin() ? 0.0 : random.in(0.0, 2.0);
    for (int i = 0; i < count; ++i) {
        const double angle = -2.0 * std::numbers::pi * i / (count - 1);
        const double radius = 0.5 * (1.0 - rough * random.in(0.0, 1.0));
        curve.points.push_back(radius * Vec2{std::cos(angle), std::sin(angle)});
        curve.weights.push_back(random.decade(-decades, decades));
    }
    curve.points.back() = curve.points.front();
    return {curve};
}

/// A family that breaks closest-point solvers, alone or closed by a line.
Chain nasty(Random& random) {
    const auto index = static_cast<std::uint64_t>(random.below(kNastyCurves));
    Chain chain{nasty_family(index, random).curve};
    const Vec2 from = chain.front().points.back();
    const Vec2 to = chain.front().points.front();
    if (random.coin() && glm::length(to - from) > 1e-3) {
        chain.push_back(line(from, to));
    }
    return chain;
}

Chain random_chain(Random& random, Mood mood) {
    if (mood == Mood::study) {
        return two_arcs(random);
    }
    if (mood == Mood::cusp) {
        return random.coin() ? nasty(random) : random_curves(random);
    }
    switch (random.below(mood == Mood::wild ? 6 : 3)) {
        case 0:
            return random_edges(random);
        case 1:
            return two_arcs(random);
        case 2:
            return blob(random);
        case 3:
            return nasty(random);
        default:
            return random_curves(random);
    }
}

}  // namespace

engine::Friction random_friction(Random& random, std::string_view law) {
    const auto time = [&random] {
        return random.below(4) == 0 ? 0.0 : random.decade(-4.0, 0.5);
    };
    const double mu_d = random.below(6) == 0 ? 0.0 : random.decade(-2.0, 0.7);
    if (law == "coulomb") {
        return {.mu_s = mu_d, .mu_d = mu_d};
    }
    if (law != "gos") {
        return {};
    }
    const double mu_s = mu_d + (random.below(4) == 0 ? 0.0 : random.decade(-2.0, 0.3));
    return {.mu_s = mu_s, .mu_d = mu_d, .tau_slip = time(), .tau_heal = time()};
}

StressScene random_scene(std::uint64_t seed, Mood mood) {
    Random random(seed);
    StressScene scene{.seed = seed, .segments = random_chain(random, mood)};
    const bool any_size = mood != Mood::study && !random.coin();
    const double size = any_size ? random.decade(-6.0, 3.0) : random.decade(-2.0, 0.0);
    const Vec2 away =
        random.below(6) == 0 ? random.decade(0.0, 2.0) * random.point(-1.0, 1.0) : Vec2{};
    for (NurbsData<2>& segment : scene.segments) {
        for (Vec2& point : segment.points) {
            point = size * (point + away);
        }
    }
    scene.renderer.stiffness = random.coin() ? 1000.0 : random.decade(0.0, 4.0);
    scene.renderer.damping = random.below(4) == 0 ? random.decade(-3.0, 1.0) : 0.0;
    const int law = random.below(4);
    scene.friction.law = kLaws.at(law == 3 ? 1 : static_cast<std::size_t>(law));
    scene.friction.set = random_friction(random, scene.friction.law);
    scene.friction.slew = {.speed = 0.0, .radius = 0.003};
    if (random.below(3) == 0 && (mood == Mood::gentle || mood == Mood::wild)) {
        scene.friction.slew = {.speed = size * random.decade(-1.0, 2.0),
                               .radius = size * random.decade(-3.0, 0.0)};
    }
    scene.period = random.coin() ? 0.001 : random.decade(-4.0, -2.0);
    return scene;
}

void reverse(StressScene& scene) {
    std::reverse(scene.segments.begin(), scene.segments.end());
    for (NurbsData<2>& s : scene.segments) {
        std::reverse(s.points.begin(), s.points.end());
        std::reverse(s.weights.begin(), s.weights.end());
        const double ends = s.knots.front() + s.knots.back();
        std::reverse(s.knots.begin(), s.knots.end());
        for (double& knot : s.knots) {
            knot = ends - knot;
        }
    }
}

protocols::SceneFile scene_file_of(const StressScene& scene) {
    protocols::SceneFile file;
    file.renderer = scene.renderer;
    file.friction = scene.friction;
    for (const NurbsData<2>& s : scene.segments) {
        file.curves.emplace_back(s.degree, s.knots, s.points, s.weights);
    }
    return file;
}

std::string friction_text(std::string_view law, const engine::Friction& friction) {
    std::string text = fmt::format("law = \"{}\"\n", law);
    if (law != "frictionless") {
        text += fmt::format("mu_d = {}\n", friction.mu_d);
    }
    if (law == "gos") {
        text += fmt::format("mu_s = {}\ntau_slip_s = {}\ntau_heal_s = {}\n", friction.mu_s,
                            friction.tau_slip, friction.tau_heal);
    }
    return text;
}

std::string scene_text(const StressScene& scene) {
    const protocols::SceneFriction& f = scene.friction;
    std::string text =
        fmt::format("# palpate_stress --seed {} --scenes 1\n[renderer]\n", scene.seed);
    text += fmt::format("stiffness_n_per_m = {}\ndamping_n_s_per_m = {}\n\n[friction]\n",
                        scene.renderer.stiffness, scene.renderer.damping);
    text += friction_text(f.law, f.set);
    text += fmt::format("vertex_slew_m_per_s = {}\nvertex_radius_m = {}\n", f.slew.speed,
                        f.slew.radius);
    for (const NurbsData<2>& s : scene.segments) {
        text += segment_text(s);
    }
    return text;
}

}  // namespace palpate::stress
