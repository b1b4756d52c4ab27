#include "tests/figures/drawing.hpp"

namespace palpate::figures {

using engine::Vec2;

Vec2 gap() {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNone, kNone};
}

Series with_look(Series series, const Look& look) {
    series.ink = look.ink;
    series.width = look.width;
    series.stroke = look.stroke;
    return series;
}

Series path_mm(std::string name, std::span<const Vec2> points, const Look& look) {
    Series series{.name = std::move(name)};
    for (const Vec2& p : points) {
        series.add(kMillimetres * p.x, kMillimetres * p.y);
    }
    return with_look(std::move(series), look);
}

Series dots_mm(std::string name, std::span<const Vec2> points, Ink ink) {
    Series series = path_mm(std::move(name), points, {ink});
    series.mark = Mark::points;
    return series;
}

Series dot_mm(std::string name, const Vec2& place, Ink ink) {
    return dots_mm(std::move(name), {&place, 1}, ink);
}

Series outline_mm(const std::vector<engine::NurbsCurve<2>>& curves) {
    constexpr int kSamples = 200;  // a curve
    std::vector<Vec2> points;
    for (const auto& curve : curves) {
        for (int i = 0; i <= kSamples; ++i) {
            const double share = static_cast<double>(i) / kSamples;
            points.push_back(
                curve.at(curve.front() + share * (curve.back() - curve.front())).point);
        }
    }
    return path_mm("object", points, {Ink::black, 2.0});
}

std::vector<Series> control_points_mm(const Polygons& polygons) {
    std::vector<Vec2> lines;
    std::vector<Vec2> points;
    for (const auto& polygon : polygons) {
        lines.insert(lines.end(), polygon.begin(), polygon.end());
        lines.push_back(gap());
        points.insert(points.end(), polygon.begin(), polygon.end());
    }
    return {path_mm("", lines, {Ink::orange, 1.2, Stroke::dotted}),
            dots_mm("control points", points, Ink::orange)};
}

std::vector<CsvColumn> control_point_table(const Polygons& polygons) {
    std::vector<CsvColumn> table{{"curve", {}}, {"control_x_m", {}}, {"control_y_m", {}}};
    for (std::size_t i = 0; i < polygons.size(); ++i) {
        for (const Vec2& p : polygons[i]) {
            add_row(table, {static_cast<double>(i), p.x, p.y});
        }
    }
    return table;
}

Panel plane_mm(std::string title, double height, std::string across, std::string up) {
    return {.title = std::move(title),
            .x = {.label = std::move(across), .unit = "mm"},
            .y = {.label = std::move(up), .unit = "mm"},
            .equal_aspect = true,
            .height = height};
}

void look_at(Panel& panel, double left, double right, double bottom, double top) {
    panel.x.low = left;
    panel.x.high = right;
    panel.y.low = bottom;
    panel.y.high = top;
}

Panel time_panel(std::string title, std::string what, std::string unit, double height) {
    return {.title = std::move(title),
            .x = {.label = "time", .unit = "s"},
            .y = {.label = std::move(what), .unit = std::move(unit)},
            .height = height};
}

}  // namespace palpate::figures
