#include "tests/figures/thesis/surface_tracker.hpp"

#include "engine/base/text.hpp"

namespace palpate::figures {
namespace {

using namespace palpate::engine;

constexpr int kSamples = 16;  // a surface and direction, to begin with
constexpr double kMin = 0.2;  // of the metric: what a Newton step may divide by, as for a curve
constexpr int kMaxSubSteps = 1000;
constexpr int kMaxIterations = 100;

bool finite(const Vec3& v) noexcept {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

double sample(const KnotVector& knots, int k) noexcept {
    return knots.front() + (knots.back() - knots.front()) * k / kSamples;
}

bool at_border(const KnotVector& knots, double t) noexcept {
    return t == knots.front() || t == knots.back();
}

/// The way into the surface from a border.
double inwards(const KnotVector& knots, double t) noexcept {
    return t == knots.front() ? 1.0 : -1.0;
}

}  // namespace

/// First and second derivatives of |S - h|^2 / 2, and the metric.
struct SurfaceTracker::Slopes {
    double u;
    double v;
    double e;
    double f;
    double g;
    double uu;
    double uv;
    double vv;

    Slopes(const SurfaceJet& j, const Vec3& h)
        : u(glm::dot(j.point - h, j.du)),
          v(glm::dot(j.point - h, j.dv)),
          e(glm::dot(j.du, j.du)),
          f(glm::dot(j.du, j.dv)),
          g(glm::dot(j.dv, j.dv)),
          uu(std::max(e + glm::dot(j.point - h, j.duu), kMin * e)),
          uv(f + glm::dot(j.point - h, j.duv)),
          vv(std::max(g + glm::dot(j.point - h, j.dvv), kMin * g)) {}
};

SurfaceTracker::SurfaceTracker(std::shared_ptr<const SurfaceObject> object, const TrackerSpec& spec)
    : object_(std::move(object)), spec_(spec) {
    if (!object_) {
        throw std::invalid_argument("the object is null: give one of surfaces");
    }
    if (spec.kind == TrackerKind::tangent_plane || spec.kind == TrackerKind::feedback_linearised) {
        throw std::invalid_argument("a surface has no tracker " +
                                    std::string(to_string(spec.kind)) +
                                    ": give feedback, feed_forward or newton");
    }
    if (spec.kind == TrackerKind::newton) {
        if (spec.iterations < 1 || spec.iterations > kMaxIterations) {
            throw std::invalid_argument("iterations is " + std::to_string(spec.iterations) +
                                        ": give 1 to " + std::to_string(kMaxIterations));
        }
        return;
    }
    if (!(std::isfinite(spec.gain) && spec.gain > 0.0)) {
        throw std::invalid_argument("gain is " + number_text(spec.gain) +
                                    ": give a number above 0");
    }
    if (spec.sub_steps < 1 || spec.sub_steps > kMaxSubSteps) {
        throw std::invalid_argument("sub_steps is " + std::to_string(spec.sub_steps) +
                                    ": give 1 to " + std::to_string(kMaxSubSteps));
    }
}

SurfaceTrackerState SurfaceTracker::start(const Vec3& hip) const noexcept {
    SurfaceTrackerState best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < object_->count(); ++k) {
        const NurbsSurface& s = object_->surface(k);
        for (int i = 0; i <= kSamples; ++i) {
            for (int j = 0; j <= kSamples; ++j) {
                const double u = sample(s.knots_u(), i);
                const double v = sample(s.knots_v(), j);
                const double distance = glm::length(s.at(u, v).point - hip);
                if (distance < least) {
                    least = distance;
                    best.surface = k;
                    best.u = u;
                    best.v = v;
                }
            }
        }
    }
    return best;
}

SurfacePlace SurfaceTracker::place_of(const SurfaceTrackerState& s) const noexcept {
    SurfacePlace p = object_->surface(s.surface).place_of(s.u, s.v);
    p.surface = s.surface;
    return p;
}

void SurfaceTracker::move_to(SurfaceTrackerState& s, const SurfacePlace& p) const noexcept {
    s.surface = p.surface;
    s.u = object_->u_of(p);
    s.v = object_->v_of(p);
}

/// The controller of the active feature: (u, v) of a face, one of them on an edge, none in a
/// corner.
void SurfaceTracker::control(SurfaceTrackerState& s,
                             const Vec3& h,
                             const Vec3& speed,
                             double dt) const noexcept {
    if (s.feature == SurfaceFeature::corner) {
        return;
    }
    const NurbsSurface& surface = object_->surface(s.surface);
    const SurfaceJet jet = surface.at(s.u, s.v);
    const Slopes d(jet, h);
    const bool face = s.feature == SurfaceFeature::face;
    double du = -spec_.gain * dt * d.u;
    double dv = -spec_.gain * dt * d.v;
    if (spec_.kind == TrackerKind::newton) {
        const double det = d.uu * d.vv - d.uv * d.uv;
        const bool bowl = face && det > kMin * kMin * d.e * d.g;
        du = bowl ? (d.uv * d.v - d.vv * d.u) / det : -d.u / d.uu;
        dv = bowl ? (d.uv * d.u - d.uu * d.v) / det : -d.v / d.vv;
    } else if (spec_.kind == TrackerKind::feed_forward) {
        const double a = glm::dot(jet.du, speed);
        const double b = glm::dot(jet.dv, speed);
        const double det = d.e * d.g - d.f * d.f;
        if (face && det > 0.0) {
            du += dt * (d.g * a - d.f * b) / det;
            dv += dt * (d.e * b - d.f * a) / det;
        } else if (!face) {
            du += d.e > 0.0 ? dt * a / d.e : 0.0;
            dv += d.g > 0.0 ? dt * b / d.g : 0.0;
        }
    }
    const KnotVector& ku = surface.knots_u();
    const KnotVector& kv = surface.knots_v();
    const auto within = [](double t, const KnotVector& knots) {
        return std::clamp(t, knots.front(), knots.back());
    };
    if (std::isfinite(du) && (face || !s.edge_in_u)) {
        s.u = within(s.u + du, ku);
    }
    if (std::isfinite(dv) && (face || s.edge_in_u)) {
        s.v = within(s.v + dv, kv);
    }
}

void SurfaceTracker::change_feature(SurfaceTrackerState& s, const Vec3& h) const noexcept {
    const SurfaceTrackerState before = s;
    switch (s.feature) {
        case SurfaceFeature::face:
            leave_face(s, h);
            break;
        case SurfaceFeature::edge:
            leave_edge(s, h);
            break;
        case SurfaceFeature::corner:
            leave_corner(s, h);
            break;
    }
    s.switches += s.feature != before.feature || s.surface != before.surface ? 1U : 0U;
}

/// On a border that its controller pushes against.
void SurfaceTracker::leave_face(SurfaceTrackerState& s, const Vec3& h) const noexcept {
    const NurbsSurface& surface = object_->surface(s.surface);
    const SurfaceJet jet = surface.at(s.u, s.v);
    const auto out = [&](const KnotVector& knots, double t, const Vec3& along) {
        return at_border(knots, t) && inwards(knots, t) * glm::dot(h - jet.point, along) < 0.0;
    };
    const bool over_u = out(surface.knots_u(), s.u, jet.du);
    const bool over_v = out(surface.knots_v(), s.v, jet.dv);
    if (over_u || over_v) {
        s.feature = over_u && over_v ? SurfaceFeature::corner : SurfaceFeature::edge;
        s.edge_in_u = over_u;
    }
}

/// Into its own face, the one beyond, or the corner at its end.
void SurfaceTracker::leave_edge(SurfaceTrackerState& s, const Vec3& h) const noexcept {
    const NurbsSurface& surface = object_->surface(s.surface);
    const SurfaceJet jet = surface.at(s.u, s.v);
    const Vec3 r = h - jet.point;
    const KnotVector& across = s.edge_in_u ? surface.knots_u() : surface.knots_v();
    const double side = inwards(across, s.edge_in_u ? s.u : s.v);
    if (side * glm::dot(r, s.edge_in_u ? jet.du : jet.dv) > 0.0) {
        s.feature = SurfaceFeature::face;
        return;
    }
    SurfacePlace p = place_of(s);
    SurfaceHeading way{s.edge_in_u, side < 0.0};
    if (object_->cross(p, way)) {
        const SurfaceJet beyond = object_->local_jet(p);
        const Vec3& into = way.in_u ? beyond.du : beyond.dv;
        if ((way.forward ? 1.0 : -1.0) * glm::dot(r, into) > 0.0) {
            move_to(s, p);
            s.feature = SurfaceFeature::face;
            return;
        }
    }
    const KnotVector& along = s.edge_in_u ? surface.knots_v() : surface.knots_u();
    const double t = s.edge_in_u ? s.v : s.u;
    if (at_border(along, t) &&
        inwards(along, t) * glm::dot(r, s.edge_in_u ? jet.dv : jet.du) < 0.0) {
        s.feature = SurfaceFeature::corner;
    }
}

/// Along the edge, or into the face, on whose side HIP lies most.
void SurfaceTracker::leave_corner(SurfaceTrackerState& s, const Vec3& h) const noexcept {
    const SurfaceObject::Around all = object_->around(place_of(s));
    double max = 0.0;
    for (std::size_t k = 0; k < all.count; ++k) {
        const SurfacePlace& p = all.places[k];
        const SurfaceJet jet = object_->local_jet(p);
        const Vec3 r = h - (jet.point + object_->origin());
        const auto along = [&r](double at, const Vec3& edge) {
            const double length = glm::length(edge);
            const double by = glm::dot(r, edge) * (at == 0.0 ? 1.0 : -1.0);
            return (at == 0.0 || at == 1.0) && length > 0.0 ? by / length : 0.0;
        };
        const double by_u = along(p.u, jet.du);
        const double by_v = along(p.v, jet.dv);
        if (std::max(by_u, by_v) > max) {
            max = std::max(by_u, by_v);
            move_to(s, p);
            s.feature = by_u > 0.0 && by_v > 0.0 ? SurfaceFeature::face : SurfaceFeature::edge;
            s.edge_in_u = by_v > by_u;
        }
    }
}

TrackedSpot SurfaceTracker::step(SurfaceTrackerState& state,
                                 const Vec3& hip,
                                 double dt) const noexcept {
    if (finite(hip) && std::isfinite(dt)) {
        const bool newton = spec_.kind == TrackerKind::newton;
        const int steps = newton ? spec_.iterations : spec_.sub_steps;
        const Vec3 from = state.moving ? state.last_hip : hip;
        const Vec3 speed = dt > 0.0 ? (hip - from) / dt : Vec3{};
        for (int k = 0; k < steps; ++k) {
            // With feed-forward the velocity carries the point over from where HIP was.
            const double share =
                static_cast<double>(spec_.kind == TrackerKind::feed_forward ? k : k + 1) / steps;
            const Vec3 h = newton ? hip : from + share * (hip - from);
            control(state, h, speed, dt / steps);
            change_feature(state, h);
        }
        state.last_hip = hip;
        state.moving = true;
    }
    const NurbsSurface& surface = object_->surface(state.surface);
    TrackedSpot spot{.point = surface.at(state.u, state.v).point,
                     .normal = surface.normal(state.u, state.v)};
    const Vec3 r = state.last_hip - spot.point;
    spot.distance = glm::length(r);
    spot.psi = glm::length(r - glm::dot(r, spot.normal) * spot.normal);
    return spot;
}

double feedback_gain(const SurfaceObject& object, double kappa, double period) {
    if (!(std::isfinite(kappa) && kappa > 0.0 && std::isfinite(period) && period > 0.0)) {
        throw std::invalid_argument("kappa " + number_text(kappa) + " and period " +
                                    number_text(period) + ": give both finite and above 0");
    }
    double max = 0.0;
    for (std::size_t k = 0; k < object.count(); ++k) {
        const NurbsSurface& s = object.surface(k);
        for (int i = 0; i <= kSamples; ++i) {
            for (int j = 0; j <= kSamples; ++j) {
                const SurfaceJet jet = s.at(sample(s.knots_u(), i), sample(s.knots_v(), j));
                const double e = glm::dot(jet.du, jet.du);
                const double f = glm::dot(jet.du, jet.dv);
                const double g = glm::dot(jet.dv, jet.dv);
                const double skew = 0.5 * (e - g);
                max = std::max(max, 0.5 * (e + g) + std::sqrt(skew * skew + f * f));
            }
        }
    }
    if (!(max > 0.0)) {
        throw std::invalid_argument("the object has no area: give one that has");
    }
    return kappa / (max * period);
}

}  // namespace palpate::figures
