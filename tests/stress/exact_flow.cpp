#include "tests/stress/exact_flow.hpp"

#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>

namespace palpate::stress {
namespace {

using namespace palpate::engine;
using namespace palpate::tests;

constexpr int kMaxSteps = 4000;
constexpr long double kStepError = 1e-12L;  ///< of |r|, or of the size if that is less
constexpr long double kOn = 1e-14L;         ///< so close to an edge is on it, of its range

/// The interval of index i among those that are not empty.
std::size_t knot_of(const std::vector<double>& t, std::size_t i) {
    for (std::size_t k = 0; k + 1 < t.size(); ++k) {
        if (t[k] < t[k + 1] && i-- == 0) {
            return k;
        }
    }
    return 0;
}

}  // namespace

ExactFlow::Piece ExactFlow::piece_of(const SurfacePlace& p) const {
    const auto& d = (*oracles_)[p.surface].data();
    Piece piece{.surface = p.surface, .i = p.i, .j = p.j};
    piece.pu = knot_of(d.knots_u, p.i);
    piece.pv = knot_of(d.knots_v, p.j);
    piece.lo = {d.knots_u[piece.pu], d.knots_v[piece.pv]};
    piece.hi = {d.knots_u[piece.pu + 1], d.knots_v[piece.pv + 1]};
    return piece;
}

ExactFlow::Place ExactFlow::look(const Piece& piece, const Two& at) const {
    const LongJet j = (*oracles_)[piece.surface].jet(piece.pu, piece.pv, at[0], at[1]);
    Place p;
    p.at = at;
    p.point = j.s;
    const Long3 r = h_ - j.s;
    p.reach = std::sqrt(glm::dot(r, r));
    const Long3 area = glm::cross(j.su, j.sv);
    const long double e = glm::dot(j.su, j.su);
    const long double f = glm::dot(j.su, j.sv);
    const long double g = glm::dot(j.sv, j.sv);
    const long double area2 = glm::dot(area, area);
    p.metric = {e, f, g};
    const long double tiny = 1e-18L * object_->size() * object_->size();  // a pole
    if (!(area2 > 1e-20L * e * g) || e < tiny || g < tiny) {
        return p;
    }
    const Long3 n = (1.0L / std::sqrt(area2)) * area;
    p.load = -glm::dot(r, n);
    const Long3 t = r + p.load * n;
    p.along = std::sqrt(glm::dot(t, t));
    p.excess = p.along - mu_ * std::max(p.load, 0.0L);
    const long double a = glm::dot(t, j.su);
    const long double b = glm::dot(t, j.sv);
    const long double by = 1.0L / (area2 * p.along);
    p.way = {(g * a - f * b) * by, (e * b - f * a) * by};
    p.regular = std::isfinite(p.way[0]) && std::isfinite(p.way[1]) && p.along > 0.0L;
    return p;
}

long double ExactFlow::room(const Piece& piece, const Place& p) const {
    long double least = p.excess / p.reach;
    for (std::size_t k = 0; k < 2; ++k) {
        const long double range = piece.hi[k] - piece.lo[k];
        least = std::min(
            {least, (p.at[k] - piece.lo[k]) / range + kOn, (piece.hi[k] - p.at[k]) / range + kOn});
    }
    return least;
}

/// Dormand & Prince (1980), J. Comp. Appl. Math. 6.
ExactFlow::Step ExactFlow::step(const Piece& piece, const Place& from, long double s) const {
    boost::numeric::odeint::runge_kutta_dopri5<Two, long double> rule;
    Step result{.clean = true, .regular = true};
    const auto slope = [&](const Two& at, Two& way, long double /*s*/) {
        result.to = look(piece, at);
        result.regular = result.regular && result.to.regular;
        result.clean = result.clean && room(piece, result.to) >= 0.0L;
        way = result.to.way;
    };
    Two to{};
    Two way{};
    Two off{};
    rule.do_step(slope, from.at, from.way, 0.0L, to, way, s, off);
    const auto& [e, f, g] = from.metric;
    result.error = std::sqrt(
        std::max(e * off[0] * off[0] + 2.0L * f * off[0] * off[1] + g * off[1] * off[1], 0.0L));
    return result;
}

/// To the patch beyond the edge on which `p` is, and over which its way leads. False at a border.
bool ExactFlow::cross(Piece& piece, Place& p) const {
    SurfacePlace at{.i = piece.i, .j = piece.j, .surface = piece.surface};
    int edges = 0;
    SurfaceHeading heading;
    for (std::size_t k = 0; k < 2; ++k) {
        const long double range = piece.hi[k] - piece.lo[k];
        const long double share = (p.at[k] - piece.lo[k]) / range;
        double& t = k == 0 ? at.u : at.v;
        t = std::clamp(static_cast<double>(share), 0.0, 1.0);
        const bool low = share <= 2.0L * kOn;
        const bool high = share >= 1.0L - 2.0L * kOn;
        if (low || high) {
            t = low ? 0.0 : 1.0;
            if (p.way[k] * (high ? 1.0L : -1.0L) > 0.0L) {
                heading = {k == 0, high};
                ++edges;
            }
        }
    }
    if (edges != 1 || !object_->cross(at, heading)) {
        return false;
    }
    piece = piece_of(at);
    p = look(piece, {piece.lo[0] + at.u * (piece.hi[0] - piece.lo[0]),
                     piece.lo[1] + at.v * (piece.hi[1] - piece.lo[1])});
    return true;
}

FlowEnd ExactFlow::end(const SurfacePlace& from, const engine::Vec3& h, long double mu) const {
    h_ = {h.x, h.y, h.z};
    mu_ = mu;
    Piece piece = piece_of(from);
    Place p = look(piece, {piece.lo[0] + from.u * (piece.hi[0] - piece.lo[0]),
                           piece.lo[1] + from.v * (piece.hi[1] - piece.lo[1])});
    FlowEnd end;
    const auto ends = [&end, &p](FlowEnd::Kind kind) {
        end.kind = kind;
        end.point = p.point;
        end.load = p.load;
        return end;
    };
    /// On an edge, and the way leads over it.
    const auto led_off = [&piece](const Place& q) {
        for (std::size_t k = 0; k < 2; ++k) {
            const long double range = piece.hi[k] - piece.lo[k];
            if ((q.at[k] - piece.lo[k] <= 2.0L * kOn * range && q.way[k] < 0.0L) ||
                (piece.hi[k] - q.at[k] <= 2.0L * kOn * range && q.way[k] > 0.0L)) {
                return true;
            }
        }
        return false;
    };
    // However far a hand is, its way lies on the surface.
    const long double fine =
        kStepError * std::min(p.reach, static_cast<long double>(object_->size()));
    long double s = 0.05L * p.reach;
    int crossings = 0;
    for (int n = 0; n < kMaxSteps; ++n) {
        if (!p.regular) {
            return ends(FlowEnd::Kind::lost);
        }
        if (p.excess <= 0.0L) {
            return ends(FlowEnd::Kind::cone);
        }
        if (p.along < 1e-7L * p.reach) {
            return ends(FlowEnd::Kind::foot);
        }
        if (led_off(p)) {
            const Place before = p;
            if (!cross(piece, p)) {
                p = before;
                return ends(FlowEnd::Kind::edge);
            }
            if (p.regular && p.excess > 0.0L && led_off(p)) {
                return ends(FlowEnd::Kind::edge);
            }
            if (++crossings > 100) {
                return ends(FlowEnd::Kind::lost);
            }
            continue;
        }
        Step tried = step(piece, p, s);
        int halvings = 0;
        while (!tried.regular || tried.error > fine) {
            s *= tried.regular ? 0.5L : 0.2L;
            if (++halvings > 80) {
                return ends(FlowEnd::Kind::lost);
            }
            tried = step(piece, p, s);
        }
        // A stage within the cone, the end not: shorter, until they agree.
        while (tried.regular && !tried.clean && room(piece, tried.to) >= 0.0L &&
               s > 1e-9L * p.reach) {
            s *= 0.5L;
            tried = step(piece, p, s);
        }
        if (tried.regular && room(piece, tried.to) < 0.0L) {
            bool regular = true;
            const auto room_after = [&](long double way) {
                const Step there = step(piece, p, way);
                regular = regular && there.regular;
                return regular ? room(piece, there.to) : 0.0L;  // which ends the search
            };
            std::uintmax_t tries = 80;
            const long double whole =
                boost::math::tools::toms748_solve(
                    room_after, 0.0L, s, std::max(room(piece, p), 1e-15L), room(piece, tried.to),
                    boost::math::tools::eps_tolerance<long double>(), tries)
                    .second;
            if (!regular) {
                return ends(FlowEnd::Kind::lost);
            }
            p = step(piece, p, whole).to;
            end.way += whole;
            continue;  // within the cone, or on an edge
        }
        end.way += s;
        p = tried.to;
        const long double grow = 0.9L * std::pow(fine / (tried.error + 1e-300L), 0.2L);
        s *= std::clamp(grow, 0.3L, 3.0L);
    }
    return ends(FlowEnd::Kind::lost);
}

}  // namespace palpate::stress
