#pragma once

#include "tests/bench/method.hpp"
#include "tests/bench/objects.hpp"

namespace palpate::bench {

/// Vertices on the curves, about `segments` steps, shared evenly among the spans.
inline std::vector<Vec2> polyline_of(const Object& object, std::size_t segments) {
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

/// God-object on a polyline (Zilles & Salisbury 1995; Ho, Basdogan & Srinivasan 1999): the active
/// segment hands over to a neighbour as long as that is closer. Local: it may stay behind a spike.
class PolylineWalk {
public:
    explicit PolylineWalk(std::vector<Vec2> points) : points_(std::move(points)) {}

    void reset(const Vec2& first) {
        active_ = 0;
        for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
            if (project(i, first).distance2 < project(active_, first).distance2) {
                active_ = i;
            }
        }
    }
    Answer<2> answer(const Vec2& hip) noexcept {
        Projection best = project(active_, hip);
        for (;;) {
            if (best.t >= 1.0 && active_ + 2 < points_.size()) {
                const Projection next = project(active_ + 1, hip);
                if (next.distance2 < best.distance2) {
                    best = next;
                    ++active_;
                    continue;
                }
            } else if (best.t <= 0.0 && active_ > 0) {
                const Projection next = project(active_ - 1, hip);
                if (next.distance2 < best.distance2) {
                    best = next;
                    --active_;
                    continue;
                }
            }
            return {best.point, std::sqrt(best.distance2)};
        }
    }

private:
    struct Projection {
        Vec2 point{};
        double t = 0.0;
        double distance2 = 0.0;
    };
    [[nodiscard]] Projection project(std::size_t segment, const Vec2& hip) const noexcept {
        const Vec2 from = points_[segment];
        const Vec2 along = points_[segment + 1] - from;
        double t = glm::dot(hip - from, along) / glm::dot(along, along);
        t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
        const Vec2 point = from + t * along;
        return {point, t, glm::dot(hip - point, hip - point)};
    }

    std::vector<Vec2> points_;
    std::size_t active_ = 0;
};

}  // namespace palpate::bench
