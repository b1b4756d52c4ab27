#include "ui/cli/scene_tools.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/compile.h>
#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/surface/surface_scene.hpp"
#include "data/csv/number_table.hpp"
#include "ui/command/command.hpp"

namespace palpate::ui {
namespace {

using engine::Vec;
using engine::Vec2;
using protocols::SceneFile;

constexpr std::array<std::string_view, 4> kColumns{"t_s", "x_m", "y_m", "z_m"};

/// Tick periods that differ by less than this share are the same.
constexpr double kSamePeriod = 1e-6;
constexpr double kShortestPeriod = 1e-12;  ///< s: a speed over less may be no number
constexpr double kLongestPeriod = 3600.0;  ///< s
/// Tick period of a path of a single row, s.
constexpr double kUsualPeriod = 0.001;

std::span<const std::string_view> columns_of(int dimension, bool timed) {
    const std::size_t first = timed ? 0 : 1;
    return std::span(kColumns).subspan(first, static_cast<std::size_t>(dimension) + 1 - first);
}

/// A table of points: a path of a hand, or points at no time, checked as a whole when it is made and
/// then read again row by row: it may be longer than the memory.
class Trajectory {
public:
    /// @param timed  false: there is no column t_s; ticks have no time
    /// @throws data::CsvError for what is no table of finite numbers, a place out of reach, a time
    ///         that does not grow or a tick above an hour: file:line, the value and a remedy
    Trajectory(const std::filesystem::path& file, int dimension, bool timed);

    struct Tick {
        double t = 0.0;       ///< s
        double period = 0.0;  ///< s: since the tick before; of the first, that of the second
        engine::Vec3 hip{};   ///< m; z is 0 in the plane
    };

    /// One after the other.
    class Rows {
    public:
        explicit Rows(const Trajectory& path);
        /// @return false at the end @throws data::CsvError as Trajectory, if the file was changed
        /// meanwhile
        [[nodiscard]] bool next();
        [[nodiscard]] const Tick& tick() const noexcept { return tick_; }
        [[nodiscard]] std::size_t line() const { return rows_.line(); }  ///< in the file, from 1

    private:
        const Trajectory& path_;
        data::NumberRows rows_;
        std::size_t read_ = 0;
        Tick tick_{};
    };

    /// Of the first tick, s; of an empty path, or one of a single tick, 1 ms.
    [[nodiscard]] double first_period() const noexcept { return first_; }
    [[nodiscard]] const std::string& name() const noexcept { return text_.name(); }

private:
    /// Periods near the mean are the mean: t_s in decimals is rounded.
    [[nodiscard]] double evened(double period) const noexcept;

