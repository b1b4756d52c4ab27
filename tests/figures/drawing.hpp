#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/geometry/nurbs_curve.hpp"
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

/// A path through points given in m, drawn in mm.
[[nodiscard]] Series path_mm(std::string name, std::span<const engine::Vec2> points);
/// The same as a cloud of dots.
[[nodiscard]] Series dots_mm(std::string name, std::span<const engine::Vec2> points);

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

/// A column of one value of each item.
template <class Items, class Value>
[[nodiscard]] CsvColumn column(std::string name, const Items& items, Value&& value) {
    CsvColumn out{.name = std::move(name)};
    for (const auto& item : items) {
        out.values.push_back(static_cast<double>(value(item)));
    }
    return out;
}

}  // namespace palpate::figures
