#include "engine/surface/surface_slide.hpp"

#include <algorithm>
#include <cmath>

#include "engine/surface/surface_ground.hpp"

namespace palpate::engine {
namespace {

/// Steps before the GO gives up for this tick; 2 or 3 are usual. A pole takes some more.
constexpr int kSlideSteps = 64;
constexpr int kMaxCloseIn = 60;

/// Where to go from a spot: direction, length, and whether along a border.
struct Move {
    Vec3 direction{};
    double length = 0.0;
    bool border_u = false;  ///< on a border u = 0 or 1, along v
    bool border_v = false;

    [[nodiscard]] bool on_border() const noexcept { return border_u || border_v; }
};

/// The walk of one tick.
class Slider {
public:
    Slider(const NurbsSurface& surface, const Vec3& h, double mu) noexcept
        : ground_(surface, h, mu) {}

    SurfaceSlide run(const SurfacePlace& from) noexcept {
        SurfaceSpot s = ground_.look(from);
        double slid = 0.0;
        for (int i = 0; i < kSlideSteps && !SurfaceGround::settled(s); ++i) {
            const Move move = plan(s);
            if (!(move.length > 0.0)) {
                break;
            }
            const SurfaceSpot next = step(s, move);
            const double way = glm::length(next.jet.point - s.jet.point);
            if (!(way > 0.0)) {
                break;
            }
            slid += way;
            s = next;
        }
        return result(s, slid, !SurfaceGround::settled(s));
    }

    SurfaceSlide rest_at_foot(const SurfacePlace& from) noexcept {
        const Vec3 start = ground_.surface().local_jet(from).point;
        SurfaceSpot s = ground_.look(descend(ground_.surface(), ground_.h(), from).place);
        bool blocked = false;
        const double last_bits = 1e-10 * ground_.surface().size();
        while (s.length > last_bits) {  // at a pole or a border
            if (pole(s)) {
                s = ground_.look(descend(ground_.surface(), ground_.h(), s.place).place);
                continue;
            }
            const Vec2 way = SurfaceGround::parameters(s.jet, s.along);
            blocked = ground_.blocked_u(s, way.x) || ground_.blocked_v(s, way.y);
            break;
        }
        const double way = glm::length(s.jet.point - start);
        // Newton's last bits are no slip: a hand at rest finds the contact stuck.
        return result(s, way > 4.0 * SurfaceGround::tolerance(s) ? way : 0.0, blocked);
    }

private:
    /// Turns round at a pole; a few times at most, lest it go round for ever.
    bool pole(SurfaceSpot& s) noexcept {
        if (poles_ >= 4 || !ground_.turn_at_pole(s)) {
            return false;
        }
        ++poles_;
        return true;
    }

    [[nodiscard]] Move plan(SurfaceSpot& s) noexcept {
        static_cast<void>(pole(s));
        Move move{.direction = s.along / s.length};
        const Vec2 way = SurfaceGround::parameters(s.jet, move.direction);
        const bool out_u = ground_.blocked_u(s, way.x);
        const bool out_v = ground_.blocked_v(s, way.y);
        if (out_u || out_v) {
            return along_border(s, out_u, out_v);
        }
        const double bend = normal_curvature(s.jet, s.normal, way.x, way.y);
        const double reach = s.load + (s.load > 0.0 ? ground_.mu() * s.length : 0.0);
        move.length =
            (s.excess + 0.5 * SurfaceGround::tolerance(s)) / std::max(1.0 - bend * reach, 0.25);
        return move;
    }

    [[nodiscard]] Move along_border(const SurfaceSpot& s, bool out_u, bool out_v) const noexcept {
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
        const double rate = std::max(1.0 - glm::dot(ground_.h() - s.jet.point, k), 0.25);
        const double excess = std::fabs(along) - s.cone;
        move.length = excess > SurfaceGround::tolerance(s) ? excess / rate : 0.0;
        return move;
    }

    /// The spot after a step along `move`, shortened until |r| does not grow, and closed in where
    /// it went through the cone.
    [[nodiscard]] SurfaceSpot step(const SurfaceSpot& s, const Move& move) const noexcept {
        double length = move.length;
        SurfaceSpot next = go(s, move, length);
        const double limit =
            s.r2 + 2.0 * std::sqrt(s.r2) * SurfaceGround::tolerance(s);  // |r| plus rounding
        for (int i = 0; i < 40 && !(next.r2 <= limit); ++i) {
            length *= 0.5;
            next = go(s, move, length);
        }
        if (!(next.r2 <= limit)) {
            return s;
        }
        const bool too_far =
            next.excess < -SurfaceGround::tolerance(next) || measure(next, move) < -next.cone;
        return too_far ? close_in(s, move, length, next) : next;
    }

