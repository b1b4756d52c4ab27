#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "engine/geometry/outline.hpp"
#include "engine/realtime/felt_scene.hpp"
#include "stimuli/free_outline.hpp"
#include "stimuli/surface_patch.hpp"
#include "protocols/session/exploration_meter.hpp"
#include "data/page/sections.hpp"

namespace palpate::data {
namespace {

using engine::Mode;
using engine::TickRecord;
using engine::Vec2;
using engine::Vec3;

/// A path is drawn as near to the hand's as this, m: a sixth of a pixel.
constexpr double kNear = 5e-5;
constexpr double kMilli = 1e3;

/// Those of the points that a line through them needs to pass all others within kNear (Douglas &
/// Peucker 1973).
std::vector<Vec2> thinned(const std::vector<Vec2>& points) {
    if (points.size() < 3) {
        return points;
    }
    std::vector<bool> kept(points.size(), false);
    kept.front() = kept.back() = true;
    std::vector<std::array<std::size_t, 2>> open{{0, points.size() - 1}};
    while (!open.empty()) {
        const auto [from, to] = open.back();
        open.pop_back();
        const Vec2 way = points[to] - points[from];
        const double length2 = glm::dot(way, way);
        double max = kNear * kNear;
        std::size_t at = from;
        for (std::size_t i = from + 1; i < to; ++i) {
            const Vec2 off = points[i] - points[from];
            const double along =
                length2 > 0.0 ? std::clamp(glm::dot(off, way) / length2, 0.0, 1.0) : 0.0;
            const Vec2 rest = off - along * way;
            if (glm::dot(rest, rest) > max) {
                max = glm::dot(rest, rest);
                at = i;
            }
        }
        if (at != from) {
            kept[at] = true;
            open.push_back({from, at});
            open.push_back({at, to});
        }
    }
    std::vector<Vec2> out;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (kept[i]) {
            out.push_back(points[i]);
        }
    }
    return out;
}

/// From the side that a panel shows: from above x and y, from the front x and z.
struct View {
    bool front = false;
    [[nodiscard]] Vec2 of(const Vec3& point) const { return {point.x, front ? point.z : point.y}; }
};

void add_points(Series& series, const std::vector<Vec2>& points) {
    for (const Vec2& point : points) {
        series.add(kMilli * point.x, kMilli * point.y);
    }
}

/// A path with a gap wherever `place` has no point.
template <class Place>
void add_path_of(Series& series, std::span<const TickRecord> ticks, const Place& place) {
    std::vector<Vec2> run;
    const auto finish = [&] {
        add_points(series, thinned(run));
        if (!run.empty()) {
            series.gap();
        }
        run.clear();
    };
    for (const TickRecord& tick : ticks) {
        const std::optional<Vec2> point = place(tick);
        if (point && std::isfinite(point->x) && std::isfinite(point->y)) {
            run.push_back(*point);
        } else {
            finish();
        }
    }
    finish();
}

/// Where the first segment ends.
std::optional<Vec2> vertex_of(const TrialTrace& trace) {
    if (trace.scene->plane() == nullptr) {
        return std::nullopt;
    }
    const auto& seams = trace.scene->plane()->outline().seams();
    const auto vertex = std::ranges::find(seams, true, &engine::Seam::is_vertex);
    return vertex == seams.end() ? std::nullopt : std::optional(vertex->point);
}

Panel path_panel(const TrialTrace& trace, const View& view) {
    const bool space = trace.scene->plane() == nullptr;
    Panel panel{.title = !space     ? ""
                       : view.front ? "from the front"
                                    : "from above",
                .x = {.label = "to the right", .unit = "mm"},
                .y = {.label = view.front ? "up" : "away", .unit = "mm"},
                .equal_aspect = true,
                .height = view.front ? 150.0 : 330.0};
    if (!view.front) {
        Series outline{.name = "object", .ink = Ink::black, .width = 1.2};
        add_points(outline, border_of(trace));
        outline.add(outline.x.front(), outline.y.front());
        panel.series.push_back(std::move(outline));
    }
    const auto ticks = trace.felt_ticks();
    Series go{.name = space ? "god-object in contact" : "god-object: what was covered",
              .ink = Ink::green,
              .width = space ? 2.5 : 6.0};
    add_path_of(go, ticks, [&](const TickRecord& tick) {
        return tick.mode == Mode::free ? std::nullopt : std::optional(view.of(tick.go));
    });
    Series hip{.name = "hand (HIP)", .ink = Ink::blue, .width = 0.8};
    add_path_of(hip, ticks,
                [&](const TickRecord& tick) { return std::optional(view.of(tick.hip)); });
    Series sticks{.name = "stick events", .ink = Ink::vermillion, .mark = Mark::points};
    for (const TickRecord& tick : stick_events(trace)) {
        add_points(sticks, {view.of(tick.go)});
    }
    sticks.sizes.assign(sticks.x.size(), 2.6);
    panel.series.push_back(std::move(go));
    panel.series.push_back(std::move(hip));
    panel.series.push_back(std::move(sticks));
    const auto mark = [&](const TickRecord& tick, const char* label) {
        const Vec2 at = view.of(tick.hip);
        panel.markers.push_back({.x = kMilli * at.x, .y = kMilli * at.y, .label = label});
    };
    mark(ticks.front(), "1");
    mark(ticks.back(), "2");
    if (const auto vertex = vertex_of(trace)) {
        panel.markers.push_back({.x = kMilli * vertex->x, .y = kMilli * vertex->y, .label = "V"});
    }
    return panel;
}

/// Of a patch the cells that the god-object was in.
Panel cells_panel(const TrialTrace& trace) {
    protocols::PatchCover cover;
    for (const TickRecord& tick : trace.felt_ticks()) {
        if (tick.mode != Mode::free) {
            cover.add(tick);
        }
    }
    constexpr auto kSide = static_cast<double>(protocols::PatchCover::kSide);
    Panel panel{.title = fmt::format("covered: {:.0f} % of the patch", 100.0 * cover.share()),
                .x = {.label = "cell to the right", .low = 0.0, .high = kSide},
                .y = {.label = "cell away", .low = 0.0, .high = kSide},
                .equal_aspect = true,
                .height = 200.0};
    Series dots{.ink = Ink::green, .mark = Mark::points};
    for (std::size_t i = 0; i < protocols::PatchCover::kSide; ++i) {
        for (std::size_t j = 0; j < protocols::PatchCover::kSide; ++j) {
            if (cover.visited(i, j)) {
                dots.add(static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5);
            }
        }
    }
    dots.sizes.assign(dots.x.size(), 6.5);
    panel.series.push_back(std::move(dots));
    return panel;
}

}  // namespace

