#include "protocols/file/scene_file.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "protocols/file/protocol_file.hpp"
#include "protocols/file/read_text.hpp"
#include "protocols/file/segment_table.hpp"
#include "protocols/file/table_view.hpp"

namespace palpate::protocols {
namespace {

using engine::Vec3;

/// Ends nearer than this, m, close the chain; the same as Outline asks of a joint.
constexpr double kSameEnd = 1e-9;

constexpr std::array<std::string_view, 5> kLaws{"frictionless", "gos", "coulomb", "thesis_literal",
                                                "thesis_latched"};
constexpr std::array<std::string_view, 6> kTrackers{
    "certified", "feedback", "feed_forward", "feedback_linearised", "tangent_plane", "newton"};

SceneRenderer read_renderer(TableView table) {
    SceneRenderer r;
    r.stiffness = table.number("stiffness_n_per_m", {.lowest = 0.0, .above = true}, r.stiffness);
    r.damping = table.number("damping_n_s_per_m", {.lowest = 0.0}, r.damping);
    const std::size_t kind = table.choice("tracker", kTrackers, 0);
    r.certified = kind == 0;
    if (!r.certified) {
        r.tracker.kind = engine::tracker_kind_from_string(kTrackers.at(kind));
    }
    const bool gain = kind >= 1 && kind <= 3;
    if (gain) {
        r.tracker.gain = table.required_number("gain", {.lowest = 0.0, .above = true});
    }
    r.tracker.sub_steps = static_cast<int>(
        table.integer("sub_steps", {.lowest = 1.0, .highest = 1000.0}, r.tracker.sub_steps));
    r.tracker.rate_hz = table.number("rate_hz", {.lowest = 0.0, .above = true}, r.tracker.rate_hz);
    r.tracker.iterations = static_cast<int>(
        table.integer("iterations", {.lowest = 1.0, .highest = 100.0}, r.tracker.iterations));
    table.refuse_unknown();
    return r;
}

SceneFriction read_friction(TableView table) {
    SceneFriction f;
    const std::size_t law = table.choice("law", kLaws, 1);
    f.law = static_cast<Law>(law);
    // Keys that a law does not use may stay, so that laws can be compared by changing one word.
    const bool rubs = f.law != Law::frictionless;
    const Range from_zero{.lowest = 0.0, .highest = 10.0};
    const double mu_d =
        rubs ? table.required_number("mu_d", from_zero) : table.number("mu_d", from_zero, 0.0);
    const double mu_s = rubs && f.law != Law::coulomb ? table.required_number("mu_s", from_zero)
                                                      : table.number("mu_s", from_zero, mu_d);
    const double slip = table.number("tau_slip_s", from_zero, 0.0);
    const double heal = table.number("tau_heal_s", from_zero, 0.0);
    if (mu_s < mu_d) {
        table.refuse("mu_s", fmt::format("mu_s is {}, below mu_d = {}: static friction is not "
                                         "smaller than dynamic friction",
                                         mu_s, mu_d));
    }
    if (f.law == Law::coulomb) {
        f.set = {.mu_s = mu_d, .mu_d = mu_d};
    } else if (rubs) {
        f.set = {.mu_s = mu_s, .mu_d = mu_d, .tau_slip = slip, .tau_heal = heal};
    }
    f.slew.speed = table.number("vertex_slew_m_per_s", {.lowest = 0.0, .highest = 1e6}, 0.0);
    f.slew.radius =
        table.number("vertex_radius_m", {.lowest = 0.0, .highest = 1e3, .above = true}, 0.003);
    f.dead_band = table.number("dead_band_m_per_s", {.lowest = 0.0, .highest = 1e3}, 0.0);
    table.refuse_unknown();
    return f;
}

void read_segment(TableView table, SceneFile& scene) {
    const SegmentTable segment = read_segment_table(table);
    table.attempt([&] {
        if (segment.points.dimension == 2) {
            scene.curves.push_back(curve_of(plane_segment(segment)));
        } else if (segment.kind == stimuli::Segment::Kind::nurbs) {
            scene.space_curves.emplace_back(segment.degree, segment.knots, segment.points.space(),
                                            segment.weights);
        } else {
            const std::vector<double> knots{0, 0, 1, 1};
            scene.space_curves.emplace_back(1, knots, segment.points.space());
        }
    });
}

void read_surface(TableView table, SceneFile& scene) {
    const int degree_u = static_cast<int>(table.required_integer("degree_u", {.lowest = 1.0}));
    const int degree_v = static_cast<int>(table.required_integer("degree_v", {.lowest = 1.0}));
    const std::vector<double> knots_u = table.numbers("knots_u");
    const std::vector<double> knots_v = table.numbers("knots_v");
    const std::vector<std::vector<Vec3>> points = table.point_grid("points_m");
    const std::vector<std::vector<double>> weights = table.number_grid_or_none("weights");
    table.refuse_unknown();
    table.attempt([&] {
        scene.surfaces.emplace_back(degree_u, degree_v, knots_u, knots_v, points, weights);
    });
}

/// What holds across tables.
void check_whole(const SceneFile& scene, const Position& at, Problems& problems) {
    const int kinds = static_cast<int>(!scene.curves.empty()) +
                      static_cast<int>(!scene.space_curves.empty()) +
                      static_cast<int>(!scene.surfaces.empty());
    if (kinds == 0) {
        problems.add(at, "there is nothing to feel: add [[segment]] tables, or one [surface]");
    } else if (kinds > 1) {
        problems.add(
            at, "the scene mixes plane curves, curves in space and a surface: keep one of them");
    }
    if (!scene.surfaces.empty() && scene.renderer.damping > 0.0) {
        problems.add(at, "damping_n_s_per_m is for plane curves: on a [surface] leave it out");
    }
    if (!scene.surfaces.empty() &&
        (!scene.renderer.certified || scene.friction.law == Law::thesis_literal ||
         scene.friction.law == Law::thesis_latched)) {
        problems.add(
            at,
            "the thesis' trackers and laws are for plane curves: on a [surface] give tracker "
            "\"certified\" and law \"gos\", \"coulomb\" or \"frictionless\"");
    }
}

}  // namespace

SceneFile parse_scene(std::string_view text, std::string_view file_name) {
    const Table file = parse_document(text, file_name);
    Problems problems;
    SceneFile scene;
    TableView top(file, "the scene", {}, problems);
    if (const auto table = top.table("renderer")) {
        scene.renderer = read_renderer(*table);
    }
    if (const auto table = top.table("friction")) {
        scene.friction = read_friction(*table);
    }
    for (const TableView& table : top.tables("segment")) {
        read_segment(table, scene);
    }
    if (const auto table = top.table("surface")) {
        read_surface(*table, scene);
    }
    top.refuse_unknown();
    problems.throw_if_any(file_name);
    check_whole(scene, {}, problems);
    problems.throw_if_any(file_name);
    return scene;
}

SceneFile load_scene(const std::filesystem::path& file) {
    return parse_scene(read_text(file, kMostDocument), file.string());
}

engine::Outline outline_of(const SceneFile& scene) {
    const auto& first = scene.curves.front();
    const auto& last = scene.curves.back();
    const double gap = glm::length(last.at(last.back()).point - first.at(first.front()).point);
    return {scene.curves, gap <= kSameEnd};
}

engine::SceneSpec spec_of(const SceneFile& scene, double period) noexcept {
    return {.stiffness = scene.renderer.stiffness,
            .damping = scene.renderer.damping,
            .period = period,
            .friction = scene.friction.set,
            .slew = scene.friction.slew,
            .look = engine::Look::always};
}

}  // namespace palpate::protocols
