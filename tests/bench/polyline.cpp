#include "tests/bench/polyline.hpp"

namespace palpate::bench {

std::vector<Vec2> polyline_of(const Object& object, std::size_t segments) {
    const std::vector<engine::RationalBezier<2>> spans = spans_of(object);
    const std::size_t each = segments / spans.size() > 0 ? segments / spans.size() : 1;
    std::vector<Vec2> points{spans.front().at(0.0).point};
    for (const auto& span : spans) {
        for (std::size_t i = 1; i <= each; ++i) {
            points.push_back(span.at(static_cast<double>(i) / static_cast<double>(each)).point);
        }
    }
    return points;
}

void PolylineWalk::reset(const Vec2& first) {
    active_ = 0;
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
        if (project(i, first).distance2 < project(active_, first).distance2) {
            active_ = i;
        }
    }
}

}  // namespace palpate::bench
