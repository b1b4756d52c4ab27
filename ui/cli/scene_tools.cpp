#include "ui/cli/scene_tools.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <stdexcept>

#include <fmt/compile.h>
#include <fmt/format.h>

#include "engine/base/whole_text.hpp"
#include "engine/surface/surface_scene.hpp"
#include "engine/thesis/thesis_scene.hpp"
#include "ui/cli/trajectory.hpp"

namespace palpate::ui {
namespace {

using engine::Vec;
using engine::Vec2;
using engine::Vec3;
using protocols::Law;
using protocols::SceneFile;

/// A mode as render writes it: whoever reads its tables knows them so.
std::string_view mode_text(engine::Mode mode) {
    constexpr std::array<std::string_view, 4> kWords{"FREE", "STUCK", "SLIP", "TRANSITION"};
    return kWords[static_cast<std::size_t>(mode)];
}

/// One line of CSV after another.
class Lines {
public:
    explicit Lines(std::string_view head) : text_(head) { text_ += '\n'; }

    void begin() { first_ = true; }
    void end() { text_ += '\n'; }
    void add(std::string_view word) {
        comma();
        text_ += word;
    }
    void add(double value) {
        comma();
        fmt::format_to(std::back_inserter(text_), FMT_COMPILE("{}"), value == 0.0 ? 0.0 : value);
    }
    void add(std::size_t value) {
        comma();
        fmt::format_to(std::back_inserter(text_), FMT_COMPILE("{}"), value);
    }
    template <int D>
    void add_point(const Vec<D>& p) {
        for (int k = 0; k < D; ++k) {
            add(p[k]);
        }
    }
    [[nodiscard]] const std::string& text() const noexcept { return text_; }
    void clear() { text_.clear(); }

private:
    void comma() {
        if (!first_) {
            text_ += ',';
        }
        first_ = false;
    }