    data::RereadableText text_;
    int dimension_;
    bool timed_;
    double mean_ = 0.0;   ///< period, s; 0: not known yet
    double first_ = 0.0;  ///< period, s
};

Trajectory::Trajectory(const std::filesystem::path& file, int dimension, bool timed)
    : text_(file), dimension_(dimension), timed_(timed), first_(kUsualPeriod) {
    Rows rows(*this);
    std::size_t count = 0;
    double begin = 0.0;
    double second = 0.0;
    for (; rows.next(); ++count) {
        begin = count == 0 ? rows.tick().t : begin;
        second = count == 1 ? rows.tick().t : second;
    }
    if (timed && count > 1) {
        mean_ = (rows.tick().t - begin) / static_cast<double>(count - 1);
        first_ = evened(second - begin);
    }
}

double Trajectory::evened(double period) const noexcept {
    return std::fabs(period - mean_) <= kSamePeriod * mean_ ? mean_ : period;
}

Trajectory::Rows::Rows(const Trajectory& path)
    : path_(path), rows_(path.text_, columns_of(path.dimension_, path.timed_)) {}

bool Trajectory::Rows::next() {
    if (!rows_.next()) {
        return false;
    }
    const std::string& file = path_.name();
    const double before = tick_.t;
    tick_ = {.t = path_.timed_ ? rows_.at(0) : 0.0, .period = path_.first_};
    for (int k = 0; k < path_.dimension_; ++k) {
        const auto column = static_cast<std::size_t>(k);
        tick_.hip[k] = rows_.at(column + (path_.timed_ ? 1 : 0));
        refuse_if<data::CsvError>(std::fabs(tick_.hip[k]) > protocols::kFarthest,
                                  "{}:{}: {} is {}: give metres from {} to {}", file, rows_.line(),
                                  kColumns.at(column + 1), tick_.hip[k], -protocols::kFarthest,
                                  protocols::kFarthest);
    }
    if (!path_.timed_ || read_++ == 0) {
        return true;
    }
    const double period = tick_.t - before;
    refuse_if<data::CsvError>(!(period > 0.0),
                              "{}:{}: t_s is {} after {}: time has to grow from row to row", file,
                              rows_.line(), tick_.t, before);
    refuse_if<data::CsvError>(period < kShortestPeriod || period > kLongestPeriod,
                              "{}:{}: t_s is {} after {}: give ticks of {} to {} s", file,
                              rows_.line(), tick_.t, before, kShortestPeriod, kLongestPeriod);
    tick_.period = path_.evened(period);
    return true;
}

/// A mode as render writes it: whoever reads its tables knows them so.
std::string_view mode_text(engine::Mode mode) {
    constexpr std::array<std::string_view, 4> kWords{"FREE", "STUCK", "SLIP", "TRANSITION"};
    return kWords[static_cast<std::size_t>(mode)];
}

/// A value of a row of CSV and its comma: of a point one coordinate after the other; -0 is 0.
template <class Value>
void add(std::string& text, const Value& value) {
    if constexpr (std::is_same_v<Value, bool>) {
        text += value ? "1," : "0,";
    } else if constexpr (std::is_arithmetic_v<Value>) {
        fmt::format_to(std::back_inserter(text), FMT_COMPILE("{},"),
                       value == Value{} ? Value{} : value);
    } else if constexpr (std::is_same_v<Value, std::string_view>) {
        text += value;
        text += ',';
    } else {
        for (int k = 0; k < Value::length(); ++k) {
            add(text, value[k]);
        }
    }
}

template <class... Values>
void add_row(std::string& text, const Values&... values) {
    (add(text, values), ...);
    text.back() = '\n';
}

/// Segment and u are those of the closest point, on a vertex the end of the segment before it; the
/// god-object out of contact is that point.
constexpr std::string_view kPlaneHead =
    "t_s,mode,segment,u,cp_x_m,cp_y_m,go_x_m,go_y_m,fn_n,ft_n,fx_n,fy_n,held,slewed,unproven";
constexpr std::string_view kSpaceHead =
    "t_s,mode,segment,u,v,cp_x_m,cp_y_m,cp_z_m,go_x_m,go_y_m,go_z_m,fn_n,ft_n,fx_n,fy_n,fz_n,held,"
    "slewed,unproven";

/// Writes the row of a tick.
using Feel = std::function<void(std::string&, const Trajectory::Tick&)>;

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
               std::string& text, const Trajectory::Tick& tick) mutable {
        if (tick.period != scene->spec().contact.period) {
            scene->set_period(tick.period);
        }
        const engine::SurfaceContact c = scene->tick(state, tick.hip);
        add_row(text, tick.t, mode_text(c.mode), surface_of[c.cp.place.surface], c.cp.u, c.cp.v,
                c.cp.point, c.go, c.normal_force, c.tangential_force, c.force,
                c.outside_cone && !c.vertex_slew && c.settled, c.vertex_slew,
                !c.settled || !c.cp.proven || !c.on_flow);
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
    return [feel = make(scene, period)](std::string& text, const Trajectory::Tick& tick) {
        const PlaneTick c = feel({tick.hip.x, tick.hip.y}, tick.period);
        add_row(text, tick.t, mode_text(c.mode), c.place.segment, c.place.u, c.cp, c.go, c.fn, c.ft,
                c.force, c.marks.held, c.marks.slewed, c.marks.unproven);
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
               std::string& text, const Trajectory::Tick& tick) {
        Vec<D> h{};
        for (int k = 0; k < D; ++k) {
            h[k] = tick.hip[k];
        }
        const engine::Foot<D> foot = tree->closest(h);
        add_row(text, names[foot.span].segment, names[foot.span].parameter(foot.u), foot.point,
                std::sqrt(foot.distance2));
    };
}

Feel nearest_on_surfaces(const SceneFile& scene) {
    return [feet = std::make_shared<const engine::SurfaceFeet>(
                std::make_shared<const engine::SurfaceObject>(scene.surfaces)),
            surface_of = scene.surface_of](std::string& text, const Trajectory::Tick& tick) {
        const engine::SurfaceClosest cp = feet->closest(tick.hip);
        add_row(text, surface_of[cp.place.surface], cp.u, cp.v, cp.point, cp.distance, !cp.proven);
    };
}

/// Row by row: paths may be longer than the memory.
void write_rows(const std::filesystem::path& output,
                std::string_view head,
                const Trajectory& path,
                const Feel& feel) {
    constexpr std::size_t kPiece = std::size_t{1} << 16U;  // bytes written at once
    std::string text = fmt::format("{}\n", head);
    WholeText whole(output, text);
    for (Trajectory::Rows rows(path); rows.next();) {
        feel(text, rows.tick());
        if (text.size() > kPiece) {
            whole.add(text);
            text.clear();
        }
    }
    whole.add(text);
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
