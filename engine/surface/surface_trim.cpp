#include "engine/surface/surface_trim.hpp"

#include <algorithm>
#include <string>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/surface/surface_leaf.hpp"

namespace palpate::engine {
namespace {

constexpr double kNarrow = 1e-9;  ///< of the domain

std::string place_text(const Vec2& p) {
    return '(' + number_text(p.x) + ", " + number_text(p.y) + ")";
}

/// What of the knots lies within [lo, hi], with full multiplicity at both ends.
std::vector<double> knots_within(const KnotVector& knots, double lo, double hi) {
    const auto end = static_cast<std::size_t>(knots.degree()) + 1;
    std::vector<double> values(end, lo);
    std::copy_if(knots.values().begin(), knots.values().end(), std::back_inserter(values),
                 [lo, hi](double t) { return t > lo && t < hi; });
    values.insert(values.end(), end, hi);
    return values;
}

/// The share of a piece of the knots that lies within [lo, hi]; empty if b <= a.
struct Share {
    double a = 0.0;
    double b = 0.0;
};

Share share_of(const KnotVector::Interval& piece, double lo, double hi) {
    const double width = piece.hi - piece.lo;
    return {lo > piece.lo ? (lo - piece.lo) / width : 0.0,
            hi < piece.hi ? (hi - piece.lo) / width : 1.0};
}

/// Lines of one parameter: the ends of the domain and those of all corners.
std::vector<double> lines_of(std::span<const TrimLoop> loops,
                             const KnotVector& knots,
                             int axis,
                             const char* name) {
    std::vector<double> lines{knots.front(), knots.back()};
    for (const TrimLoop& loop : loops) {
        for (const Vec2& corner : loop) {
            lines.push_back(corner[axis]);
        }
    }
    std::sort(lines.begin(), lines.end());
    lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
    for (std::size_t k = 0; k + 1 < lines.size(); ++k) {
        refuse_if(
            lines[k + 1] - lines[k] < kNarrow * (knots.back() - knots.front()),
            "the trim lines {} = {:.9g} and {} = {:.9g} nearly touch: give both the same value",
            name, lines[k], name, lines[k + 1]);
    }
    return lines;
}

void check(const TrimLoop& loop, std::size_t number, const NurbsSurface& surface) {
    const std::string label = "trim loop " + std::to_string(number);
    refuse_if(loop.size() < 4, "{} has {} corners: give 4 or more", label, loop.size());
    const KnotVector& u = surface.knots_u();
    const KnotVector& v = surface.knots_v();
    for (std::size_t k = 0; k < loop.size(); ++k) {
        const Vec2& a = loop[k];
        const Vec2& b = loop[(k + 1) % loop.size()];
        refuse_if(!(a.x >= u.front() && a.x <= u.back() && a.y >= v.front() && a.y <= v.back()),
                  "corner {} of {} is {}: give u from {:.9g} to {:.9g} and v from {:.9g} to {:.9g}",
                  k + 1, label, place_text(a), u.front(), u.back(), v.front(), v.back());
        refuse_if((a.x == b.x) == (a.y == b.y),
                  "{} goes from {} to {}: give corners that change u alone or v alone; trims along "
                  "other lines are not supported",
                  label, place_text(a), place_text(b));
    }
}

/// How often the loops run round a place, counter-clockwise.
int turns_round(std::span<const TrimLoop> loops, const Vec2& p) {
    int turns = 0;
    for (const TrimLoop& loop : loops) {
        for (std::size_t k = 0; k < loop.size(); ++k) {
            const Vec2& a = loop[k];
            const Vec2& b = loop[(k + 1) % loop.size()];
            if (a.x == b.x && a.x > p.x && std::min(a.y, b.y) < p.y && p.y < std::max(a.y, b.y)) {
                turns += b.y > a.y ? 1 : -1;
            }
        }
    }
    return turns;
}

double area_of(const TrimLoop& loop) {
    double twice = 0.0;
    for (std::size_t k = 0; k < loop.size(); ++k) {
        twice += cross(loop[k], loop[(k + 1) % loop.size()]);
    }
    return 0.5 * twice;
}

}  // namespace

NurbsSurface NurbsSurface::part(double lo_u, double hi_u, double lo_v, double hi_v) const {
    NurbsSurface out = *this;
    const auto count = [](const std::vector<double>& knots, const KnotVector& of) {
        return knots.size() - static_cast<std::size_t>(of.degree()) - 1;
    };
    const auto in_u = knots_within(knots_u_, lo_u, hi_u);
    const auto in_v = knots_within(knots_v_, lo_v, hi_v);
    out.knots_u_ = KnotVector(in_u, knots_u_.degree(), count(in_u, knots_u_), "knots_u");
    out.knots_v_ = KnotVector(in_v, knots_v_.degree(), count(in_v, knots_v_), "knots_v");
    out.rows_ = out.knots_u_.intervals().size();
    out.columns_ = out.knots_v_.intervals().size();
    const bool first_u = lo_u == knots_u_.front();
    const bool last_u = hi_u == knots_u_.back();
    const bool first_v = lo_v == knots_v_.front();
    const bool last_v = hi_v == knots_v_.back();
    out.closed_u_ = closed_u_ && first_u && last_u;
    out.closed_v_ = closed_v_ && first_v && last_v;
    out.poles_ = {poles_[0] && first_u, poles_[1] && last_u, poles_[2] && first_v,
                  poles_[3] && last_v};
    out.patches_.clear();
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < rows_; ++i) {
        const Share u = share_of(knots_u_.intervals()[i], lo_u, hi_u);
        for (std::size_t j = 0; j < columns_ && u.a < u.b; ++j) {
            const Share v = share_of(knots_v_.intervals()[j], lo_v, hi_v);
            if (!(v.a < v.b)) {
                continue;
            }
            const BezierPatch& whole = patch(i, j);
            const auto net = part_of_net(whole, {u.a, u.b, v.a, v.b});
            out.patches_.emplace_back(whole.degree_u(), whole.degree_v(), net, polynomial_);
            for (const Quad& q : net) {
                points.push_back((1.0 / q.w()) * q.xyz());
            }
        }
    }
    out.box_ = box_of<3>(points);
    out.size_ = glm::length(out.box_.size());
    return out;
}

