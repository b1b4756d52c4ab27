#include "engine/surface/surface_leaf.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/math/bernstein.hpp"
#include "engine/surface/surface_object.hpp"

namespace palpate::engine {
namespace {

/// Coefficients are sums of products with a few roundings each; bounds are widened by this share.
constexpr double kMargin = 1e-13;

/// Range of a list of numbers, widened by rounding relative to `scale`.
struct Range {
    double low = 1e300;
    double high = -1e300;

    void add(double v) noexcept {
        low = std::min(low, v);
        high = std::max(high, v);
    }
};

/// Second differences of a Bernstein net, times the degrees: second derivatives.
/// @param kind  0: twice along u; 1: along u and v; 2: twice along v
Range bend_range(const DistanceForm& form, const std::vector<double>& g, int kind) {
    const auto a = static_cast<double>(form.n());
    const auto b = static_cast<double>(form.m());
    const std::size_t row = form.m() + 1;
    const std::size_t first =
        kind < 2 ? row : 1;  // how far apart the two places of a difference are
    const std::size_t second = kind < 1 ? row : 1;
    const std::size_t skip_u = kind == 0 ? 2 : kind == 1 ? 1 : 0;
    const std::size_t skip_v = 2 - skip_u;
    const double by = kind == 0 ? a * (a - 1.0) : kind == 1 ? a * b : b * (b - 1.0);
    Range range;
    for (std::size_t i = 0; i + skip_u <= form.n(); ++i) {
        for (std::size_t j = 0; j + skip_v <= form.m(); ++j) {
            const double* at = g.data() + i * row + j;
            range.add(by * ((at[first + second] - at[first]) - (at[second] - at[0])));
        }
    }
    const double wide = kMargin * by * largest_magnitude(g);
    return {range.low - wide, range.high + wide};
}

}  // namespace

std::vector<Quad> part_of_net(const BezierPatch& patch, const PatchPart& part) {
    const auto p = static_cast<std::size_t>(patch.degree_u());
    const auto q = static_cast<std::size_t>(patch.degree_v());
    std::vector<Quad> net(patch.net().begin(), patch.net().end());
    const auto at = [&](std::size_t i, std::size_t j) -> Quad& {
        return net[i * (q + 1) + j];
    };
    // Keep [0, t] (then the first values of each level) or [t, 1] (then the last ones).
    const auto cut = [&](bool in_u, double t, bool keep_before) {
        const std::size_t degree = in_u ? p : q;
        const std::size_t lines = in_u ? q : p;
        const double s = 1.0 - t;
        for (std::size_t line = 0; line <= lines; ++line) {
            const auto value = [&](std::size_t k) -> Quad& {
                return in_u ? at(k, line) : at(line, k);
            };
            for (std::size_t level = 1; level <= degree; ++level) {
                if (keep_before) {
                    for (std::size_t k = degree; k >= level; --k) {
                        value(k) = s * value(k - 1) + t * value(k);
                    }
                } else {
                    for (std::size_t k = 0; k + level <= degree; ++k) {
                        value(k) = s * value(k) + t * value(k + 1);
                    }
                }
            }
        }
    };
    cut(true, part.hi_u, true);
    cut(true, part.lo_u / part.hi_u, false);
    cut(false, part.hi_v, true);
    cut(false, part.lo_v / part.hi_v, false);
    return net;
}

SurfaceLeaf::SurfaceLeaf(int degree_u, int degree_v, std::span<const Quad> net, bool polynomial)
    : form_(set_box(degree_u, degree_v, net)) {
    const auto bend = [&form = form_, polynomial](int kind) {
        Bend b;
        const Range constant = bend_range(form, form.pp(), kind);
        b.low = constant.low;
        b.high = constant.high;
        double spread2 = 0.0;
        for (int k = 0; k < 3; ++k) {
            const Range r = bend_range(form, form.pw(k), kind);
            b.slope[k] = r.low + r.high;  // 2 (P W)'': the factor 2 of g, half of the sum
            spread2 += (r.high - r.low) * (r.high - r.low);
        }
        b.spread = std::sqrt(spread2) * (1.0 + kMargin);
        if (!polynomial) {  // W^2 = 1 does not bend
            const Range ww = bend_range(form, form.ww(), kind);
            b.ww_low = ww.low;
            b.ww_high = ww.high;
        }
        return b;
    };
    uu_ = bend(0);
    uv_ = bend(1);
    vv_ = bend(2);
    // Scaled parameters: both pure second derivatives about 1 on the surface itself.
    const auto unit = [](const Bend& b) {
        const double middle = 0.5 * (b.low + b.high);
        return middle > 0.0 ? 1.0 / std::sqrt(middle) : 0.0;
    };
    const double by_u = unit(uu_);
    const double by_v = unit(vv_);
    scale(uu_, by_u * by_u);
    scale(uv_, by_u * by_v);
    scale(vv_, by_v * by_v);
    const auto rate = [](const Bend& b) {
        return glm::length(b.slope) + b.spread;
    };
    const auto rate_ww = [](const Bend& b) {
        return std::max(std::fabs(b.ww_low), std::fabs(b.ww_high));
    };
    drift_ = std::max(rate(uu_), rate(vv_)) + rate(uv_);
    drift_ww_ = std::max(rate_ww(uu_), rate_ww(vv_)) + rate_ww(uv_);
}

void SurfaceLeaf::scale(Bend& bend, double by) const noexcept {
    bend.low *= by;
    bend.high *= by;
    bend.slope *= by;
    bend.spread *= by;
    bend.ww_low *= by;
    bend.ww_high *= by;
}

/// Axes along the leaf and across it, so that the box is as thin as the leaf. @return the form
/// about its middle
DistanceForm SurfaceLeaf::set_box(int degree_u, int degree_v, std::span<const Quad> net) {
    const auto p = static_cast<std::size_t>(degree_u);
    const auto q = static_cast<std::size_t>(degree_v);
    std::vector<Vec3> points;
    for (const Quad& value : net) {
        points.push_back((1.0 / value.w()) * value.xyz());
    }
    box_ = box_of<3>(points);
    Vec3 along{};
    Vec3 across{};
    for (std::size_t j = 0; j <= q; ++j) {
        along += points[p * (q + 1) + j] - points[j];
    }
    for (std::size_t i = 0; i <= p; ++i) {
        across += points[i * (q + 1) + q] - points[i * (q + 1)];
    }
    const Vec3 normal = glm::cross(along, across);
    const double area = glm::length(normal);
    if (area > 1e-6 * glm::dot(along, along) && area > 1e-6 * glm::dot(across, across)) {
        axes_[0] = along / glm::length(along);
        axes_[2] = normal / area;
        axes_[1] = glm::cross(axes_[2], axes_[0]);
    } else {
        axes_ = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    }
    Vec3 low{1e300};
    Vec3 high{-1e300};
    for (const Vec3& point : points) {
        const Vec3 x{glm::dot(point, axes_[0]), glm::dot(point, axes_[1]),
                     glm::dot(point, axes_[2])};
        low = glm::min(low, x);
        high = glm::max(high, x);
    }
    const Vec3 middle = 0.5 * (low + high);
    centre_ = middle.x * axes_[0] + middle.y * axes_[1] + middle.z * axes_[2];
    const Vec3 far = glm::max(glm::abs(box_.low), glm::abs(box_.high));
    half_ = 0.5 * (high - low) + Vec3{4e-15 * (glm::length(far) + glm::length(high - low))};
    return {degree_u, degree_v, net, centre_};
}

double SurfaceLeaf::bound2(const Vec3& h) const noexcept {
    const Vec3 q = h - centre_;
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
        const double out = std::fabs(glm::dot(q, axes_[static_cast<std::size_t>(k)])) - half_[k];
        sum += out > 0.0 ? out * out : 0.0;
    }
    return sum;
}

