#include "tests/stress/surface_laws.hpp"

namespace palpate::stress {
namespace {

using namespace palpate::engine;
using namespace palpate::tests;

/// So is a foot where the distance has hardly a minimum.
constexpr double kSurfaceFootSlack = 200.0;

/// How far from the end of its flow a slide may end, of the size of the object.
constexpr double kFlowSlack = 1e-6;

/// The pieces of a knot vector that hold u: two on a knot.
std::vector<std::size_t> pieces_at(const std::vector<double>& t, double u) {
    std::vector<std::size_t> found;
    const double near = 1e-9 * (t.back() - t.front());
    for (std::size_t i = 0; i + 1 < t.size(); ++i) {
        if (t[i] < t[i + 1] && t[i] <= u + near && u - near <= t[i + 1]) {
            found.push_back(i);
        }
    }
    return found;
}

bool on_corner(const engine::SurfacePlace& p) {
    return (p.u == 0.0 || p.u == 1.0) && (p.v == 0.0 || p.v == 1.0);
}

}  // namespace

SurfaceLaws::SurfaceLaws(const engine::SurfaceScene& scene, const std::vector<SurfaceData>& data)
    : scene_(&scene), oracles_(data.begin(), data.end()) {
    for (const SurfaceData& piece : data) {
        for (const auto& row : piece.points) {
            for (const Vec3& p : row) {
                extent_ = std::max(extent_, largest(p));
            }
        }
    }
}

std::optional<Breach> SurfaceLaws::look(const Vec3& h,
                                        const SurfaceState& before,
                                        const SurfaceState& after,
                                        const SurfaceContact& contact) {
    breach_.reset();
    const Tick now{.h = h, .contact = contact};
    check_numbers(contact);
    if (!finite(h) || largest(h) > kFar) {
        check("a HIP that is not finite is refused without force", free(contact));
        started_ = ledger_ = false;
        ++ticks_;
        return breach_;
    }
    same_ = kSameLength * std::max({extent_, largest(h), started_ ? largest(last_.h) : 0.0});
    if (!free(contact)) {
        check_contact(now);
        check_walk(now, before, after);
        check_rest(now, before, after);
    }
    check_flow(now, before);
    const double k = scene_->spec().contact.stiffness;
    const bool springy = glm::length(contact.force - k * (contact.go - h)) <= k * same_;
    check_energy(last_, now, springy, k, k * same_ * std::max(extent_, largest(h)));
    started_ = true;
    last_ = now;
    ++ticks_;
    return breach_;
}

/// Where an edge of the surface, a fold between patches or a singular point may hold the
/// god-object.
bool SurfaceLaws::held_for_a_reason(const Tick& now) const {
    const SurfaceContact& c = now.contact;
    const auto& d = oracle(c).data();
    const auto near = [](const std::vector<double>& t, double u) {
        return std::any_of(t.begin(), t.end(), [&](double knot) {
            return std::fabs(u - knot) <= 1e-9 * (t.back() - t.front());
        });
    };
    if (near(d.knots_u, c.go_u) || near(d.knots_v, c.go_v)) {
        return true;
    }
    return singular(c) || step_bends(now);
}

/// Where the tangents are nearly one: Newton's step to the foot bends as much as it leads, so that
/// what is left along the surface is no measure of how far it is.
bool SurfaceLaws::step_bends(const Tick& now) const {
    const LongJet j = oracle(now.contact).jet(now.contact.go_u, now.contact.go_v);
    const Long3 r = j.s - Long3(now.h);
    const long double uu = glm::dot(j.su, j.su) + glm::dot(r, j.suu);
    const long double uv = glm::dot(j.su, j.sv) + glm::dot(r, j.suv);
    const long double vv = glm::dot(j.sv, j.sv) + glm::dot(r, j.svv);
    const long double a = glm::dot(r, j.su);
    const long double b = glm::dot(r, j.sv);
    const long double det = uu * vv - uv * uv;
    const long double du = (uv * b - vv * a) / det;
    const long double dv = (uv * a - uu * b) / det;
    const Long3 leads = du * j.su + dv * j.sv;
    const Long3 bends = 0.5L * du * du * j.suu + du * dv * j.suv + 0.5L * dv * dv * j.svv;
    return length(bends) >= 0.1 * length(leads);
}

/// Where the tangents vanish, or are one, the normal is a limit and hangs on rounding.
bool SurfaceLaws::singular(const SurfaceContact& c) const {
    const LongJet jet = oracle(c).jet(c.go_u, c.go_v);
    const double a = length(jet.su);
    const double b = length(jet.sv);
    const double area = length(glm::cross(jet.su, jet.sv));
    const double size = scene_->object().size();
    return a < 1e-4 * size || b < 1e-4 * size || area < 1e-3 * a * b;
}

void SurfaceLaws::check_contact(const Tick& now) {
    const SurfaceContact& c = now.contact;
    const double k = scene_->spec().contact.stiffness;
    check("the normal is a unit vector", std::fabs(glm::length(c.normal) - 1.0), 1e-12);
    const double fn = glm::dot(c.force, c.normal);
    const double ft = glm::length(c.force - fn * c.normal);
    check("fn is the part of the force along the normal", std::fabs(c.normal_force - fn),
          k * same_ + 1e-12 * glm::length(c.force));
    check("ft is the rest", std::fabs(c.tangential_force - ft),
          k * same_ + 1e-12 * glm::length(c.force));
    double off = 1e300;
    double turned = 1e300;
    long double carried = 0.0L;
    bool regular = true;
    const auto& d = oracle(c).data();
    for (const std::size_t pu : pieces_at(d.knots_u, c.go_u)) {
        for (const std::size_t pv : pieces_at(d.knots_v, c.go_v)) {
            const LongJet jet = oracle(c).jet(pu, pv, c.go_u, c.go_v);
            // The last bits of u and v are worth most where heavy control points pull.
            const double bits =
                4e-16 * (length(jet.su) * d.knots_u.back() + length(jet.sv) * d.knots_v.back());
            off = std::min(off, length(jet.s - Long3(c.go)) - bits);
            const Long3 area = glm::cross(jet.su, jet.sv);
            const double across = length(area);
            const double a = length(jet.su);
            const double b = length(jet.sv);
            const double size = scene_->object().size();
            regular = regular && across > 1e-3 * a * b && a > 1e-3 * size && b > 1e-3 * size;
            const Long3 side = (1.0L / across) * area;
            turned = std::min(turned, length(side - Long3(c.normal)));
            carried = std::max(carried, glm::dot(Long3(c.force), side));
        }
    }
    // Rounding turns the normal, by as much as the exact one shows here, and some times that beside
    // it.
    const double loose =
        (singular(c) ? 1e-8 : std::min(8.0 * turned, 1e-8)) * glm::length(c.go - now.h);
    const bool springy =
        glm::length(c.force - k * (c.go - now.h)) <= k * (kSurfaceFootSlack * same_ + loose);
    check("the force is K (GO - HIP)", springy || c.outside_cone);
    check("what is held is on an edge or a singular point",
          !c.outside_cone || !c.settled || held_for_a_reason(now));
    const double cone = c.mu * c.normal_force * (1.0 + 1e-9) + k * (kConeSlack * same_ + loose);
    check("friction stays in its cone", springy && c.outside_cone ? 0.0 : ft, cone);
    if (scene_->spec().contact.friction.none()) {
        check("without friction there is none", springy && c.outside_cone ? 0.0 : ft,
              1e-9 * fn + kConeSlack * k * same_);
    }
    check("the god-object is on the surface", off, 10.0 * same_);
    check("the normal is that of the surface", regular && !c.in_crease ? turned : 0.0, 1e-6);
    check("in a crease no side's normal is nearer to the force",
          regular && c.in_crease ? static_cast<double>(carried) - fn : 0.0,
          k * kSurfaceFootSlack * same_ + 1e-9 * glm::length(c.force));
}

void SurfaceLaws::check_walk(const Tick& now,
                             const SurfaceState& before,
                             const SurfaceState& after) {
    const SurfaceContact& c = now.contact;
    const double stretch = glm::length(c.go - now.h);
    check("nothing is closer than a proven closest point",
          c.cp.proven ? c.cp.distance - stretch : 0.0, same_);
    if (!before.touching || !started_ || free(last_.contact)) {
        check("a contact begins no further than the closest point", stretch, c.cp.distance + same_);
        return;
    }
    const SurfaceContact& l = last_.contact;
    check("the walk never stretches the spring", stretch, glm::length(l.go - now.h) + same_);
    const double way = glm::length(c.go - l.go);
    if (c.mode == Mode::stuck) {
        check("a stuck god-object does not move", way, same_);
    }
    const Vec3 r = now.h - l.go;
    const double load = -glm::dot(r, l.normal);
    const double along = glm::length(r + load * l.normal);
    if (along < c.mu * load * (1.0 - 1e-9) - kConeSlack * same_) {
        check("inside its cone the god-object stays", way, same_);
    }
    const bool same_patch = before.place.surface == after.place.surface &&
                            before.place.i == after.place.i && before.place.j == after.place.j;
    if (same_patch && c.mode != Mode::stuck && !c.outside_cone && c.settled &&
        !held_for_a_reason(now)) {
        const double k = scene_->spec().contact.stiffness;
        check("a slip ends on the edge of the cone", c.mu * c.normal_force,
              c.tangential_force + 1e3 * k * same_);
    }
}

/// A slide ends at the first place of its flow within the cone. Where a coefficient that differs by
/// 1e-9, or a hand by rounding, leads elsewhere, or the flow has no end that doubles can tell,
/// nothing is asked for.
void SurfaceLaws::check_flow(const Tick& now, const SurfaceState& before) {
    const SurfaceContact& c = now.contact;
    const engine::Friction& friction = scene_->spec().contact.friction;
    const double mu = engine::coefficient(friction, before.theta);
    if (!before.touching || !started_ || free(last_.contact) || !(mu > 0.0) || !c.on_flow ||
        !c.settled || c.outside_cone || !scene_->spec().contact.slew.none() ||
        singular(last_.contact) ||  // which side it begins on hangs on rounding
        on_corner(before.place)) {  // the oracle goes on in the patch it came by alone
        return;
    }
    const ExactFlow flow(scene_->object(), oracles_);
    const FlowEnd end = flow.end(before.place, now.h, mu);
    if (end.kind != FlowEnd::Kind::cone || (end.load <= 0.0L && free(c))) {
        return;
    }
    ++walks;
    const double limit = kFlowSlack * scene_->object().size() + 10.0 * same_;
    const auto off = [&c, limit](const FlowEnd& e) {
        return free(c) ? (e.load > 0.0L ? 2.0 * limit : 0.0) : length(e.point - Long3(c.go));
    };
    if (off(end) <= limit) {
        return;
    }
    std::vector<FlowEnd> others;
    for (const long double by : {-1e-9L, 1e-9L, -1e-7L, 1e-7L}) {
        others.push_back(flow.end(before.place, now.h, mu * (1.0L + by)));
    }
    for (int k = 0; k < 3; ++k) {
        for (const double by : {-same_, same_}) {
            Vec3 moved = now.h;
            moved[k] += by;
            others.push_back(flow.end(before.place, moved, mu));
        }
    }
    for (const FlowEnd& other : others) {
        if (other.kind != end.kind || length(other.point - Long3(c.go)) <= limit ||
            length(other.point - end.point) > limit) {
            ++ties;
            return;
        }
    }
    check(free(c) ? "a slide with a place in its cone ahead does not end the contact"
                  : "a slide ends at the first place of its flow in the cone",
          off(end), limit);
}

/// m to which last bits of the hand, and of u and v where heavy control points pull, leave the foot
/// open: it moves by 1 / least of what the hand does, far where that is at a centre of curvature.
double SurfaceLaws::foot_open(const Tick& now) const {
    const auto& d = oracle(now.contact).data();
    const LongJet j = oracle(now.contact).jet(now.contact.go_u, now.contact.go_v);
    const Long3 r = j.s - Long3(now.h);
    const long double e = glm::dot(j.su, j.su);
    const long double f = glm::dot(j.su, j.sv);
    const long double g = glm::dot(j.sv, j.sv);
    const long double uu = e + glm::dot(r, j.suu);
    const long double uv = f + glm::dot(r, j.suv);
    const long double vv = g + glm::dot(r, j.svv);
    const long double half = 0.5L * (uu * g - 2.0L * uv * f + vv * e) / (e * g - f * f);
    const long double product = (uu * vv - uv * uv) / (e * g - f * f);
    const long double least = half - std::sqrt(std::fmax(half * half - product, 0.0L));
    const double bits = 4e-16 * (length(j.su) * d.knots_u.back() + length(j.sv) * d.knots_v.back());
    const double share = std::isfinite(least) ? static_cast<double>(std::fabs(least)) : 0.0;
    return (same_ + bits) / std::clamp(share, 1e-4, 1.0);
}

/// With the same coefficient the same HIP finds the contact stuck, and the same force.
void SurfaceLaws::check_rest(const Tick& now,
                             const SurfaceState& before,
                             const SurfaceState& after) {
    if (!now.contact.settled || (now.contact.outside_cone && singular(now.contact))) {
        return;  // it goes on; where a sheet folds back its two sides are inside out
    }
    SurfaceState again = after;
    again.theta = before.touching ? before.theta : 1.0;
    const SurfaceContact c = scene_->tick(again, now.h);
    const double k = scene_->spec().contact.stiffness;
    const double limit = 20.0 * foot_open(now);
    if (!scene_->spec()
             .contact.friction.none()) {  // where the distance has hardly a minimum it may
        check("at rest the god-object rests", glm::length(c.go - now.contact.go), limit);
    }
    check("at rest the force rests", glm::length(c.force - now.contact.force), k * limit);
}

}  // namespace palpate::stress
