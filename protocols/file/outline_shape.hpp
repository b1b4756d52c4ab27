#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/geometry/outline.hpp"
#include "protocols/file/schema.hpp"

/// Private to protocols/file: whether curves bound an object, of protocols and of scenes alike.
namespace palpate::protocols {

/// Ends nearer than this, m, are one point; the same as Outline asks of a joint.
inline constexpr double kSameEnd = 1e-9;

/// That an outline is not closed, as a sentence with the remedy. @param what "the object dome"
/// @param gap m
[[nodiscard]] std::string gap_text(std::string_view what, double gap);

/// That an outline crosses or touches itself, as a sentence with the place and the remedy;
/// nothing if it does neither by its polyline (stimuli::silhouette), at most 20 um and 1/5000 of
/// the size away from it.
/// @param what    "the outline of dome"
/// @param closed  it ends where it begins, whichever way round it runs
[[nodiscard]] std::optional<std::string> crossing_text(std::string_view what,
                                                       const engine::Outline& outline,
                                                       bool closed = true);

/// From the end of the last curve to the start of the first, m. @pre at least one
[[nodiscard]] double closing_gap(const std::vector<engine::NurbsCurve<2>>& curves);

/// The path of the table of which a sentence of engine::Outline speaks, "segment 2 starts ...":
/// that of the first where it names none. @param around  path of the table that has them, or empty
[[nodiscard]] std::string spoken_segment(std::string_view sentence, std::string_view around = {});

/// A scene's chain of curves is closed or clearly open, and does not meet itself; else
/// a problem of the [[segment]]. Curves that are no chain may still be asked for the closest point:
/// nothing is said of them.
void check_ends_and_crossings(const std::vector<engine::NurbsCurve<2>>& curves,
                              const Places& places,
                              Problems& problems);

}  // namespace palpate::protocols
