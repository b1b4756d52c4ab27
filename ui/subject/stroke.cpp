#include "ui/subject/stroke.hpp"

#include <algorithm>
#include <numeric>

namespace palpate::ui {
namespace {

using engine::cross;
using engine::perp;
using engine::Vec2;

/// Where an offset of 1 pixel puts a corner: along the bisector, longer by 1 / cos(half turn).
Vec2 mitre(const Vec2& before, const Vec2& at, const Vec2& after) {
    const Vec2 in = perp((at - before) / glm::length(at - before));
    const Vec2 out = perp((after - at) / glm::length(after - at));
    const Vec2 sum = in + out;
    const double length2 = glm::dot(sum, sum);
    if (length2 < 1e-12) {
        return out;
    }
    const Vec2 full = sum * (2.0 / length2);
    const double length = glm::length(full);
    return length > kMitre ? full * (kMitre / length) : full;
}

void quad(std::vector<Corner>& corners,
          const Corner& a,
          const Corner& b,
          const Corner& c,
          const Corner& d) {
    corners.insert(corners.end(), {a, b, c, a, c, d});
}

/// A ring between two offsets of the outline, with the covers at either.
void ring(std::vector<Corner>& corners,
          std::span<const Vec2> outline,
          std::span<const Vec2> mitres,
          double from,
          double to,
          float cover_from,
          float cover_to) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const std::size_t next = (i + 1) % outline.size();
        quad(corners, {outline[i] + from * mitres[i], cover_from},
             {outline[next] + from * mitres[next], cover_from},
             {outline[next] + to * mitres[next], cover_to},
             {outline[i] + to * mitres[i], cover_to});
    }
}

bool inside(const Vec2& p, const Vec2& a, const Vec2& b, const Vec2& c) {
    return cross(b - a, p - a) >= 0.0 && cross(c - b, p - b) >= 0.0 && cross(a - c, p - c) >= 0.0;
}

/// Places in the outline, in this order.
std::vector<std::size_t> counter_clockwise(std::span<const Vec2> outline) {
    std::vector<std::size_t> order(outline.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    double area = 0.0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        area += cross(outline[i], outline[(i + 1) % outline.size()]);
    }
    if (area < 0.0) {
        std::reverse(order.begin(), order.end());
    }
    return order;
}

}  // namespace

std::vector<Corner> stroke(std::span<const Vec2> outline, double width) {
    const std::size_t n = outline.size();
    std::vector<Vec2> mitres(n);
    for (std::size_t i = 0; i < n; ++i) {
        mitres[i] = mitre(outline[(i + n - 1) % n], outline[i], outline[(i + 1) % n]);
    }
    const double half = 0.5 * width;
    std::vector<Corner> corners;
    corners.reserve(18 * n);
    // Full cover inside, fading from half a pixel before the edge to half a pixel beyond it.
    ring(corners, outline, mitres, -half - 0.5, -half + 0.5, 0.0F, 1.0F);
    ring(corners, outline, mitres, -half + 0.5, half - 0.5, 1.0F, 1.0F);
    ring(corners, outline, mitres, half - 0.5, half + 0.5, 1.0F, 0.0F);
    return corners;
}

std::vector<Corner> fill(std::span<const Vec2> outline) {
    std::vector<std::size_t> left = counter_clockwise(outline);
    std::vector<Corner> corners;
    std::size_t i = 0;
    for (std::size_t tries = 0; left.size() > 2 && tries < left.size();) {
        const std::size_t n = left.size();
        const Vec2& a = outline[left[(i + n - 1) % n]];
        const Vec2& b = outline[left[i % n]];
        const Vec2& c = outline[left[(i + 1) % n]];
        bool ear = cross(b - a, c - b) >= 0.0;
        for (std::size_t k = 2; ear && k + 1 < n; ++k) {
            ear = !inside(outline[left[(i + k) % n]], a, b, c);
        }
        if (ear) {
            corners.insert(corners.end(), {{a}, {b}, {c}});
            left.erase(left.begin() + static_cast<std::ptrdiff_t>(i % n));
            tries = 0;
        } else {
            ++i;
            ++tries;
        }
        i = left.empty() ? 0 : i % left.size();
    }
    return corners;
}

std::vector<Corner> rectangle(const Vec2& corner, const Vec2& size) {
    const Vec2 far = corner + size;
    std::vector<Corner> corners;
    quad(corners, {corner}, {{far.x, corner.y}}, {far}, {{corner.x, far.y}});
    return corners;
}

}  // namespace palpate::ui
