#include "protocols/file/outline_shape.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/geometry/cusps.hpp"
#include "stimuli/free_outline.hpp"

namespace palpate::protocols {
namespace {

using engine::Vec2;

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

/// Where the two curves of a vertex that turns back cross beside it, nearer to each other than a
/// polyline tells: its wedge would be taken for its outside, as far as anyone goes. Both are
/// compared at the same distances back from the tip, doubled until they are clearly apart.
std::optional<Vec2> crossing_beside(const engine::RationalBezier<2>& in,
                                    const engine::RationalBezier<2>& out,
                                    double size) {
    constexpr int kDoublings = 40;
    const Vec2 tip = out.point(0);
    const Vec2 along = engine::end_tangent(in, true);
    const auto back = [&](const Vec2& point) {
        return glm::dot(tip - point, along);
    };
    const auto before = [&in](double u) {
        return in.at(1.0 - u, u).point;
    };
    double side = 0.0;
    double far = 0x1p-50;
    for (int k = kDoublings; k >= 0 && glm::dot(along, engine::end_tangent(out, false)) < 0.0;
         --k) {
        const Vec2 after = out.at(std::ldexp(1.0, -k)).point;
        while (far < 1.0 && back(before(far)) < back(after)) {
            far *= 2.0;
        }
        double lo = 0.0;
        double hi = far;
        while (0.5 * (lo + hi) > lo && 0.5 * (lo + hi) < hi) {
            (back(before(0.5 * (lo + hi))) < back(after) ? lo : hi) = 0.5 * (lo + hi);
        }
        const double gap = engine::cross(along, after - before(hi));
        if (back(before(hi)) < back(after) || std::fabs(gap) > 10.0 * kFlatShare * size) {
            break;
        }
        if (std::fabs(gap) > 1e-12 * size) {
            if (side * gap < 0.0) {
                return after;
            }
            side = gap;
        }
    }
    return std::nullopt;
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
    const double size = size_of(outline);
    std::vector<Vec2> line = stimuli::silhouette(outline, std::min(kFlatness, kFlatShare * size));
    if (closed && !outline.closed()) {
        line.pop_back();  // where it begins
    }
    std::optional<Vec2> meeting = stimuli::self_crossing(line, closed);
    const auto& spans = outline.spans();
    for (std::size_t i = closed ? 0 : 1; i < spans.size() && !meeting; ++i) {
        meeting = crossing_beside(i > 0 ? spans[i - 1] : spans.back(), spans[i], size);
    }
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
