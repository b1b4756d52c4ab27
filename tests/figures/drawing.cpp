#include "tests/figures/drawing.hpp"

#include <limits>

namespace palpate::figures {

using engine::Vec2;

Vec2 gap() {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNone, kNone};
}

Series path_mm(std::string name, std::span<const Vec2> points) {
    Series series{.name = std::move(name)};
    for (const Vec2& p : points) {
        series.x.push_back(kMillimetres * p.x);
        series.y.push_back(kMillimetres * p.y);
    }
    return series;
}

Series dots_mm(std::string name, std::span<const Vec2> points) {
    Series series = path_mm(std::move(name), points);
    series.mark = Mark::points;
    return series;
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
    Series series = path_mm("object", points);
    series.ink = Ink::black;
    series.width = 2.0;
    return series;
}

std::vector<Series> control_points_mm(const Polygons& polygons) {
    std::vector<Vec2> lines;
    std::vector<Vec2> points;
    for (const auto& polygon : polygons) {
        lines.insert(lines.end(), polygon.begin(), polygon.end());
        lines.push_back(gap());
        points.insert(points.end(), polygon.begin(), polygon.end());
    }
    Series polygon = path_mm("", lines);
    polygon.ink = Ink::orange;
    polygon.stroke = Stroke::dotted;
    polygon.width = 1.2;
    Series dots = dots_mm("control points", points);
    dots.ink = Ink::orange;
    return {polygon, dots};
}

std::vector<CsvColumn> control_point_table(const Polygons& polygons) {
    std::vector<CsvColumn> table{{"curve", {}}, {"control_x_m", {}}, {"control_y_m", {}}};
    for (std::size_t i = 0; i < polygons.size(); ++i) {
        for (const Vec2& p : polygons[i]) {
            table[0].values.push_back(static_cast<double>(i));
            table[1].values.push_back(p.x);
            table[2].values.push_back(p.y);
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

}  // namespace palpate::figures