    /// Excess over the cone along the way of `move`, signed: below -cone HIP was overtaken.
    [[nodiscard]] static double measure(const SurfaceSpot& s, const Move& move) noexcept {
        if (!move.on_border()) {
            return glm::dot(s.along, move.direction) - s.cone;
        }
        const Vec3& edge = move.border_u ? s.jet.dv : s.jet.du;
        const double speed = glm::length(edge);
        const double along = speed > 0.0 ? glm::dot(s.along, edge) / speed : 0.0;
        return (glm::dot(edge, move.direction) < 0.0 ? -along : along) - s.cone;
    }

    [[nodiscard]] SurfaceSpot go(const SurfaceSpot& s,
                                 const Move& move,
                                 double length) const noexcept {
        const SurfaceJet& j = s.jet;
        SurfacePlace p = s.place;
        if (move.on_border()) {
            return on_border(s, move, length);
        }
        const Vec3 t = length * move.direction;
        const Vec2 way = SurfaceGround::parameters(j, t);
        const Vec3 bend =
            (0.5 * way.x * way.x) * j.duu + (way.x * way.y) * j.duv + (0.5 * way.y * way.y) * j.dvv;
        const Vec2 back = SurfaceGround::parameters(j, bend);
        const Vec3 corrected = back.x * j.du + back.y * j.dv;
        p.u += way.x - back.x;
        p.v += way.y - back.y;
        const bool mild = glm::length(corrected) <= 0.1 * length;
        if (mild && p.u >= 0.0 && p.u <= 1.0 && p.v >= 0.0 && p.v <= 1.0) {
            return ground_.look(p);
        }
        return ground_.look(descend(ground_.surface(), j.point + t, s.place).place);
    }

    [[nodiscard]] SurfaceSpot on_border(const SurfaceSpot& s,
                                        const Move& move,
                                        double length) const noexcept {
        SurfacePlace p = s.place;
        const Vec3& edge = move.border_u ? s.jet.dv : s.jet.du;
        const double by = length * glm::dot(move.direction, edge) / glm::dot(edge, edge);
        double& t = move.border_u ? p.v : p.u;
        t = std::clamp(t + by, 0.0, 1.0);
        if (t == 0.0 || t == 1.0) {  // at the end of the patch: the same point on the next one
            static_cast<void>(move.border_u ? ground_.surface().cross_v(p, t == 1.0)
                                            : ground_.surface().cross_u(p, t == 1.0));
        }
        return ground_.look(p);
    }

    /// Between the ends of a step, `s` outside and `inside` within, the spot on the inner side of
    /// the cone: regula falsi with the Illinois rule.
    [[nodiscard]] SurfaceSpot close_in(const SurfaceSpot& s,
                                       const Move& move,
                                       double length,
                                       const SurfaceSpot& inside) const noexcept {
        SurfaceSpot best = inside;
        double outer = 0.0;
        double inner = length;
        double f_outer = measure(s, move) + 0.5 * SurfaceGround::tolerance(s);
        double f_inner = measure(inside, move) + 0.5 * SurfaceGround::tolerance(inside);
        int last = 0;
        for (int i = 0; i < kMaxCloseIn && f_inner < 0.0; ++i) {
            double x = (outer * f_inner - inner * f_outer) / (f_inner - f_outer);
            if (!(x > std::min(outer, inner) && x < std::max(outer, inner))) {
                x = 0.5 * (outer + inner);
            }
            const SurfaceSpot spot = go(s, move, x);
            const double excess = measure(spot, move);
            const double shell = SurfaceGround::tolerance(spot);
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

    [[nodiscard]] SurfaceSlide result(const SurfaceSpot& s,
                                      double slid,
                                      bool blocked) const noexcept {
        return {.place = s.place,
                .point = s.jet.point,
                .normal = s.normal,
                .tangential = s.along,
                .length = s.length,
                .load = s.load,
                .slid = slid,
                .outside_cone = blocked,
                .in_crease = blocked && ground_.between(s.place)};
    }

    SurfaceGround ground_;
    int poles_ = 0;  ///< passed in this tick
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
