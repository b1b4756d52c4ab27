#pragma once

#include "tests/support/surface_oracle.hpp"

/// Objects as a scene file has them, and a protocol its free forms.
namespace palpate::tests {

inline std::string toml_of(double number) {
    return fmt::format("{}", number);
}
inline std::string toml_of(const engine::Vec2& p) {
    return fmt::format("[{}, {}]", p.x, p.y);
}
inline std::string toml_of(const engine::Vec3& p) {
    return fmt::format("[{}, {}, {}]", p.x, p.y, p.z);
}
template <class One>
std::string toml_of(const std::vector<One>& all) {
    std::string text;
    for (const One& one : all) {
        text += (text.empty() ? "" : ", ") + toml_of(one);
    }
    return "[" + text + "]";
}

/// "weights = ...", or nothing where there are none: all of them are 1.
template <class Weight>
std::string weights_text(const std::vector<Weight>& weights) {
    return weights.empty() ? "" : "weights = " + toml_of(weights) + "\n";
}

/// A table of four lines.
inline std::string line_text(const engine::Vec2& from,
                             const engine::Vec2& to,
                             std::string_view kind = "line") {
    return fmt::format("[[segment]]\nkind = \"{}\"\nfrom_m = {}\nto_m = {}\n", kind, toml_of(from),
                       toml_of(to));
}
/// From corner to corner.
inline std::string lines_text(const std::vector<engine::Vec2>& corners) {
    std::string text;
    for (std::size_t i = 1; i < corners.size(); ++i) {
        text += line_text(corners[i - 1], corners[i]);
    }
    return text;
}
inline std::string arc_text(const engine::Vec2& from, const engine::Vec2& to, double curvature) {
    return line_text(from, to, "arc") + fmt::format("curvature_per_m = {}\n", curvature);
}

/// The object of a study in the plane: two arcs that meet at (0, 40) mm, on a base line.
inline std::string two_arcs_text(double curvature) {
    const engine::Vec2 a{-0.04, 0.0};
    const engine::Vec2 v{0.0, 0.04};
    const engine::Vec2 b{0.04, 0.0};
    return arc_text(a, v, curvature) + arc_text(v, b, curvature) + line_text(b, a);
}

inline std::string segment_text(const NurbsData<2>& curve, const std::string& head = "segment") {
    return fmt::format("[[{}]]\nkind = \"nurbs\"\ndegree = {}\nknots = {}\npoints_m = {}\n{}", head,
                       curve.degree, toml_of(curve.knots), toml_of(curve.points),
                       weights_text(curve.weights));
}

inline std::string surface_text(const SurfaceData& d) {
    return fmt::format(
        "[[surface]]\ndegree_u = {}\ndegree_v = {}\nknots_u = {}\nknots_v = {}\npoints_m = {}\n{}",
        d.degree_u, d.degree_v, toml_of(d.knots_u), toml_of(d.knots_v), toml_of(d.points),
        weights_text(d.weights));
}

/// Four corners, u from the first two to the others.
inline std::string plate_text(const std::vector<engine::Vec3>& first,
                              const std::vector<engine::Vec3>& second) {
    return surface_text(
        {.knots_u = {0, 0, 1, 1}, .knots_v = {0, 0, 1, 1}, .points = {first, second}});
}

}  // namespace palpate::tests
