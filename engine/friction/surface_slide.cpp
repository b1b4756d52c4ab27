#include "engine/friction/surface_slide.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::engine {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Steps before the GO gives up for this tick; 2 or 3 are usual. A pole takes some more.
constexpr int kMaxSteps = 64;
constexpr int kMaxCloseIn = 60;

/// A place with everything that is measured there.
struct Spot {
    SurfacePlace place{};
    SurfaceJet jet{};
    Vec3 normal{};
    double r2 = 0.0;  ///< |h - g|^2
    Vec3 along{};     ///< tangential part of r
    double length = 0.0;
    double load = 0.0;
    double excess = 0.0;  ///< > 0: outside of the cone
    double cone = 0.0;    ///< mu max(load, 0)
};

/// Where to go from a spot: direction, length, and whether along a border.
struct Move {
    Vec3 direction{};
    double length = 0.0;
    bool border_u = false;  ///< on a border u = 0 or 1, along v
    bool border_v = false;

    [[nodiscard]] bool on_border() const noexcept { return border_u || border_v; }
};

class Slider {
public:
    Slider(const NurbsSurface& surface, const Vec3& h, double mu) noexcept
        : surface_(surface), h_(h), mu_(mu) {}

    SurfaceSlide run(const SurfacePlace& from) noexcept {
        Spot s = look(from);
        double slid = 0.0;
        for (int i = 0; i < kMaxSteps && !settled(s); ++i) {
            const Move move = plan(s);
            if (!(move.length > 0.0)) {
                break;
            }
            const Spot next = step(s, move);
            const double way = glm::length(next.jet.point - s.jet.point);
            if (!(way > 0.0)) {
                break;
            }
            slid += way;
            s = next;
        }
        return result(s, slid, !settled(s));
    }

    SurfaceSlide rest_at_foot(const SurfacePlace& from) noexcept {
        const Vec3 start = surface_.local_jet(from).point;
        Spot s = look(descend(surface_, h_, from).place);
        bool held = false;
        while (s.length > 1e-10 * surface_.size()) {  // not the last bits of a foot: a border
            if (turn_at_pole(s)) {
                s = look(descend(surface_, h_, s.place).place);
                continue;
            }
            const Vec2 way = parameters(s.jet, s.along);
            held = leaves_u(s, way.x) || leaves_v(s, way.y);
            break;
        }
        const double way = glm::length(s.jet.point - start);
        // Newton's last bits are no slip: a hand at rest finds the contact stuck.
        return result(s, way > 4.0 * tolerance(s) ? way : 0.0, held);
    }

private:
    /// The last bits before an edge belong to it: there the next patch, or the border, takes over.
    [[nodiscard]] static double snapped(double t) noexcept {
        return t < 8.0 * kEpsilon ? 0.0 : t > 1.0 - 8.0 * kEpsilon ? 1.0 : t;
    }

    [[nodiscard]] Spot look(SurfacePlace place) const noexcept {
        place.u = snapped(place.u);
        place.v = snapped(place.v);
        Spot s;
        s.place = place;
        s.jet = surface_.local_jet(place);
        s.normal = surface_.normal_at(place, s.jet);
        const Vec3 r = h_ - s.jet.point;
        const Stretch<3> parts = stretch<3>(r, s.normal);
        s.r2 = glm::dot(r, r);
        s.along = parts.tangential;
        s.length = parts.length;
        s.load = parts.load;
        s.cone = cone_radius<true>(mu_, s.load);
        s.excess = s.length - s.cone;
        return s;
    }

    /// Within its cone; where there is none (no load, no friction) at the local foot.
    [[nodiscard]] bool settled(const Spot& s) const noexcept {
        return s.excess <= 0.0 || (s.cone == 0.0 && s.length <= tolerance(s));
    }

    /// Width of the shell inside the cone in which a slide ends.
    [[nodiscard]] double tolerance(const Spot& s) const noexcept {
        return 1e-14 * s.cone + 4.0 * kEpsilon * (glm::length(s.jet.point) + std::sqrt(s.r2));
    }