SurfaceLeaf::Bowl SurfaceLeaf::bowl(const Vec3& h, double d2) const noexcept {
    const Vec3 q = h - centre_;
    const double reach2 = glm::dot(q, q);
    const double reach = std::sqrt(reach2);
    const double rest = reach2 - d2;
    const auto smallest = [&](const Bend& b) {
        return b.low - glm::dot(q, b.slope) - reach * b.spread +
               std::min(rest * b.ww_low, rest * b.ww_high);
    };
    const double uu = smallest(uu_);
    const double vv = smallest(vv_);
    const double middle = 0.5 * (uv_.low + uv_.high) - glm::dot(q, uv_.slope) +
                          0.5 * rest * (uv_.ww_low + uv_.ww_high);
    const double uv = std::fabs(middle) + 0.5 * (uv_.high - uv_.low) + reach * uv_.spread +
                      0.5 * std::fabs(rest) * (uv_.ww_high - uv_.ww_low);
    // Smaller eigenvalue of the worst matrix, less what rounding of the bounds themselves may do.
    const double skew = 0.5 * (uu - vv);
    const double depth = 0.5 * (uu + vv) - std::sqrt(skew * skew + uv * uv) - 1e-9;
    if (!(depth > 0.0)) {
        return {};
    }
    if (drift_ww_ == 0.0) {
        return {depth, depth / (drift_ + std::numeric_limits<double>::min())};
    }
    // |q|^2 - d2 changes by at most 2 (reach + d) s + 2 s^2 when h moves by s: the root of a
    // parabola.
    const double rate = drift_ + drift_ww_ * 2.0 * (reach + std::sqrt(d2));
    return {depth, 2.0 * depth / (rate + std::sqrt(rate * rate + 8.0 * drift_ww_ * depth))};
}

}  // namespace palpate::engine
