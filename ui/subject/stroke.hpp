#pragma once

#include <span>
#include <vector>

#include "ui/subject/window.hpp"

/// Anti-aliased shapes from triangles whose edges fade over one pixel. Points in pixels.
namespace palpate::ui {

/// A closed line of `width` pixels along `outline`, with mitred corners; sharper ones than kMitre
/// are cut short. The line covers its true area within 1 %, on SDL's software renderer inside
/// Window::fine(). @pre >= 3 points, no two in a row alike
[[nodiscard]] std::vector<Corner> stroke(std::span<const engine::Vec2> outline, double width);

/// The inside of a simple polygon, by cutting ears. Hard edges: put a stroke over them.
/// @pre >= 3 points, no crossing
[[nodiscard]] std::vector<Corner> fill(std::span<const engine::Vec2> outline);

/// A rectangle with soft edges.
[[nodiscard]] std::vector<Corner> rectangle(const engine::Vec2& corner, const engine::Vec2& size);

/// Longest mitre, in half widths of the line.
inline constexpr double kMitre = 4.0;

}  // namespace palpate::ui
