#include "engine/surface/surface_border.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/text.hpp"
#include "engine/math/bernstein.hpp"

namespace palpate::engine {
namespace {

constexpr int kMaxHalvings = 24;
constexpr int kSamples = 48;

Vec3 value(std::vector<Quad> b, double t) {
    const Quad q = CutAt(std::move(b), t).left.back();
    return (1.0 / q.w()) * q.xyz();
}

/// One coordinate of homogeneous values.
Bernstein lane(const std::vector<Quad>& b, int k) {
    Bernstein values;
    for (const Quad& q : b) {
        values.push_back(k == 3 ? q.w() : q.xyz()[k]);
    }
    return values;
}

double least_weight(const std::vector<Quad>& b) {
    return std::ranges::min(b, {}, &Quad::w).w();
}

bool within(const std::vector<Quad>& a, const std::vector<Quad>& b, double tolerance, int depth) {
    std::array<Bernstein, 3> gap;
    for (int k = 0; k < 3; ++k) {
        gap[static_cast<std::size_t>(k)] =
            difference(product(lane(a, k), lane(b, 3)), product(lane(b, k), lane(a, 3)));
    }
    double max2 = 0.0;
    for (std::size_t i = 0; i < gap[0].size(); ++i) {
        max2 =
            std::max(max2, gap[0][i] * gap[0][i] + gap[1][i] * gap[1][i] + gap[2][i] * gap[2][i]);
    }
    if (std::sqrt(max2) <= tolerance * least_weight(a) * least_weight(b)) {
        return true;
    }
    if (depth == 0 || glm::length(value(a, 0.5) - value(b, 0.5)) > tolerance) {
        return false;
    }
    const CutAt of_a(a, 0.5);
    const CutAt of_b(b, 0.5);
    return within(of_a.left, of_b.left, tolerance, depth - 1) &&
           within(of_a.right, of_b.right, tolerance, depth - 1);
}

}  // namespace

SurfaceBorder::SurfaceBorder(const NurbsSurface& surface, std::size_t index, std::uint8_t side)
    : surface_(index),
      side_(side),
      knot_(side == 0   ? surface.knots_u().front()
            : side == 1 ? surface.knots_u().back()
            : side == 2 ? surface.knots_v().front()
                        : surface.knots_v().back()) {
    const bool along_v = side < 2;
    const KnotVector& knots = along_v ? surface.knots_v() : surface.knots_u();
    const double width = knots.back() - knots.front();
    for (const KnotVector::Interval& piece : knots.intervals()) {
        breaks_.push_back((piece.lo - knots.front()) / width);
    }
    breaks_.push_back(1.0);
    std::vector<Vec3> points;
    for (std::size_t k = 0; k + 1 < breaks_.size(); ++k) {
        const BezierPatch& patch = along_v
                                     ? surface.patch(side == 0 ? 0 : surface.rows() - 1, k)
                                     : surface.patch(k, side == 2 ? 0 : surface.columns() - 1);
        const int across = side % 2 == 0 ? 0 : along_v ? patch.degree_u() : patch.degree_v();
        const int degree = along_v ? patch.degree_v() : patch.degree_u();
        std::vector<Quad> net;
        for (int n = 0; n <= degree; ++n) {
            net.push_back(along_v ? patch.net(across, n) : patch.net(n, across));
            points.push_back((1.0 / net.back().w()) * net.back().xyz());
        }
        spans_.push_back(net);
    }
    box_ = box_of<3>(points);
}

std::size_t SurfaceBorder::span_of(double s) const noexcept {
    std::size_t k = 0;
    while (k + 2 < breaks_.size() && s >= breaks_[k + 1]) {
        ++k;
    }
    return k;
}

Vec3 SurfaceBorder::at(double s) const {
    const std::size_t k = span_of(s);
    return value(spans_[k], (s - breaks_[k]) / (breaks_[k + 1] - breaks_[k]));
}

std::string SurfaceBorder::name() const {
    return std::string("border ") + (side_ < 2 ? "u" : "v") + " = " + number_text(knot_) +
           " of surface " + std::to_string(surface_ + 1);
}

std::vector<Quad> SurfaceBorder::part(double lo, double hi) const {
    const std::size_t k = span_of(0.5 * (lo + hi));
    const double width = breaks_[k + 1] - breaks_[k];
    const double from = std::clamp((lo - breaks_[k]) / width, 0.0, 1.0);
    const double to = std::clamp((hi - breaks_[k]) / width, 0.0, 1.0);
    std::vector<Quad> net = to < 1.0 ? CutAt(spans_[k], to).left : spans_[k];
    return from > 0.0 ? CutAt(net, from / to).right : net;
}

double SurfaceBorder::distance(const Vec3& p) const {
    const auto gap = [&](double s) {
        return glm::length(at(std::clamp(s, 0.0, 1.0)) - p);
    };
    double best = 0.0;
    for (int k = 1; k <= kSamples; ++k) {
        const double s = static_cast<double>(k) / kSamples;
        best = gap(s) < gap(best) ? s : best;
    }
    double lo = best - 1.0 / kSamples;
    double hi = best + 1.0 / kSamples;
    for (int i = 0; i < 60; ++i) {
        const double a = lo + (hi - lo) / 3.0;
        const double b = hi - (hi - lo) / 3.0;
        (gap(a) < gap(b) ? hi : lo) = gap(a) < gap(b) ? b : a;
    }
    return std::min(gap(0.5 * (lo + hi)), gap(best));
}

bool same_curve(const SurfaceBorder& a, const SurfaceBorder& b, bool reversed, double tolerance) {
    std::vector<double> breaks = a.breaks();
    for (const double s : b.breaks()) {
        breaks.push_back(reversed ? 1.0 - s : s);
    }
    std::sort(breaks.begin(), breaks.end());
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
        const double lo = breaks[k];
        const double hi = breaks[k + 1];
        if (hi - lo < 1e-12) {
            continue;
        }
        std::vector<Quad> other = reversed ? b.part(1.0 - hi, 1.0 - lo) : b.part(lo, hi);
        if (reversed) {
            std::reverse(other.begin(), other.end());
        }
        if (!within(a.part(lo, hi), other, tolerance, kMaxHalvings)) {
            return false;
        }
    }
    return true;
}

double sampled_gap(const SurfaceBorder& a, const SurfaceBorder& b, bool reversed) {
    double max = 0.0;
    for (int k = 0; k <= kSamples; ++k) {
        const double s = static_cast<double>(k) / kSamples;
        max = std::max(max, glm::length(a.at(s) - b.at(reversed ? 1.0 - s : s)));
    }
    return max;
}

}  // namespace palpate::engine