    std::string text_;
    bool first_ = true;
};

constexpr std::string_view kPlaneHead =
    "t_s,mode,segment,u,cp_x_m,cp_y_m,go_x_m,go_y_m,fn_n,ft_n,fx_n,fy_n,held,slewed,unproven";
constexpr std::string_view kSpaceHead =
    "t_s,mode,segment,u,v,cp_x_m,cp_y_m,cp_z_m,go_x_m,go_y_m,go_z_m,fn_n,ft_n,fx_n,fy_n,fz_n,"
    "held,slewed,unproven";

/// Where the god-object stopped elsewhere than at the first place in its cone, and whether that is
/// proven.
struct Marks {
    bool held = false;      ///< by an open end, a border or a crease
    bool slewed = false;    ///< the budget of the vertex slew ended the walk
    bool unproven = false;  ///< the search was broken off
};

void add_marks(Lines& lines, const Marks& marks) {
    for (const bool mark : {marks.held, marks.slewed, marks.unproven}) {
        lines.add(std::size_t{mark});
    }
}

struct Spot {
    std::size_t segment = 0;
    double u = 0.0;
};

Spot spot_of(const engine::Outline& outline, const engine::Place& place) {
    const engine::SegmentPlace named = engine::segment_place(outline, place);
    return {named.segment, named.u};
}

/// What both kinds of scene answer.
struct PlaneTick {
    engine::Mode mode = engine::Mode::free;
    Spot spot{};
    Vec2 cp{};
    Vec2 go{};
    double fn = 0.0;
    double ft = 0.0;
    Vec2 force{};
    Marks marks{};
};

void add_row(Lines& lines, double t, const PlaneTick& tick) {
    lines.begin();
    lines.add(t);
    lines.add(mode_text(tick.mode));
    lines.add(tick.spot.segment);
    lines.add(tick.spot.u);
    lines.add_point<2>(tick.cp);
    lines.add_point<2>(tick.go);
    lines.add(tick.fn);
    lines.add(tick.ft);
    lines.add_point<2>(tick.force);
    add_marks(lines, tick.marks);
    lines.end();
}

/// Writes the row of a tick.
using Feel = std::function<void(Lines&, const Trajectory::Tick&)>;

Feel plane_feel(const SceneFile& file, double period) {
    const auto outline = std::make_shared<const engine::Outline>(protocols::outline_of(file));
    const auto scene = std::make_shared<engine::Scene>(outline, protocols::spec_of(file, period));
    return [outline, scene, state = engine::ContactState{}, track = engine::TrackState{}](
               Lines& lines, const Trajectory::Tick& tick) mutable {
        if (tick.period != scene->spec().period) {
            scene->set_period(tick.period);
        }
        const Vec2 hip{tick.hip.x, tick.hip.y};
        const engine::Contact felt = scene->tick(state, hip);
        const engine::ClosestPoint cp = scene->closest(track, hip);
        const engine::Contact c = shown(felt, cp);
        add_row(lines, tick.t,
                {c.mode,
                 spot_of(*outline, cp.place),
                 cp.point,
                 c.go,
                 c.normal_force,
                 c.tangential_force,
                 c.force,
                 {c.held(), c.vertex_slew, c.unproven}});
    };
}

Feel surface_feel(const SceneFile& file, double period) {
    const auto scene = std::make_shared<engine::SurfaceScene>(
        file.surfaces, engine::SurfaceSceneSpec{.contact = protocols::spec_of(file, period)});
    return [scene, surface_of = file.surface_of, state = engine::SurfaceState{}](
               Lines& lines, const Trajectory::Tick& tick) mutable {
        if (tick.period != scene->spec().contact.period) {
            scene->set_period(tick.period);
        }
        const engine::SurfaceContact c = scene->tick(state, tick.hip);
        lines.begin();
        lines.add(tick.t);
        lines.add(mode_text(c.mode));
        lines.add(surface_of[c.cp.place.surface]);
        lines.add(c.cp.u);
        lines.add(c.cp.v);
        lines.add_point<3>(c.cp.point);
        lines.add_point<3>(c.go);
        lines.add(c.normal_force);
        lines.add(c.tangential_force);
        lines.add_point<3>(c.force);
        add_marks(lines, {.held = c.outside_cone && !c.vertex_slew,
                          .slewed = c.vertex_slew,
                          .unproven = !c.settled || !c.cp.proven || !c.on_flow});
        lines.end();
    };
}

engine::ThesisSpec thesis_spec(const SceneFile& file, double period) {
    const Law law = file.friction.law;
    engine::ThesisSpec spec{.stiffness = file.renderer.stiffness,
                            .period = period,
                            .tracker = file.renderer.tracker,
                            .law = law == Law::thesis_literal ? engine::ThesisLaw::literal
                                 : law == Law::thesis_latched ? engine::ThesisLaw::latched
                                                              : engine::ThesisLaw::frictionless,
                            .mu_s = file.friction.set.mu_s,
                            .mu_d = file.friction.set.mu_d,
                            .dead_band = file.friction.dead_band};
    if (file.renderer.certified) {  // the nearest that the thesis' renderer knows
        spec.tracker = {.kind = engine::TrackerKind::newton, .iterations = 2};
    }
    return spec;
}

void check_even(const Trajectory& path) {
    for (Trajectory::Rows rows(path); rows.next();) {
        if (rows.tick().period != path.first_period()) {
            throw data::CsvError(
                fmt::format("{}:{}: a tick of {} s among ticks of {} s: the thesis' renderer needs "
                            "even ticks",
                            path.name(), rows.line(), rows.tick().period, path.first_period()));
        }
    }
}

Feel thesis_feel(const SceneFile& file, double period) {
    const bool closed = protocols::outline_of(file).closed();
    const auto scene =
        std::make_shared<const engine::ThesisScene>(file.curves, closed, thesis_spec(file, period));
    return
        [scene, state = engine::ThesisState{}](Lines& lines, const Trajectory::Tick& tick) mutable {
            const engine::ThesisTick t = scene->tick(state, {tick.hip.x, tick.hip.y});
            add_row(lines, tick.t,
                    {t.mode, {t.cp_segment, t.cp_u}, t.cp, t.go, t.fn, t.ft, t.force, {}});
        };
}

/// Whether the thesis' renderer is asked for: by its law, or by its tracker where the tracker
/// decides the force. With friction our law needs no tracker in contact; the column cp alone would
/// differ.
bool by_thesis(const SceneFile& file) {
    const Law law = file.friction.law;
    return law == Law::thesis_literal || law == Law::thesis_latched ||
           (!file.renderer.certified && law == Law::frictionless);
}

Feel feel_of(const SceneFile& scene, double period) {
    if (!scene.surfaces.empty()) {
        return surface_feel(scene, period);
    }
    if (scene.curves.empty()) {
        throw std::invalid_argument(
            "curves in space cannot be felt, only asked for the closest point: give plane curves "
            "or [[surface]] tables");
    }
    return by_thesis(scene) ? thesis_feel(scene, period) : plane_feel(scene, period);
}

/// So many bytes are written at once.
constexpr std::size_t kPiece = std::size_t{1} << 16U;

template <int D>
std::string closest_on_curves(const std::vector<engine::NurbsCurve<D>>& curves,
                              const data::NumberTable& points) {
    std::vector<engine::RationalBezier<D>> spans;
    std::vector<engine::SpanName> names;
    for (std::size_t i = 0; i < curves.size(); ++i) {
        for (auto& [curve, name] : engine::balanced_spans<D>(curves[i], i)) {
            spans.push_back(curve);
            names.push_back(name);
        }
    }
    const engine::PieceTree<D> tree(std::move(spans));
    Lines lines(D == 2 ? "segment,u,cp_x_m,cp_y_m,distance_m"
                       : "segment,u,cp_x_m,cp_y_m,cp_z_m,distance_m");
    for (std::size_t i = 0; i < points.rows(); ++i) {
        Vec<D> h{};
        for (int k = 0; k < D; ++k) {
            h[k] = points.at(i, static_cast<std::size_t>(k));
        }
        const engine::Foot<D> foot = tree.closest(h);
        lines.begin();
        lines.add(names[foot.span].segment);
        lines.add(names[foot.span].parameter(foot.u));
        lines.template add_point<D>(foot.point);
        lines.add(std::sqrt(foot.distance2));
        lines.end();
    }
    return lines.text();
}

std::string closest_on_surfaces(const SceneFile& scene, const data::NumberTable& points) {
    const engine::SurfaceFeet feet(std::make_shared<const engine::SurfaceObject>(scene.surfaces));
    Lines lines("segment,u,v,cp_x_m,cp_y_m,cp_z_m,distance_m");
    for (std::size_t i = 0; i < points.rows(); ++i) {
        const engine::SurfaceClosest cp =
            feet.closest({points.at(i, 0), points.at(i, 1), points.at(i, 2)});
        lines.begin();
        lines.add(scene.surface_of[cp.place.surface]);
        lines.add(cp.u);
        lines.add(cp.v);
        lines.add_point<3>(cp.point);
        lines.add(cp.distance);
        lines.end();
    }
    return lines.text();
}

}  // namespace

void render_csv(const SceneFile& scene,
                const std::string& scene_name,
                const std::filesystem::path& path,
                const std::filesystem::path& output) {
    const Trajectory trajectory(path, scene.dimension());
    const bool space = !scene.surfaces.empty();
    if (!space && by_thesis(scene)) {
        check_even(trajectory);
    }
    Feel feel;
    try {
        feel = feel_of(scene, trajectory.first_period());
    } catch (const std::invalid_argument& e) {  // the curves do not make an object
        throw protocols::ProtocolError(fmt::format("{}:1:1: {}", scene_name, e.what()));
    }
    const std::string_view head = space ? kSpaceHead : kPlaneHead;
    WholeText whole(output, fmt::format("{}\n", head));
    Lines lines(head);
    for (Trajectory::Rows rows(trajectory); rows.next();) {
        feel(lines, rows.tick());
        if (lines.text().size() > kPiece) {
            whole.add(lines.text());
            lines.clear();
        }
    }
    whole.add(lines.text());
    whole.finish();
}

std::string closest_csv(const SceneFile& scene, const data::NumberTable& points) {
    if (!scene.surfaces.empty()) {
        return closest_on_surfaces(scene, points);
    }
    return scene.curves.empty() ? closest_on_curves<3>(scene.space_curves, points)
                                : closest_on_curves<2>(scene.curves, points);
}

}  // namespace palpate::ui