    /// Parameters of the way `t` in the tangent plane: the 2 x 2 metric.
    [[nodiscard]] static Vec2 parameters(const SurfaceJet& j, const Vec3& t) noexcept {
        const double e = glm::dot(j.du, j.du);
        const double f = glm::dot(j.du, j.dv);
        const double g = glm::dot(j.dv, j.dv);
        const double a = glm::dot(j.du, t);
        const double b = glm::dot(j.dv, t);
        const double det = e * g - f * f;
        if (det > 1e-20 * e * g && det > 0.0) {
            return Vec2{(g * a - f * b) / det, (e * b - f * a) / det};
        }
        return Vec2{e > 0.0 ? a / e : 0.0, g > 0.0 ? b / g : 0.0};
    }

    [[nodiscard]] Move plan(Spot& s) noexcept {
        static_cast<void>(turn_at_pole(s));
        Move move{.direction = s.along / s.length};
        const Vec2 way = parameters(s.jet, move.direction);
        const bool out_u = leaves_u(s, way.x);
        const bool out_v = leaves_v(s, way.y);
        if (out_u || out_v) {
            return along_border(s, out_u, out_v);
        }
        const double bend = normal_curvature(s.jet, s.normal, way.x, way.y);
        const double reach = s.load + (s.load > 0.0 ? mu_ * s.length : 0.0);
        move.length = (s.excess + 0.5 * tolerance(s)) / std::max(1.0 - bend * reach, 0.25);
        return move;
    }

    [[nodiscard]] bool leaves_u(const Spot& s, double du) const noexcept {
        const SurfacePlace& p = s.place;
        SurfacePlace beyond = p;
        return ((p.u == 0.0 && du < 0.0) || (p.u == 1.0 && du > 0.0)) &&
               (!surface_.cross_u(beyond, du > 0.0) || pushes_back(s, beyond, true));
    }
    [[nodiscard]] bool leaves_v(const Spot& s, double dv) const noexcept {
        const SurfacePlace& p = s.place;
        SurfacePlace beyond = p;
        return ((p.v == 0.0 && dv < 0.0) || (p.v == 1.0 && dv > 0.0)) &&
               (!surface_.cross_v(beyond, dv > 0.0) || pushes_back(s, beyond, false));
    }

    /// A concave crease: on its other side HIP draws the GO back over the edge.
    [[nodiscard]] bool pushes_back(const Spot& here,
                                   const SurfacePlace& beyond,
                                   bool in_u) const noexcept {
        const Spot s = look(beyond);
        if (glm::length(s.normal - here.normal) <= 1e-9) {
            return false;  // smooth: the slope is the same on both sides, to rounding
        }
        const Vec2 way = parameters(s.jet, s.along);
        return in_u ? (beyond.u == 0.0 ? way.x < 0.0 : way.x > 0.0)
                    : (beyond.v == 0.0 ? way.y < 0.0 : way.y > 0.0);
    }

    [[nodiscard]] Move along_border(const Spot& s, bool out_u, bool out_v) const noexcept {
        Move move{.border_u = out_u, .border_v = out_v};
        const Vec3& edge = out_u ? s.jet.dv : s.jet.du;
        const double speed2 = glm::dot(edge, edge);
        if ((out_u && out_v) || !(speed2 > 0.0)) {
            return move;  // a corner
        }
        const Vec3 e = edge / std::sqrt(speed2);
        const double along = glm::dot(s.along, e);
        move.direction = along < 0.0 ? -e : e;
        // d(r . e)/ds = -1 + r . k with the curvature vector k of the border.
        const Vec3 second = out_u ? s.jet.dvv : s.jet.duu;
        const Vec3 k = (second - glm::dot(second, e) * e) / speed2;
        const double rate = std::max(1.0 - glm::dot(h_ - s.jet.point, k), 0.25);
        const double excess = std::fabs(along) - s.cone;
        move.length = excess > tolerance(s) ? excess / rate : 0.0;
        return move;
    }