std::vector<Vec2> border_of(const TrialTrace& trace) {
    return trace.scene->plane() != nullptr ? stimuli::silhouette(trace.scene->plane()->outline())
                                           : stimuli::border_of(trace.scene->space()->surface());
}

std::string TrialTrace::rows() const {
    return fmt::format("trial_id = {} AND interval = {}{}", trial, interval,
                       felt ? fmt::format(" AND tick < {}", *felt) : std::string());
}

std::span<const TickRecord> TrialTrace::felt_ticks() const {
    const auto end = std::ranges::find_if(
        ticks, [this](const TickRecord& tick) { return felt && tick.tick >= *felt; });
    return {ticks.begin(), end};
}

std::optional<double> TrialTrace::done_s() const {
    const auto all = felt_ticks();
    return felt && !all.empty() ? std::optional(1e-9 * static_cast<double>(all.back().time_ns))
                                : std::nullopt;
}

std::vector<TickRecord> stick_events(const TrialTrace& trace) {
    std::vector<TickRecord> events;
    Mode before = Mode::free;
    for (const TickRecord& tick : trace.felt_ticks()) {
        if (tick.mode == Mode::stuck && before != Mode::stuck && before != Mode::free) {
            events.push_back(tick);
        }
        before = tick.mode;
    }
    return events;
}

bool has_friction(const TrialTrace& trace) {
    return std::ranges::any_of(trace.felt_ticks(),
                               [](const TickRecord& tick) { return tick.mu > 0.0; });
}

void add_path(PageWriter& page, const Study& study, const TrialTrace& trace) {
    PageFigure figure{.id = "path" + trace.place,
                      .title = "Where hand and god-object went" + trace.title,
                      .width = 480.0};
    figure.data = study.ask(fmt::format(
        "SELECT CASE WHEN mode = 'free' THEN 'none' WHEN segment < 0 THEN 'vertex ' || (-1 - "
        "segment) ELSE '{0} ' || segment END AS touched,\n       count(*) AS ticks, count(*) / "
        "(SELECT rate_hz FROM session JOIN trial USING (session_id) WHERE trial_id = {1}) AS "
        "time_s,\n       sum(mode = 'stuck') AS stuck_ticks, sum(mode IN ('slip', 'transition')) "
        "AS sliding_ticks,\n       iif(max(mu) > 0, sum(sticks), NULL) AS stick_events, "
        "avg(iif(mode = 'free', NULL, "
        "rendered_normal_n)) AS normal_force_n\nFROM (SELECT *, mode = 'stuck' AND lag(mode) OVER "
        "(ORDER BY tick) IN ('slip', 'transition') AS sticks\n      FROM sample WHERE {2})\nGROUP "
        "BY touched ORDER BY touched",
        trace.scene->plane() != nullptr ? "segment" : "surface", trace.trial, trace.rows()));
    figure.panels.push_back(path_panel(trace, {}));
    std::string where = "V is the vertex; how long the god-object was on it stands in the table.";
    if (trace.scene->plane() == nullptr) {
        figure.panels.push_back(path_panel(trace, {.front = true}));
        figure.panels.push_back(cells_panel(trace));
        where = "Cells of the patch that the god-object was in are filled.";
    } else if (trace.scene->plane()->soft() != nullptr) {
        where += " The object yields: it is drawn at rest.";
    }
    figure.caption = fmt::format(
        "From 1, the first tick, to 2, {}. The thick line is where the god-object was in contact, "
        "and so what was covered; {}. {}",
        !trace.felt                 ? "the last one before it was cut off"
        : trace.fault_cause.empty() ? "done"
                                    : "when the force went off",
        has_friction(trace)
            ? counted(stick_events(trace).size(), "dot is a stick event", "dots are stick events") +
                  " (a sliding god-object stuck again)"
            : std::string("without friction nothing sticks"),
        where);
    page.figure(figure);
    const Rows events = study.ask(fmt::format(
        "SELECT tick, time_s, segment, go_x_m, go_y_m{}, rendered_normal_n, mu\nFROM (SELECT *, "
        "lag(mode) OVER (ORDER BY tick) AS mode_before FROM sample WHERE {})\nWHERE mode = 'stuck' "
        "AND mode_before IN ('slip', 'transition') ORDER BY tick",
        trace.scene->plane() != nullptr ? "" : ", go_z_m", trace.rows()));
    if (!events.cells.empty()) {
        page.table("sticks" + trace.place, "Stick events" + trace.title,
                   "When and where a sliding god-object stuck again.", events);
    }
}

}  // namespace palpate::data
