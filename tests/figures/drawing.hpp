#pragma once

#include "engine/geometry/nurbs_curve.hpp"
#include "engine/rendering/mode.hpp"
#include "data/plot/figure.hpp"
#include "tests/figures/make.hpp"
#include "tests/figures/objects.hpp"

/// What several figures draw. Pictures of the plane are in mm, tables in m.
namespace palpate::figures {

using data::Figure;
using data::Ink;
using data::Label;
using data::Mark;
using data::Panel;
using data::Series;
using data::Shade;
using data::Stroke;

inline constexpr double kMillimetres = 1000.0;
inline constexpr double kTick = 0.001;  ///< s, between two ticks of what is shown

/// A place between lines: a line breaks there.
[[nodiscard]] engine::Vec2 gap();

/// How a line is drawn.
struct Look {
    Ink ink = Ink::automatic;
    double width = 1.6;  ///< px
    Stroke stroke = Stroke::solid;
};
[[nodiscard]] Series with_look(Series series, const Look& look);

/// A path through points given in m, drawn in mm.
[[nodiscard]] Series path_mm(std::string name,
                             std::span<const engine::Vec2> points,
                             const Look& look = {});
/// The same as a cloud of dots, and one dot.
[[nodiscard]] Series dots_mm(std::string name, std::span<const engine::Vec2> points, Ink ink);
[[nodiscard]] Series dot_mm(std::string name, const engine::Vec2& place, Ink ink);

/// An object's curves as one black line, in mm.
[[nodiscard]] Series outline_mm(const std::vector<engine::NurbsCurve<2>>& curves);
/// Its control polygons and control points, in mm.
[[nodiscard]] std::vector<Series> control_points_mm(const Polygons& polygons);
/// Control points as a table: curve, x_m, y_m.
[[nodiscard]] std::vector<CsvColumn> control_point_table(const Polygons& polygons);

/// Panel of equal aspect with both axes in mm.
[[nodiscard]] Panel plane_mm(std::string title,
                             double height,
                             std::string across = "x",
                             std::string up = "y");
/// Shows so much of the plane, in the units of the axes.
void look_at(Panel& panel, double left, double right, double bottom, double top);
/// Panel of something over time.
[[nodiscard]] Panel time_panel(std::string title,
                               std::string what,
                               std::string unit,
                               double height);

/// A value of each tick over its time.
template <class Tick, class Value, class Time = double Tick::*>
[[nodiscard]] Series over_time(std::string name,
                               const std::vector<Tick>& run,
                               const Value& value,
                               const Look& look = {},
                               const Time& time = &Tick::t) {
    Series series{.name = std::move(name)};
    for (const Tick& tick : run) {
        series.add(std::invoke(time, tick), std::invoke(value, tick));
    }
    return with_look(std::move(series), look);
}

/// Where the god-object was while in contact, and HIP, as `seen` from m in space to m in a picture.
template <class Tick, class Seen>
[[nodiscard]] std::vector<Series> go_and_hip(const std::vector<Tick>& run,
                                             const Seen& seen,
                                             const Look& go_look = {Ink::sky, 4.0}) {
    std::vector<engine::Vec2> go;
    std::vector<engine::Vec2> hip;
    for (const Tick& tick : run) {
        go.push_back(tick.mode == engine::Mode::free ? gap() : seen(tick.go));
        hip.push_back(seen(tick.hip));
    }
    return {path_mm("GO in contact", go, go_look), path_mm("HIP", hip, {Ink::vermillion})};
}

/// A ring with its number, from 1, at the place of each instant; none for an instant that did not
/// come. @param place  of a tick by its index, in the units of the axes
template <class Instants, class Place>
[[nodiscard]] std::vector<data::Marker> numbered(const Instants& instants, const Place& place) {
    std::vector<data::Marker> markers;
    int number = 0;
    for (const std::optional<std::size_t> tick : instants) {
        ++number;
        if (tick) {
            const engine::Vec2 at = place(*tick);
            markers.push_back({at.x, at.y, std::to_string(number)});
        }
    }
    return markers;
}

/// A column of one value of each item.
template <class Items, class Value>
[[nodiscard]] CsvColumn column(std::string name, const Items& items, const Value& value) {
    CsvColumn out{.name = std::move(name)};
    for (const auto& item : items) {
        out.values.push_back(static_cast<double>(std::invoke(value, item)));
    }
    return out;
}

/// Columns NAME_x_UNIT, NAME_y_UNIT and in space NAME_z_UNIT of a vector of each item.
template <class Items, class Vector>
void add_vectors(std::vector<CsvColumn>& table,
                 const std::string& name,
                 const char* unit,
                 const Items& items,
                 const Vector& vector) {
    constexpr int kAxes = std::remove_cvref_t<decltype(std::invoke(vector, items[0]))>::length();
    for (int axis = 0; axis < kAxes; ++axis) {
        table.push_back(column(fmt::format("{}_{}_{}", name, "xyz"[axis], unit), items,
                               [&](const auto& item) { return std::invoke(vector, item)[axis]; }));
    }
}

}  // namespace palpate::figures