    /// On an edge that is one point: to the place on it from which the surface goes on along the
    /// stretch, within 6 degrees. The point stays the same.
    bool turn_at_pole(Spot& s) noexcept {
        const bool in_u = (s.place.u == 0.0 || s.place.u == 1.0) && collapsed(s.jet.dv);
        const bool in_v = (s.place.v == 0.0 || s.place.v == 1.0) && collapsed(s.jet.du);
        if (!(in_u || in_v) || poles_ >= 4 || !(s.length > 0.0)) {
            return false;
        }
        ++poles_;
        double best = -1e301;
        SurfacePlace found = s.place;
        const std::size_t patches = in_u ? surface_.columns() : surface_.rows();
        constexpr int kPerPatch = 8;
        for (std::size_t k = 0; k < patches; ++k) {
            for (int step = 0; step <= kPerPatch; ++step) {
                SurfacePlace p = s.place;
                (in_u ? p.j : p.i) = k;
                (in_u ? p.v : p.u) = static_cast<double>(step) / kPerPatch;
                const double match = way_off(p, in_u, s.along);
                if (match > best) {
                    best = match;
                    found = p;
                }
            }
        }
        s = look(found);
        return true;
    }

    [[nodiscard]] bool collapsed(const Vec3& edge) const noexcept {
        return glm::length(edge) <= 1e-9 * surface_.size();
    }

    /// Part of the unit vector that leads from an edge into the surface along `t`.
    [[nodiscard]] double way_off(const SurfacePlace& p, bool in_u, const Vec3& t) const noexcept {
        const SurfaceJet jet = surface_.local_jet(p);
        const double side = (in_u ? p.u : p.v) == 0.0 ? 1.0 : -1.0;
        const Vec3 inwards = side * (in_u ? jet.du : jet.dv);
        const double length = glm::length(inwards);
        return length > 0.0 ? glm::dot(inwards, t) / length : -1e300;
    }

    /// The spot after a step along `move`, shortened until |r| does not grow, and closed in where it
    /// went through the cone.
    [[nodiscard]] Spot step(const Spot& s, const Move& move) const noexcept {
        double length = move.length;
        Spot next = go(s, move, length);
        const double most = s.r2 + 2.0 * std::sqrt(s.r2) * tolerance(s);  // |r| plus rounding
        for (int i = 0; i < 40 && !(next.r2 <= most); ++i) {
            length *= 0.5;
            next = go(s, move, length);
        }
        if (!(next.r2 <= most)) {
            return s;
        }
        const bool too_far = next.excess < -tolerance(next) || measure(next, move) < -next.cone;
        return too_far ? close_in(s, move, length, next) : next;
    }

    /// Excess over the cone along the way of `move`, signed: below -cone HIP was overtaken.
    [[nodiscard]] static double measure(const Spot& s, const Move& move) noexcept {
        if (!move.on_border()) {
            return glm::dot(s.along, move.direction) - s.cone;
        }
        const Vec3& edge = move.border_u ? s.jet.dv : s.jet.du;
        const double speed = glm::length(edge);
        const double along = speed > 0.0 ? glm::dot(s.along, edge) / speed : 0.0;
        return (glm::dot(edge, move.direction) < 0.0 ? -along : along) - s.cone;
    }

    [[nodiscard]] Spot go(const Spot& s, const Move& move, double length) const noexcept {
        const SurfaceJet& j = s.jet;
        SurfacePlace p = s.place;
        if (move.on_border()) {
            return on_border(s, move, length);
        }
        const Vec3 t = length * move.direction;
        const Vec2 way = parameters(j, t);
        const Vec3 bend =
            (0.5 * way.x * way.x) * j.duu + (way.x * way.y) * j.duv + (0.5 * way.y * way.y) * j.dvv;
        const Vec2 back = parameters(j, bend);
        const Vec3 corrected = back.x * j.du + back.y * j.dv;
        p.u += way.x - back.x;
        p.v += way.y - back.y;
        const bool mild = glm::length(corrected) <= 0.1 * length;
        if (mild && p.u >= 0.0 && p.u <= 1.0 && p.v >= 0.0 && p.v <= 1.0) {
            return look(p);
        }
        return look(descend(surface_, j.point + t, s.place).place);
    }