std::vector<std::shared_ptr<const NurbsSurface>> trimmed(const NurbsSurface& surface,
                                                         std::span<const TrimLoop> loops) {
    for (std::size_t k = 0; k < loops.size(); ++k) {
        check(loops[k], k + 1, surface);
    }
    const auto us = lines_of(loops, surface.knots_u(), 0, "u");
    const auto vs = lines_of(loops, surface.knots_v(), 1, "v");
    refuse_if(
        (us.size() - 1) * (vs.size() - 1) > kMaxCells,
        "trim loops cut the surface into {} cells: give loops with fewer corners, for at most {}",
        (us.size() - 1) * (vs.size() - 1), kMaxCells);
    const bool bounded = std::any_of(loops.begin(), loops.end(),
                                     [](const TrimLoop& loop) { return area_of(loop) > 0.0; });
    std::vector<std::shared_ptr<const NurbsSurface>> kept;
    for (std::size_t i = 0; i + 1 < us.size(); ++i) {
        for (std::size_t j = 0; j + 1 < vs.size(); ++j) {
            const Vec2 middle{0.5 * (us[i] + us[i + 1]), 0.5 * (vs[j] + vs[j + 1])};
            const int turns = turns_round(loops, middle) + (bounded ? 0 : 1);
            refuse_if(turns != 0 && turns != 1,
                      "trim loops cross, or run the wrong way round, near {}: give outer loops "
                      "counter-clockwise, holes in them clockwise, and none that cross",
                      place_text(middle));
            if (turns == 1) {
                kept.push_back(std::make_shared<const NurbsSurface>(
                    surface.part(us[i], us[i + 1], vs[j], vs[j + 1])));
            }
        }
    }
    refuse_if(
        kept.empty(),
        "the trim loops leave nothing: give an outer loop counter-clockwise, holes clockwise");
    return kept;
}

}  // namespace palpate::engine
