#include "protocols/file/outline_shape.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "stimuli/free_outline.hpp"

namespace palpate::protocols {
namespace {

/// How far the polyline that is looked at may be from the outline: m, and of its size.
constexpr double kFlatness = 20e-6;
constexpr double kFlatShare = 2e-4;

/// An open outline whose ends are nearer than this share of its size was meant to be closed, as
/// borders of surfaces that are so near were meant to be one.
constexpr double kNearlyClosed = 1e-3;

/// Diagonal of the box of all control points, m.
double size_of(const engine::Outline& outline) {
    engine::Box<2> all = outline.spans().front().box();
    for (const auto& span : outline.spans()) {
        all.add(span.box());
    }
    return glm::length(all.size());
}

}  // namespace

std::string gap_text(std::string_view what, double gap) {
    return fmt::format(
        "{} is open: its last segment ends {:.6g} mm from where the first begins; let them share "
        "the point",
        what, 1e3 * gap);
}

std::optional<std::string> crossing_text(std::string_view what,
                                         const engine::Outline& outline,
                                         bool closed) {
    const double tolerance = std::min(kFlatness, kFlatShare * size_of(outline));
    std::vector<engine::Vec2> line = stimuli::silhouette(outline, tolerance);
    if (closed && !outline.closed()) {
        line.pop_back();  // where it begins
    }
    const auto meeting = stimuli::self_crossing(line, closed);
    if (!meeting) {
        return std::nullopt;
    }
    return fmt::format("{} meets itself near [{:.3f}, {:.3f}] mm: keep its curves apart", what,
                       1e3 * meeting->x, 1e3 * meeting->y);
}

std::string spoken_segment(std::string_view sentence, std::string_view around) {
    constexpr std::string_view kWord = "segment ";
    const std::size_t word = sentence.find(kWord);
    const std::string_view rest =
        word == std::string_view::npos ? "" : sentence.substr(word + kWord.size());
    const std::string_view number = rest.substr(0, rest.find_first_not_of("0123456789"));
    return fmt::format("{}{}segment.{}", around, around.empty() ? "" : ".",
                       number.empty() ? "1" : number);
}

double closing_gap(const std::vector<engine::NurbsCurve<2>>& curves) {
    const auto& first = curves.front();
    const auto& last = curves.back();
    return glm::length(last.at(last.back()).point - first.at(first.front()).point);
}

void check_ends_and_crossings(const std::vector<engine::NurbsCurve<2>>& curves,
                              const Places& places,
                              Problems& problems) {
    const double gap = closing_gap(curves);
    const bool ends = gap <= kSameEnd;
    std::optional<engine::Outline> outline;
    try {
        outline.emplace(curves, false);  // whichever way round it runs
    } catch (const std::invalid_argument&) {
        return;
    }
    const double near = kNearlyClosed * size_of(*outline);
    if (!ends && gap <= near) {
        problems.add(places.of(fmt::format("segment.{}", curves.size())),
                     gap_text("the outline", gap) +
                         fmt::format(", or leave more than {:.6g} mm between them", 1e3 * near));
    } else if (const auto meeting = crossing_text("the outline", *outline, ends)) {
        problems.add(places.of("segment.1"), *meeting);
    }
}

}  // namespace palpate::protocols
