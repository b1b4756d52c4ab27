#include "ui/cli/scene_tools.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/compile.h>
#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/surface/surface_scene.hpp"
#include "ui/cli/trajectory.hpp"
#include "ui/command/command.hpp"

namespace palpate::ui {
namespace {

using engine::Vec;
using engine::Vec2;
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
    template <class Number>
    requires std::is_arithmetic_v<Number>
    void add(Number value) {  // -0 is 0
        comma();
        fmt::format_to(std::back_inserter(text_), FMT_COMPILE("{}"),
                       value == Number{} ? Number{} : value);
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

/// Segment and u are those of the closest point, on a vertex the end of the segment before it; the
/// god-object out of contact is that point.
constexpr std::string_view kPlaneHead =
    "t_s,mode,segment,u,cp_x_m,cp_y_m,go_x_m,go_y_m,fn_n,ft_n,fx_n,fy_n,held,slewed,unproven";
constexpr std::string_view kSpaceHead =
    "t_s,mode,segment,u,v,cp_x_m,cp_y_m,cp_z_m,go_x_m,go_y_m,go_z_m,fn_n,ft_n,fx_n,fy_n,fz_n,held,"
    "slewed,unproven";

void add_marks(Lines& lines, const PlaneTick::Marks& marks) {
    for (const bool mark : {marks.held, marks.slewed, marks.unproven}) {
        lines.add(std::size_t{mark});
    }
}

void add_row(Lines& lines, double t, const PlaneTick& tick) {
    lines.begin();
    lines.add(t);
    lines.add(mode_text(tick.mode));
    lines.add(tick.place.segment);
    lines.add(tick.place.u);
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

/// Our own renderer.
PlaneFeel plane_feel(const SceneFile& file, double period) {
    const auto outline = std::make_shared<const engine::Outline>(protocols::outline_of(file));
    const auto scene = std::make_shared<engine::Scene>(outline, protocols::spec_of(file, period));
    return [outline, scene, state = engine::ContactState{}, track = engine::TrackState{}](
               const Vec2& hip, double now) mutable -> PlaneTick {
        if (now != scene->spec().period) {
            scene->set_period(now);
        }
        const engine::Contact felt = scene->tick(state, hip);
        const engine::ClosestPoint cp = scene->closest(track, hip);
        const engine::Contact c = shown(felt, cp);
        return {.mode = c.mode,
                .place = engine::segment_place(*outline, cp.place),
                .cp = cp.point,
                .go = c.go,
                .fn = c.normal_force,
                .ft = c.tangential_force,
                .force = c.force,
                .marks = {c.held(), c.vertex_slew, c.unproven}};
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
        add_marks(lines, {.held = c.outside_cone && !c.vertex_slew && c.settled,
                          .slewed = c.vertex_slew,
                          .unproven = !c.settled || !c.cp.proven || !c.on_flow});
        lines.end();
    };
}

void check_even(const Trajectory& path) {
    for (Trajectory::Rows rows(path); rows.next();) {
        refuse_if<data::CsvError>(
            rows.tick().period != path.first_period(),
            "{}:{}: a tick of {} s among ticks of {} s: the thesis' renderer needs even ticks",
            path.name(), rows.line(), rows.tick().period, path.first_period());
    }
}

Feel feel_of(const SceneFile& scene, double period, MakePlaneFeel thesis) {
    if (!scene.surfaces.empty()) {
        return surface_feel(scene, period);
    }
    refuse_if(scene.curves.empty(),
              "curves in space cannot be felt, only asked for the closest point: give plane curves "
              "or [[surface]] tables");
    const MakePlaneFeel make = scene.by_thesis() ? thesis : plane_feel;
    return [feel = make(scene, period)](Lines& lines, const Trajectory::Tick& tick) {
        add_row(lines, tick.t, feel({tick.hip.x, tick.hip.y}, tick.period));
    };
}

template <int D>
Feel nearest_on_curves(const std::vector<engine::NurbsCurve<D>>& curves) {
    std::vector<engine::RationalBezier<D>> spans;
    std::vector<engine::SpanName> names;
    for (std::size_t i = 0; i < curves.size(); ++i) {
        for (auto& [curve, name] : engine::balanced_spans<D>(curves[i], i)) {
            spans.push_back(curve);
            names.push_back(name);
        }
    }
    return [tree = std::make_shared<const engine::PieceTree<D>>(std::move(spans)), names](
               Lines& lines, const Trajectory::Tick& tick) {
        Vec<D> h{};
        for (int k = 0; k < D; ++k) {
            h[k] = tick.hip[k];
        }
        const engine::Foot<D> foot = tree->closest(h);
        lines.begin();
        lines.add(names[foot.span].segment);
        lines.add(names[foot.span].parameter(foot.u));
        lines.template add_point<D>(foot.point);
        lines.add(std::sqrt(foot.distance2));
        lines.end();
    };
}

Feel nearest_on_surfaces(const SceneFile& scene) {
    return [feet = std::make_shared<const engine::SurfaceFeet>(
                std::make_shared<const engine::SurfaceObject>(scene.surfaces)),
            surface_of = scene.surface_of](Lines& lines, const Trajectory::Tick& tick) {
        const engine::SurfaceClosest cp = feet->closest(tick.hip);
        lines.begin();
        lines.add(surface_of[cp.place.surface]);
        lines.add(cp.u);
        lines.add(cp.v);
        lines.add_point<3>(cp.point);
        lines.add(cp.distance);
        lines.add(std::size_t{!cp.proven});
        lines.end();
    };
}

/// Row by row: paths may be longer than the memory.
void write_rows(const std::filesystem::path& output,
                std::string_view head,
                const Trajectory& path,
                const Feel& feel) {
    constexpr std::size_t kPiece = std::size_t{1} << 16U;  // bytes written at once
    WholeText whole(output, fmt::format("{}\n", head));
    Lines lines(head);
    for (Trajectory::Rows rows(path); rows.next();) {
        feel(lines, rows.tick());
        if (lines.text().size() > kPiece) {
            whole.add(lines.text());
            lines.clear();
        }
    }
    whole.add(lines.text());
    whole.finish();
}

/// A scene and a table of points.
struct SceneOptions {
    std::string scene;
    std::string points;
    std::string output;  ///< empty: standard output
};

void declare_scene(CommandWords& words, SceneOptions& options, const std::string& points) {
    words.add("SCENE", options.scene, "A scene file (TOML)").required();
    words.add(points, options.points, "A CSV file with a head").required();
    words.add("-o,--output", options.output, "Where to write; standard output without it");
}

int render(const SceneOptions& options, MakePlaneFeel thesis) {
    const SceneFile scene = protocols::load_scene(options.scene);
    const Trajectory path(options.points, scene.dimension(), true);
    const bool space = !scene.surfaces.empty();
    if (!space && scene.by_thesis()) {
        check_even(path);
    }
    Feel feel;
    try {
        feel = feel_of(scene, path.first_period(), thesis);
    } catch (const std::invalid_argument& e) {  // the curves do not make an object
        throw protocols::not_felt(scene, options.scene, e.what());
    }
    write_rows(options.output, space ? kSpaceHead : kPlaneHead, path, feel);
    return 0;
}

int closest(const SceneOptions& options) {
    const SceneFile scene = protocols::load_scene(options.scene);
    const Trajectory points(options.points, scene.dimension(), false);
    if (!scene.surfaces.empty()) {
        write_rows(options.output, "segment,u,v,cp_x_m,cp_y_m,cp_z_m,distance_m,unproven", points,
                   nearest_on_surfaces(scene));
    } else if (scene.curves.empty()) {
        write_rows(options.output, "segment,u,cp_x_m,cp_y_m,cp_z_m,distance_m", points,
                   nearest_on_curves<3>(scene.space_curves));
    } else {
        write_rows(options.output, "segment,u,cp_x_m,cp_y_m,distance_m", points,
                   nearest_on_curves<2>(scene.curves));
    }
    return 0;
}

}  // namespace

/// @param thesis  feels the scenes whose law or tracker is the thesis', at even ticks
Command render_command(MakePlaneFeel thesis) {
    const auto options = std::make_shared<SceneOptions>();
    return {"render", "Feel a trajectory (t_s,x_m,y_m[,z_m]): forces tick by tick",
            [options](CommandWords& words) { declare_scene(words, *options, "TRAJECTORY"); },
            [options, thesis] {
                return render(*options, thesis);
            }};
}

Command closest_command() {
    return make_command<SceneOptions>(
        "closest", "Global closest points of a scene (x_m,y_m[,z_m])",
        [](CommandWords& words, SceneOptions& options) { declare_scene(words, options, "POINTS"); },
        closest);
}

}  // namespace palpate::ui
