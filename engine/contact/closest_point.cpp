#include "engine/contact/closest_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

/// Splitting stops here: 2^-45 of u is 2e-15 m on an 80 mm curve, below every rounding error.
constexpr int kMaxDepth = 45;

/// Coefficients below this share of their terms' size are rounding noise.
constexpr double kNoise = 32.0 * std::numeric_limits<double>::epsilon();

double binomial(std::size_t n, std::size_t k) {
    double value = 1.0;
    for (std::size_t i = 1; i <= k; ++i) {
        value = value * static_cast<double>(n - k + i) / static_cast<double>(i);
    }
    return value;
}

/// Product of two polynomials in Bernstein form: Farouki & Rajan 1988, eq. 44.
std::vector<double> bernstein_product(const std::vector<double>& f, const std::vector<double>& g) {
    const std::size_t m = f.size() - 1;
    const std::size_t n = g.size() - 1;
    std::vector<double> product(m + n + 1, 0.0);
    for (std::size_t i = 0; i <= m; ++i) {
        for (std::size_t j = 0; j <= n; ++j) {
            product[i + j] +=
                binomial(m, i) * binomial(n, j) / binomial(m + n, i + j) * f[i] * g[j];
        }
    }
    return product;
}

std::vector<double> bernstein_derivative(const std::vector<double>& f) {
    std::vector<double> slope(f.size() - 1);
    for (std::size_t i = 0; i < slope.size(); ++i) {
        slope[i] = static_cast<double>(f.size() - 1) * (f[i + 1] - f[i]);
    }
    return slope;
}

/// a' b - a b', of degree 2p - 1.
std::vector<double> wronskian(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> left = bernstein_product(bernstein_derivative(a), b);
    const std::vector<double> right = bernstein_product(a, bernstein_derivative(b));
    for (std::size_t i = 0; i < left.size(); ++i) {
        left[i] -= right[i];
    }
    return left;
}

}  // namespace

SpanFeet::SpanFeet(const RationalBezier<2>& curve)
    : curve_(curve), box_min_(curve.point(0)), box_max_(curve.point(0)) {
    const auto points = static_cast<std::size_t>(curve.degree()) + 1;
    for (std::size_t i = 1; i < points; ++i) {
        box_min_ =
            Vec2{std::min(box_min_.x, curve.point(i).x), std::min(box_min_.y, curve.point(i).y)};
        box_max_ =
            Vec2{std::max(box_max_.x, curve.point(i).x), std::max(box_max_.y, curve.point(i).y)};
    }
    origin_ = 0.5 * (box_min_ + box_max_);
    std::vector<double> px(points);
    std::vector<double> py(points);
    std::vector<double> w(points);
    for (std::size_t i = 0; i < points; ++i) {
        w[i] = curve.weight(i);
        px[i] = w[i] * (curve.point(i).x - origin_.x);
        py[i] = w[i] * (curve.point(i).y - origin_.y);
    }
    const std::vector<double> dx = wronskian(px, w);  // W^2 C', local frame
    const std::vector<double> dy = wronskian(py, w);
    const std::vector<double> xx = bernstein_product(px, dx);
    const std::vector<double> yy = bernstein_product(py, dy);
    const std::vector<double> wx = bernstein_product(w, dx);
    const std::vector<double> wy = bernstein_product(w, dy);
    count_ = xx.size();
    for (std::size_t k = 0; k < count_; ++k) {
        constant_[k] = xx[k] + yy[k];
        linear_x_[k] = wx[k];
        linear_y_[k] = wy[k];
        scale_constant_ = std::max({scale_constant_, std::fabs(xx[k]), std::fabs(yy[k])});
        scale_linear_ = std::max({scale_linear_, std::fabs(wx[k]), std::fabs(wy[k])});
    }
}

double SpanFeet::bound2(const Vec2& h) const noexcept {
    const double dx = std::max({box_min_.x - h.x, 0.0, h.x - box_max_.x});
    const double dy = std::max({box_min_.y - h.y, 0.0, h.y - box_max_.y});
    return dx * dx + dy * dy;
}

SpanFeet::Foot SpanFeet::foot_at(const Vec2& h, double u) const noexcept {
    const Vec2 point = curve_.at(u).point;
    const Vec2 gap = point - h;
    return {u, point, glm::dot(gap, gap)};
}

/// Newton's iteration on g(u) = (C - h) . C', kept inside the bracket g(lo) < 0 < g(hi).
SpanFeet::Foot SpanFeet::polish(const Vec2& h, double lo, double hi) const noexcept {
    double u = 0.5 * (lo + hi);
    Jet<2> jet = curve_.at(u);
    for (int i = 0; i < 60; ++i) {
        const Vec2 gap = jet.point - h;
        const double g = glm::dot(gap, jet.first);
        const double slope = glm::dot(jet.first, jet.first) + glm::dot(gap, jet.second);
        (g < 0.0 ? lo : hi) = u;
        double next = slope > 0.0 ? u - g / slope : 0.5 * (lo + hi);
        if (!(next > lo && next < hi)) {
            if (g == 0.0 || std::fabs(next - u) <= std::numeric_limits<double>::epsilon()) {
                break;
            }
            next = 0.5 * (lo + hi);
        }
        const double step = std::fabs(next - u);
        u = next;
        jet = curve_.at(u);
        if (step <= 0.5 * std::numeric_limits<double>::epsilon()) {
            break;
        }
    }
    const Vec2 gap = jet.point - h;
    return {u, jet.point, glm::dot(gap, gap)};
}

