#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/realtime/felt_scene.hpp"
#include "data/csv/json_text.hpp"
#include "data/page/html.hpp"
#include "data/page/sections.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();
/// Over which a speed is taken: as presentation.speed_p50_m_per_s.
constexpr std::int64_t kWindow = 20'000'000;  // ns

/// One line of a strip.
struct Line {
    std::string name{};   ///< as `sample` calls it, if it has it
    std::string label{};  ///< for people
    std::string unit{};   ///< as shown
    double step = 1.0;    ///< of the stored whole numbers, in SI (lateness in us)
    double shown = 1.0;   ///< factor from SI to what is shown
    Ink ink = Ink::blue;
    Stroke stroke = Stroke::solid;
    std::vector<double> values{};  ///< NaN: none
};

struct Strip {
    std::string title{};
    double height = 130.0;             ///< px
    std::vector<std::string> names{};  ///< of the values 0, 1, ..: it is a strip of words
    std::vector<Line> lines{};
};

template <class Value>
std::vector<double> of_each(std::span<const TickRecord> ticks, const Value& value) {
    std::vector<double> all;
    all.reserve(ticks.size());
    for (const TickRecord& tick : ticks) {
        all.push_back(value(tick));
    }
    return all;
}

/// Way by time since the latest tick that is kWindow or longer ago, m/s.
std::vector<double> speeds(std::span<const TickRecord> ticks) {
    std::vector<double> all;
    std::size_t from = 0;
    for (const TickRecord& tick : ticks) {
        while (tick.time_ns - ticks[from + 1 < ticks.size() ? from + 1 : from].time_ns >= kWindow) {
            ++from;
        }
        const std::int64_t time = tick.time_ns - ticks[from].time_ns;
        all.push_back(time < kWindow ? kNoValue
                                     : glm::length(tick.hip - ticks[from].hip) /
                                           (1e-9 * static_cast<double>(time)));
    }
    return all;
}

std::vector<Strip> strips_of(const TrialTrace& trace) {
    const auto& ticks = trace.ticks;
    const auto micro = [&](const char* name, const char* label, Ink ink, Stroke stroke,
                           double (*value)(const TickRecord&)) {
        return Line{name, label, "mm", 1e-6, 1e3, ink, stroke, of_each(ticks, value)};
    };
    Strip place{.title = "Hand (HIP)", .height = 170.0};
    place.lines = {micro("hip_x_m", "to the right", Ink::blue, Stroke::solid,
                         [](const TickRecord& tick) { return tick.hip.x; }),
                   micro("hip_y_m", "away", Ink::vermillion, Stroke::dashed,
                         [](const TickRecord& tick) { return tick.hip.y; })};
    if (trace.scene->space() != nullptr) {
        place.lines.push_back(micro("hip_z_m", "up", Ink::green, Stroke::dotted,
                                    [](const TickRecord& tick) { return tick.hip.z; }));
    }
    Strip force{.title = "Rendered force", .height = 150.0};
    force.lines = {
        {"rendered_normal_n", "normal", "N", 1e-3, 1.0, Ink::blue, Stroke::solid,
         of_each(ticks, [](const TickRecord& tick) { return tick.normal_force; })},
        {"rendered_tangential_n", "friction", "N", 1e-3, 1.0, Ink::vermillion, Stroke::dashed,
         of_each(ticks, [](const TickRecord& tick) { return tick.tangential_force; })}};
    Strip speed{.title = "Speed of the hand, over 20 ms"};
    speed.lines = {
        {"speed_m_per_s", "speed", "mm/s", 1e-4, 1e3, Ink::blue, Stroke::solid, speeds(ticks)}};
    Strip mode{.title = "Mode of the contact", .height = 110.0};
    for (const auto one :
         {engine::Mode::free, engine::Mode::stuck, engine::Mode::slip, engine::Mode::transition}) {
        mode.names.emplace_back(to_string(one));
    }
    mode.lines = {{"mode", "mode", "", 1.0, 1.0, Ink::blue, Stroke::solid,
                   of_each(ticks, [](const TickRecord& tick) {
                       return static_cast<double>(static_cast<int>(tick.mode));
                   })}};
    Strip late{.title = "Wake-up after the deadline", .height = 100.0};
    late.lines = {{"lateness_us", "lateness", "us", 0.1, 1.0, Ink::blue, Stroke::solid,
                   of_each(ticks, [](const TickRecord& tick) {
                       return static_cast<double>(tick.lateness_us);
                   })}};
    return {place, force, speed, mode, late};
}

