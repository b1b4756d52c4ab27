#include "protocols/file/scene_file.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/surface/surface_object.hpp"
#include "engine/surface/surface_trim.hpp"
#include "protocols/file/document.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/file/object_tables.hpp"
#include "protocols/file/outline_shape.hpp"

namespace palpate::protocols {
namespace {

/// What [friction] says.
struct FrictionTable {
    SceneFriction friction{.law = "gos", .slew = {.speed = 0.0, .radius = 0.003}};
};

struct SurfaceTable {
    int degree_u = 1;
    int degree_v = 1;
    std::vector<double> knots_u{};
    std::vector<double> knots_v{};
    PointGrid points{};
    NumberGrid weights{};
    NumberGrid trims{};
};

constexpr Range kFew{.min = 0.0, .max = 10.0};

template <auto... Steps>
constexpr auto of_friction = at<&FrictionTable::friction, Steps...>;
template <auto Member>
constexpr auto of_set = of_friction<&SceneFriction::set, Member>;
template <auto Member>
constexpr auto of_law = of_friction<&SceneFriction::own, Member>;

using engine::Friction;
using engine::LawSpec;
using engine::Slew;
using enum Need;

// clang-format off
constexpr Key kRenderer[]{
    {.name = "stiffness_n_per_m", .slot = at<&SceneRenderer::stiffness>, .range = kPositive,
     .meaning = "how hard the object is"},
    {.name = "damping_n_s_per_m", .slot = at<&SceneRenderer::damping>, .range = kFromZero,
     .meaning = "damper of the contact beside its spring"},
    {.name = "compliance_m_per_n", .slot = at<&SceneRenderer::compliance>, .range = {0, engine::kMaxCompliance},
     .meaning = "of two curves that yield, the first two of a closed outline of three segments without inner knots: how far their vertex gives way to a force that rests on it; 0: rigid"},
    {.name = "tracker", .slot = at<&SceneRenderer::tracker>,
     .meaning = "how the closest point is found; all but the first are the thesis' trackers"},
    {.name = "sub_steps", .slot = at<&SceneRenderer::sub_steps>, .range = {1, 1000},
     .meaning = "of a tracker with a gain: explicit Euler steps a tick"},
    {.name = "rate_hz", .slot = at<&SceneRenderer::rate_hz>, .range = kPositive,
     .meaning = "of tangent_plane: refreshes a second"},
    {.name = "iterations", .slot = at<&SceneRenderer::iterations>, .range = {1, 100},
     .meaning = "of newton: steps a tick"},
};
constexpr Key kGain[]{
    {.name = "gain", .slot = at<&SceneRenderer::gain>, .need = required, .range = kPositive,
     .meaning = "of feedback and feed_forward: 1/(m^2 s); of feedback_linearised: 1/s"},
};

constexpr Key kSceneFriction[]{
    {.name = "law", .slot = of_friction<&SceneFriction::law>,
     .meaning = "by which the contact force is computed: one of a protocol's [laws](#laws-of-friction), thesis_literal or thesis_latched"},
    {.name = "vertex_slew_m_per_s", .slot = of_friction<&SceneFriction::slew, &Slew::speed>, .range = {0, 1e6},
     .meaning = "how fast the contact may turn around a vertex; 0: at once"},
    {.name = "vertex_radius_m", .slot = of_friction<&SceneFriction::slew, &Slew::radius>, .range = {0, 1e3, true},
     .meaning = "radius that a vertex counts as for that speed"},
    {.name = "dead_band_m_per_s", .slot = of_friction<&SceneFriction::dead_band>, .range = {0, 1e3},
     .meaning = "the thesis' laws take slower closest points for resting"},
    {.name = "mu_s", .slot = of_set<&Friction::mu_s>, .need = by_law, .range = kFew,
     .meaning = "static coefficient, at least mu_d"},
    {.name = "mu_d", .slot = of_set<&Friction::mu_d>, .need = by_law, .range = kFew,
     .meaning = "dynamic coefficient"},
    {.name = "tau_slip_s", .slot = of_set<&Friction::tau_slip>, .need = by_law_optional, .range = kFew,
     .meaning = "time constant from mu_s to mu_d while slipping; 0: at once"},
    {.name = "tau_heal_s", .slot = of_set<&Friction::tau_heal>, .need = by_law_optional, .range = kFew,
     .meaning = "time constant back to mu_s while stuck; 0: at once"},
    {.name = "tangential_stiffness_n_per_m", .slot = of_law<&LawSpec::stiffness>, .need = by_law_optional, .range = kFromZero,
     .meaning = "of a law's own spring along the surface; 0: stiffness_n_per_m"},
    {.name = "viscous_n_s_per_m", .slot = of_law<&LawSpec::viscosity>, .need = by_law_optional, .range = kFromZero,
     .meaning = "of viscous and lugre: damper along the surface"},
    {.name = "bristle_damping_n_s_per_m", .slot = of_law<&LawSpec::bristle_damping>, .need = by_law_optional, .range = kFromZero,
     .meaning = "of lugre and reset_integrator: damper of the law's own spring"},
    {.name = "stribeck_speed_m_per_s", .slot = of_law<&LawSpec::stribeck_speed>, .need = by_law_optional, .range = kPositive,
     .meaning = "of stribeck and lugre: from mu_s at rest to mu_d well above this speed"},
    {.name = "smoothing_speed_m_per_s", .slot = of_law<&LawSpec::smoothing_speed>, .need = by_law_optional, .range = kPositive,
     .meaning = "of stribeck: over which friction turns with the motion"},
    {.name = "stick_speed_m_per_s", .slot = of_law<&LawSpec::stick_speed>, .need = by_law_optional, .range = kPositive,
     .meaning = "of karnopp: below it a hand counts as resting"},
    {.name = "dahl_exponent", .slot = of_law<&LawSpec::exponent>, .need = by_law_optional, .range = {0, 3},
     .meaning = "of dahl: alpha"},
    {.name = "stick_share", .slot = of_law<&LawSpec::stick_share>, .need = by_law_optional, .range = {0, 0.99},
     .meaning = "of hayward_armstrong: share of the friction below which nothing slips"},
    {.name = "bristles", .slot = of_law<&LawSpec::bristles>, .need = by_law_optional, .range = {1, engine::kMaxBristles},
     .meaning = "of bristle: number of bonds"},
    {.name = "snag_spacing_m", .slot = of_law<&LawSpec::snag_spacing>, .need = by_law_optional, .range = kPositive,
     .meaning = "of snags: one, at a random place, in each such length of the outline"},
    {.name = "law_seed", .slot = of_law<&LawSpec::seed>, .need = by_law_optional, .range = {0, kMaxSeed},
     .meaning = "of bristle and snags"},
};
constexpr Key kSurface[]{
    {.name = "degree_u", .slot = at<&SurfaceTable::degree_u>, .need = required, .range = {1, 1e6},
     .meaning = "of the polynomials along u"},
    {.name = "degree_v", .slot = at<&SurfaceTable::degree_v>, .need = required, .range = {1, 1e6},
     .meaning = "along v"},
    {.name = "knots_u", .slot = at<&SurfaceTable::knots_u>, .need = required,
     .meaning = "clamped, rising, of any spacing"},
    {.name = "knots_v", .slot = at<&SurfaceTable::knots_v>, .need = required,
     .meaning = "the same along v"},
    {.name = "points_m", .slot = at<&SurfaceTable::points>, .need = required, .range = {-kFarthest, kFarthest},
     .meaning = "control points, a row for each u"},
    {.name = "weights", .slot = at<&SurfaceTable::weights>,
     .meaning = "of the control points, above 0; left out: all 1"},
    {.name = "trim_loops", .slot = at<&SurfaceTable::trims>,
     .meaning = "[u, v, u, v, ...] of each loop's corners, along lines of constant u and v: counter-clockwise, what is kept; clockwise, a hole"},
};
// clang-format on

SceneRenderer read_renderer(TableReader table) {
    SceneRenderer r;
    table.read(kRenderer, &r);
    const bool gains =
        !r.certified() && r.tracker != Tracker::tangent_plane && r.tracker != Tracker::newton;
    if (gains) {
        table.read(kGain, &r);
    }
    const std::pair<std::string_view, bool> read_by_some[]{
        {"sub_steps", gains},
        {"rate_hz", r.tracker == Tracker::tangent_plane},
        {"iterations", r.tracker == Tracker::newton}};
    for (const auto& [key, reads] : read_by_some) {
        if (!reads && table.has(key)) {
            table.refuse(key, fmt::format("{} is given, and the tracker does not read it: delete "
                                          "it, or give another tracker",
                                          key));
        }
    }
    table.refuse_unknown();
    return r;
}

SceneFriction read_friction(TableReader table, const Places& places, Problems& problems) {
    FrictionTable f;
    table.read_last(kSceneFriction, &f);
    SceneFriction& friction = f.friction;
    const bool thesis = is_thesis_law(friction.law);
    const LawKeys* known = keys_of_law(thesis ? "gos" : friction.law);
    if (known == nullptr ||
        (thesis && std::ranges::find(kThesisLaws, friction.law) == kThesisLaws.end())) {
        table.refuse("law", wrong_law(friction.law, kThesisLaws));
        return friction;
    }
    LawKeys law = *known;
    law.law = friction.law;
    law.relaxes = law.relaxes && !thesis;
    constexpr std::string_view kDeadBand = "dead_band_m_per_s";
    if (!thesis && table.has(kDeadBand)) {
        table.refuse(kDeadBand, fmt::format("{} is given, but law is \"{}\", which does not read "
                                            "it: delete it, or give one of the thesis' laws",
                                            kDeadBand, friction.law));
    }
    if (!law.check(kSceneFriction, table.path(), places, problems)) {
        return friction;
    }
    if (!law.sticks) {
        friction.set.mu_s = friction.set.mu_d;
    } else if (friction.set.mu_s < friction.set.mu_d) {
        table.refuse("mu_s", fmt::format("mu_s is {}, below mu_d = {}: static friction is not "
                                         "smaller than dynamic friction",
                                         friction.set.mu_s, friction.set.mu_d));
    }
    friction.own.traits = law.own;
    if (law.own != nullptr) {
        table.attempt([&] { engine::FrictionLaw(friction.own, friction.set, 1.0, 1.0); });
    }
    return friction;
}

void read_segment(TableReader table, SceneFile& scene) {
    const SegmentTable segment = read_segment_table(table);
    table.attempt([&] {
        if (segment.points.dimension == 2) {
            scene.curves.push_back(curve_of(plane_segment(segment)));
        } else if (segment.kind == stimuli::Segment::Kind::nurbs) {
            scene.space_curves.emplace_back(segment.degree, segment.knots, segment.points.values,
                                            segment.weights);
        } else {
            const std::vector<double> knots{0, 0, 1, 1};
            scene.space_curves.emplace_back(1, knots, segment.points.values);
        }
    });
}

/// @throws std::invalid_argument for a loop with an odd count of numbers
std::vector<engine::TrimLoop> loops_of(const NumberGrid& trims) {
    std::vector<engine::TrimLoop> loops;
    for (const std::vector<double>& numbers : trims) {
        refuse_if(numbers.size() % 2 != 0,
                  "a loop of trim_loops has {} numbers: give u and v of each corner",
                  numbers.size());
        engine::TrimLoop& loop = loops.emplace_back();
        for (std::size_t i = 0; i < numbers.size(); i += 2) {
            loop.emplace_back(numbers[i], numbers[i + 1]);
        }
    }
    return loops;
}

void read_surface(TableReader table, SceneFile& scene) {
    SurfaceTable s;
    table.read_last(kSurface, &s);
    table.attempt([&] {
        auto whole = std::make_shared<const engine::NurbsSurface>(s.degree_u, s.degree_v, s.knots_u,
                                                                  s.knots_v, s.points, s.weights);
        const std::size_t number = scene.surface_of.empty() ? 0 : scene.surface_of.back() + 1;
        const auto pieces =
            s.trims.empty() ? std::vector{std::move(whole)} : trimmed(*whole, loops_of(s.trims));
        scene.surfaces.insert(scene.surfaces.end(), pieces.begin(), pieces.end());
        scene.surface_of.resize(scene.surfaces.size(), number);
    });
}

/// A scene whose curves yield can be compiled, or it is said why not.
void check_softness(const SceneFile& scene, Problems& problems) {
    const Position at = scene.places.of("renderer.compliance_m_per_n");
    if (scene.curves.empty()) {
        problems.add(at, "compliance_m_per_n is for plane curves: leave it out");
        return;
    }
    if (!scene.renderer.certified() || is_thesis_law(scene.friction.law)) {
        problems.add(at,
                     "compliance_m_per_n is given, and the thesis' trackers and laws are for rigid "
                     "curves: give tracker \"certified\" and law \"gos\", \"coulomb\" or "
                     "\"frictionless\"");
        return;
    }
    std::shared_ptr<const engine::Outline> outline;
    try {
        outline = std::make_shared<const engine::Outline>(outline_of(scene));
    } catch (const std::invalid_argument& error) {
        problems.add(scene.places.of(spoken_segment(error.what())), error.what());
        return;
    }
    try {
        constexpr double kAnyPeriod = 1e-3;  // s
        const engine::Scene built(outline, spec_of(scene, kAnyPeriod));
    } catch (const std::invalid_argument& error) {
        problems.add(at, error.what());
    }
}

/// The thesis' renderer is a spring with one of the thesis' laws, at once around every vertex.
void check_thesis(const SceneFile& scene, Problems& problems) {
    if (!scene.by_thesis() || !scene.surfaces.empty()) {
        return;
    }
    const std::pair<std::string_view, double> not_felt[]{
        {"renderer.damping_n_s_per_m", scene.renderer.damping},
        {"friction.vertex_slew_m_per_s", scene.friction.slew.speed}};
    for (const auto& [key, value] : not_felt) {
        if (value != 0.0) {
            problems.add(scene.places.of(std::string(key)),
                         fmt::format("{} is {}, and the thesis' laws and trackers do not know it: "
                                     "delete it, or give tracker \"certified\" and another law",
                                     key.substr(key.find('.') + 1), value));
        }
    }
}

/// What holds across tables.
void check_whole(const SceneFile& scene, Problems& problems) {
    const Position at{};
    const int kinds = static_cast<int>(!scene.curves.empty()) +
                      static_cast<int>(!scene.space_curves.empty()) +
                      static_cast<int>(!scene.surfaces.empty());
    if (kinds == 0) {
        problems.add(at, "there is nothing to feel: add [[segment]] tables, or [[surface]] tables");
    } else if (kinds > 1) {
        problems.add(
            at, "the scene mixes plane curves, curves in space and surfaces: keep one of them");
    }
    if (!scene.surfaces.empty()) {
        try {
            const engine::SurfaceObject joined(scene.surfaces);
        } catch (const std::invalid_argument& error) {
            problems.add(scene.places.of("surface.1"), error.what());
        }
    }
    if (!scene.surfaces.empty() &&
        (!scene.renderer.certified() || is_thesis_law(scene.friction.law) ||
         scene.friction.own.traits != nullptr)) {
        problems.add(
            at,
            "the thesis' trackers and the laws from the literature are for plane curves: on a "
            "[[surface]] give tracker "
            "\"certified\" and law \"gos\", \"coulomb\" or \"frictionless\"");
    }
    check_thesis(scene, problems);
    if (scene.renderer.compliance > 0.0) {
        check_softness(scene, problems);
    }
}

}  // namespace

SceneFile parse_scene(std::string_view text, std::string_view file_name, Crossings crossings) {
    const Table file = parse_document(text, file_name);
    Problems problems;
    SceneFile scene;
    Places& places = scene.places;
    TableReader top(file, "", {}, problems, places, "the scene");
    if (const auto table = top.table("renderer")) {
        scene.renderer = read_renderer(*table);
    }
    if (const auto table = top.table("friction")) {
        scene.friction = read_friction(*table, places, problems);
    }
    for (const TableReader& table : top.tables("segment")) {
        read_segment(table, scene);
    }
    for (const TableReader& table : top.tables("surface")) {
        read_surface(table, scene);
    }
    top.refuse_unknown();
    problems.throw_if_any(file_name);
    check_whole(scene, problems);
    if (!scene.curves.empty() && crossings == Crossings::refused) {
        check_ends_and_crossings(scene.curves, places, problems);
    }
    problems.throw_if_any(file_name);
    return scene;
}

std::vector<TableText> scene_reference() {
    return {{.heading = "[renderer]", .keys = kRenderer},
            {.heading = "[renderer] with a tracker that has a gain", .keys = kGain},
            {.heading = "[friction]", .keys = kSceneFriction},
            segment_reference("[[segment]]", "once each, or [[surface]] tables"),
            {.heading = "[[surface]]",
             .remark = "once each; borders that are the same curve are joined",
             .keys = kSurface}};
}

SceneFile load_scene(const std::filesystem::path& file) {
    return parse_scene(read_text(file, kMaxDocument), file.string());
}

engine::Outline outline_of(const SceneFile& scene) {
    return {scene.curves, closing_gap(scene.curves) <= kSameEnd};
}

ProtocolError not_felt(const SceneFile& scene, std::string_view name, std::string_view why) {
    const Position at = scene.places.of(spoken_segment(why));
    return ProtocolError(fmt::format("{}:{}:{}: {}", name, at.line, at.column, why));
}

engine::SceneSpec spec_of(const SceneFile& scene, double period) noexcept {
    return {.stiffness = scene.renderer.stiffness,
            .damping = scene.renderer.damping,
            .period = period,
            .friction = scene.friction.set,
            .slew = scene.friction.slew,
            .law = scene.friction.own,
            .compliance = scene.renderer.compliance};
}

}  // namespace palpate::protocols