SpanFeet::Foot SpanFeet::closest(const Vec2& h) const noexcept {
    const Vec2 local = h - origin_;
    Foot best = foot_at(h, 0.0);
    const auto offer = [&best](const Foot& foot) {
        if (foot.distance2 < best.distance2) {
            best = foot;
        }
    };
    offer(foot_at(h, 1.0));

    struct Piece {
        Coefficients f;
        double lo;
        double width;
        int depth;
    };
    std::array<Piece, kMaxDepth + 2> stack;  // each split leaves one sibling behind
    std::size_t top = 0;
    Piece& whole = stack[top++];
    whole.lo = 0.0;
    whole.width = 1.0;
    whole.depth = 0;
    for (std::size_t k = 0; k < count_; ++k) {
        whole.f[k] = constant_[k] - local.x * linear_x_[k] - local.y * linear_y_[k];
    }
    const double noise =
        kNoise * (scale_constant_ + (std::fabs(local.x) + std::fabs(local.y)) * scale_linear_);

    while (top > 0) {
        Piece& piece = stack[top - 1];
        int changes = 0;
        double last = 0.0;
        double first = 0.0;
        double largest = 0.0;
        for (std::size_t k = 0; k < count_; ++k) {
            const double c = piece.f[k];
            largest = std::max(largest, std::fabs(c));
            if (c == 0.0) {
                continue;
            }
            first = first == 0.0 ? c : first;
            changes += (last != 0.0 && (last < 0.0) != (c < 0.0)) ? 1 : 0;
            last = c;
        }
        if (largest <= noise || piece.depth >= kMaxDepth) {
            offer(foot_at(h, piece.lo + 0.5 * piece.width));  // flat within rounding: any u will do
            --top;
            continue;
        }
        if (changes == 0) {
            --top;
            continue;
        }
        if (changes == 1) {
            if (first < 0.0) {  // from - to +: the one root is a minimum
                offer(polish(h, piece.lo, piece.lo + piece.width));
            }
            --top;
            continue;
        }
        // De Casteljau at the middle: left half on top of the stack, right half stays below it.
        Piece& left = stack[top];
        left.lo = piece.lo;
        left.width = piece.width = 0.5 * piece.width;
        left.depth = piece.depth = piece.depth + 1;
        for (std::size_t level = 0; level < count_; ++level) {
            left.f[level] = piece.f[0];
            for (std::size_t k = 0; k + 1 < count_ - level; ++k) {
                piece.f[k] = 0.5 * (piece.f[k] + piece.f[k + 1]);
            }
        }
        // piece.f now holds the right half in place: f[k] is the last value of diagonal k.
        piece.lo += piece.width;
        ++top;
        if (left.f[count_ - 1] == 0.0) {
            offer(foot_at(h, piece.lo));  // a root exactly on the cut belongs to neither half
        }
    }
    return best;
}

OutlineFeet::OutlineFeet(const Outline& outline) : outline_(&outline) {
    feet_.reserve(outline.segments().size());
    for (const auto& segment : outline.segments()) {
        feet_.emplace_back(segment);
    }
}

ClosestPoint OutlineFeet::at_joint(std::size_t joint,
                                   const Vec2& h,
                                   double distance) const noexcept {
    const Joint& vertex = outline_->joints()[joint];
    ClosestPoint result{
        .place = {.on_joint = true, .index = joint}, .point = vertex.point, .distance = distance};
    if (vertex.kind == JointKind::convex) {
        const Vec2 normal = perp(vertex.tangent_in);
        const Vec2 gap = h - vertex.point;
        const double phi = arc_tan2(glm::dot(gap, vertex.tangent_in), glm::dot(gap, normal));
        result.place.parameter = std::clamp(phi, 0.0, vertex.turn);
    } else {
        result.inside = distance > 0.0;
    }
    return result;
}

ClosestPoint OutlineFeet::closest(const Vec2& h) const noexcept {
    SpanFeet::Foot best{.distance2 = std::numeric_limits<double>::infinity()};
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < feet_.size(); ++i) {
        if (feet_[i].bound2(h) >= best.distance2) {
            continue;
        }
        const SpanFeet::Foot foot = feet_[i].closest(h);
        if (foot.distance2 < best.distance2) {
            best = foot;
            nearest = i;
        }
    }
    const double distance = std::sqrt(best.distance2);
    const bool at_end = best.u == 0.0 || best.u == 1.0;
    if (at_end) {
        const auto joint = outline_->joint_beyond(nearest, best.u == 1.0);
        if (joint && outline_->joints()[*joint].kind != JointKind::smooth) {
            return at_joint(*joint, h, distance);
        }
        if (!joint) {
            return {.place = {.index = nearest, .parameter = best.u},
                    .point = best.point,
                    .distance = distance};
        }
    }
    const Frame frame = frame_at(outline_->segments()[nearest], best.u);
    return {.place = {.index = nearest, .parameter = best.u},
            .point = best.point,
            .distance = distance,
            .inside = glm::dot(h - best.point, frame.normal) < 0.0};
}

}  // namespace palpate::engine