std::string ticks_text(const std::vector<double>& values, double step) {
    std::vector<std::int64_t> steps;
    steps.reserve(values.size());
    for (const double value : values) {
        constexpr double kMax = 1e12;  // further out nothing is drawn
        const double n = std::round(value / step);
        steps.push_back(std::isfinite(n) && std::fabs(n) < kMax ? static_cast<std::int64_t>(n)
                                                                : kNoNumber);
    }
    return tick_text(steps);
}

/// Of each tick god-object and rendered force, as seen from above: played on the border.
std::vector<Line> played_lines(const TrialTrace& trace) {
    const auto of = [&](const char* name, double step, double shown, auto value) {
        return Line{
            .name = name, .step = step, .shown = shown, .values = of_each(trace.ticks, value)};
    };
    return {of("go_x_m", 1e-6, 1e3,
               [](const TickRecord& tick) {
                   return tick.mode == engine::Mode::free ? kNoValue : tick.go.x;
               }),
            of("go_y_m", 1e-6, 1e3,
               [](const TickRecord& tick) {
                   return tick.mode == engine::Mode::free ? kNoValue : tick.go.y;
               }),
            of("rendered_x_n", 1e-3, 1.0, [](const TickRecord& tick) { return tick.force.x; }),
            of("rendered_y_n", 1e-3, 1.0, [](const TickRecord& tick) { return tick.force.y; })};
}

std::string_view colour_name(Ink ink) {
    return ink == Ink::blue ? "blue" : ink == Ink::vermillion ? "vermillion" : "green";
}

int dash_of(Stroke stroke) {
    return stroke == Stroke::solid ? 0 : stroke == Stroke::dashed ? 6 : 2;
}

Json json_of(const Line& line) {
    return {{"name", line.name},
            {"label", line.label},
            {"unit", line.unit},
            {"step", line.step},
            {"shown", line.shown},
            {"ink", colour_name(line.ink)},
            {"dash", dash_of(line.stroke)},
            {"text", ticks_text(line.values, line.step)}};
}

Json json_of(const std::vector<Line>& lines) {
    Json all = Json::array();
    for (const Line& line : lines) {
        all.push_back(json_of(line));
    }
    return all;
}

/// What trial_script.js draws.
std::string json_of(const TrialTrace& trace,
                    const std::vector<Strip>& strips,
                    const std::vector<double>& times) {
    Json all{{"ticks", times.size()},
             {"time", {{"step", 1e-6}, {"text", ticks_text(times, 1e-6)}}},
             {"strips", Json::array()},
             {"marks", Json::array()},
             {"sticks", Json::array()},
             {"border", Json::array()},
             {"played", json_of(played_lines(trace))}};
    for (const Strip& strip : strips) {
        all["strips"].push_back({{"title", strip.title},
                                 {"height", strip.height},
                                 {"names", strip.names},
                                 {"lines", json_of(strip.lines)}});
    }
    if (const auto done = trace.done_s()) {
        all["marks"].push_back(
            {{"at", *done},
             {"fault", !trace.fault_cause.empty()},
             {"text", trace.fault_cause.empty() ? "done" : "force off: " + trace.fault_cause}});
    }
    for (const TickRecord& stick : stick_events(trace)) {
        all["sticks"].push_back(1e-9 * static_cast<double>(stick.time_ns));
    }
    for (const engine::Vec2& point : border_of(trace)) {
        const engine::Vec2 shown = glm::round(1e5 * point) / 100.0;  // mm
        all["border"].push_back({shown.x, shown.y});
    }
    return replaced(all.dump(), "<", "\\u003c");  // nothing may end the element
}

/// A line with the least and the largest value of each of kBins stretches of ticks.
Series least_and_largest(const Line& line, const std::vector<double>& times) {
    constexpr std::size_t kBins = 400;
    Series out{.name = line.label, .ink = line.ink, .stroke = line.stroke, .width = 1.0};
    const auto put = [&](std::size_t i) {
        out.add(times[i], line.shown * line.values[i]);
    };
    const std::size_t size = times.size();
    const std::size_t bins = std::min(kBins, size);
    for (std::size_t bin = 0; bin < bins; ++bin) {
        const std::size_t from = bin * size / bins;
        const std::size_t to = (bin + 1) * size / bins;
        std::size_t low = from;
        std::size_t high = from;
        for (std::size_t i = from; i < to; ++i) {
            const double value = line.values[i];
            low = !(line.values[low] <= value) && std::isfinite(value) ? i : low;
            high = !(line.values[high] >= value) && std::isfinite(value) ? i : high;
        }
        put(std::min(low, high));
        if (low != high) {
            put(std::max(low, high));
        }
    }
    return out;
}