    [[nodiscard]] Spot on_border(const Spot& s, const Move& move, double length) const noexcept {
        SurfacePlace p = s.place;
        const Vec3& edge = move.border_u ? s.jet.dv : s.jet.du;
        const double by = length * glm::dot(move.direction, edge) / glm::dot(edge, edge);
        double& t = move.border_u ? p.v : p.u;
        t = std::clamp(t + by, 0.0, 1.0);
        if (t == 0.0 || t == 1.0) {  // at the end of the patch: the same point on the next one
            static_cast<void>(move.border_u ? surface_.cross_v(p, t == 1.0)
                                            : surface_.cross_u(p, t == 1.0));
        }
        return look(p);
    }

    /// Between the ends of a step, `s` outside and `inside` within, the spot on the inner side of the
    /// cone: regula falsi with the Illinois rule.
    [[nodiscard]] Spot close_in(const Spot& s,
                                const Move& move,
                                double length,
                                const Spot& inside) const noexcept {
        Spot best = inside;
        double outer = 0.0;
        double inner = length;
        double f_outer = measure(s, move) + 0.5 * tolerance(s);
        double f_inner = measure(inside, move) + 0.5 * tolerance(inside);
        int last = 0;
        for (int i = 0; i < kMaxCloseIn && f_inner < 0.0; ++i) {
            double x = (outer * f_inner - inner * f_outer) / (f_inner - f_outer);
            if (!(x > std::min(outer, inner) && x < std::max(outer, inner))) {
                x = 0.5 * (outer + inner);
            }
            const Spot spot = go(s, move, x);
            const double excess = measure(spot, move);
            const double shell = tolerance(spot);
            const double f = excess + 0.5 * shell;
            if (excess <= 0.0) {
                best = spot;
            }
            if (excess <= 0.0 && excess >= -shell) {
                break;
            }
            if (x == outer || x == inner) {
                break;
            }
            if (f > 0.0) {
                outer = x;
                f_outer = f;
                f_inner *= last == 1 ? 0.5 : 1.0;
                last = 1;
            } else {
                inner = x;
                f_inner = f;
                f_outer *= last == -1 ? 0.5 : 1.0;
                last = -1;
            }
        }
        return best;
    }

    /// On an edge between two patches, not on an open border.
    [[nodiscard]] bool between(SurfacePlace p) const noexcept {
        return ((p.u == 0.0 || p.u == 1.0) && surface_.cross_u(p, p.u == 1.0)) ||
               ((p.v == 0.0 || p.v == 1.0) && surface_.cross_v(p, p.v == 1.0));
    }

    [[nodiscard]] SurfaceSlide result(const Spot& s, double slid, bool held) const noexcept {
        return {.place = s.place,
                .point = s.jet.point,
                .normal = s.normal,
                .tangential = s.along,
                .length = s.length,
                .load = s.load,
                .slid = slid,
                .held_outside = held,
                .in_crease = held && between(s.place)};
    }

    const NurbsSurface& surface_;
    Vec3 h_;
    double mu_;
    int poles_ = 0;
};

}  // namespace

template <bool HasFriction>
SurfaceSlide slide_on_surface(const NurbsSurface& surface,
                              const SurfacePlace& from,
                              const Vec3& h,
                              double mu) noexcept {
    if constexpr (HasFriction) {
        return Slider(surface, h, mu).run(from);
    } else {
        return Slider(surface, h, 0.0).rest_at_foot(from);
    }
}

template SurfaceSlide slide_on_surface<true>(const NurbsSurface&,
                                             const SurfacePlace&,
                                             const Vec3&,
                                             double) noexcept;
template SurfaceSlide slide_on_surface<false>(const NurbsSurface&,
                                              const SurfacePlace&,
                                              const Vec3&,
                                              double) noexcept;

}  // namespace palpate::engine