Panel still_panel(const TrialTrace& trace, const Strip& strip, const std::vector<double>& times) {
    Panel panel{.title = strip.title,
                .x = {.label = "time", .unit = "s", .low = times.front(), .high = times.back()},
                .y = {.label = strip.lines.size() > 1 ? "" : strip.lines.front().label,
                      .unit = strip.lines.front().unit},
                .height = 0.8 * strip.height};
    for (std::size_t i = 0; i < strip.names.size(); ++i) {
        panel.y.names.emplace_back(static_cast<double>(i), strip.names[i]);
        panel.y.low = -0.4;
        panel.y.high = static_cast<double>(i) + 0.4;
    }
    for (const Line& line : strip.lines) {
        panel.series.push_back(least_and_largest(line, times));
        if (strip.lines.size() == 1) {
            panel.series.back().name.clear();
        }
    }
    if (const auto done = trace.done_s(); done && *done < times.back()) {
        panel.shades.push_back(
            {.from = *done,
             .to = times.back(),
             .name = trace.fault_cause.empty() ? "after done" : "force off: " + trace.fault_cause});
    }
    return panel;
}

}  // namespace

void add_strips(PageWriter& page, const Study& study, const TrialTrace& trace) {
    const std::vector<Strip> strips = strips_of(trace);
    const auto times = of_each(trace.ticks, [](const TickRecord& tick) {
        return 1e-9 * static_cast<double>(tick.time_ns);
    });
    const std::string of =
        fmt::format("trial_id = {} AND interval = {}", trace.trial, trace.interval);
    const char* third = trace.scene->space() != nullptr ? ", avg(hip_z_m) AS hip_z_m" : "";
    PageFigure figure{
        .id = "strips" + trace.place, .title = "Every tick" + trace.title, .width = 760.0};
    figure.data = study.ask(fmt::format(
        "SELECT CAST(time_s AS INTEGER) AS second, count(*) AS ticks, avg(hip_x_m) AS hip_x_m, "
        "avg(hip_y_m) AS hip_y_m{},\n       avg(iif(mode = 'free', NULL, rendered_normal_n)) AS "
        "normal_force_n, max(rendered_normal_n) AS normal_force_max_n,\n       "
        "max(abs(rendered_tangential_n)) AS friction_force_max_n, sum(mode = 'free') AS "
        "free_ticks, sum(mode = 'stuck') AS stuck_ticks,\n       sum(mode IN ('slip', "
        "'transition')) AS sliding_ticks, max(lateness_us) AS lateness_max_us\nFROM sample WHERE "
        "{}\nGROUP BY second ORDER BY second",
        third, of));
    figure.html = fmt::format(
        "<div class=\"live\" hidden></div>\n<script type=\"application/json\" "
        "class=\"ticks\">{}</script>\n",
        json_of(trace, strips, times));
    for (const Strip& strip : strips) {
        figure.panels.push_back(still_panel(trace, strip, times));
    }
    const std::size_t lost = static_cast<std::size_t>(trace.ticks.back().tick + 1) - times.size();
    figure.caption = fmt::format(
        "All {} ticks{}: play them, or set a time with the slider or by pointing at a strip; zoom "
        "by "
        "dragging along the time or with the buttons, a double click shows "
        "all again. Drawn in steps of 1 um, 1 mN, 0.1 mm/s and 0.1 us; printed, the least and the "
        "largest value of each of 400 stretches. {}The table has a row a "
        "second; every number of every tick: palpate sql {} --csv -c \"SELECT * FROM sample WHERE "
        "{}\", or palpate export --traces.",
        times.size(),
        lost == 0 ? "" : fmt::format("; {} more were lost on their way to the disk", lost),
        has_friction(trace) ? "Triangles: stick events. " : "", study.file, of);
    page.figure(figure);
}

}  // namespace palpate::data
