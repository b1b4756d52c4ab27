#include "engine/rendering/surface_scene.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "engine/math/number_text.hpp"

namespace palpate::engine {
namespace {

/// mu counts as relaxed once theta is below this: 1e-3 of mu_s - mu_d is 0.2 mN at 1 N.
constexpr double kRelaxed = 1e-3;

void require(bool ok, const char* what, double value, const char* remedy) {
    if (!ok) {
        throw std::invalid_argument(std::string(what) + " is " + number_text(value) + ": " +
                                    remedy);
    }
}

const SurfaceSceneSpec& checked(const SurfaceSceneSpec& whole) {
    const SceneSpec& spec = whole.contact;
    const auto from_zero = [](double v) {
        return std::isfinite(v) && v >= 0.0;
    };
    require(std::isfinite(spec.stiffness) && spec.stiffness > 0.0, "stiffness", spec.stiffness,
            "give N/m above 0");
    require(std::isfinite(spec.period) && spec.period > 0.0, "tick period", spec.period,
            "give seconds above 0");
    require(from_zero(spec.friction.mu_d), "mu_d", spec.friction.mu_d, "give 0 or more");
    require(std::isfinite(spec.friction.mu_s) && spec.friction.mu_s >= spec.friction.mu_d, "mu_s",
            spec.friction.mu_s, "give a finite value not below mu_d");
    require(from_zero(spec.friction.tau_slip), "tau_slip", spec.friction.tau_slip,
            "give seconds, 0 for a sharp drop");
    require(from_zero(spec.friction.tau_heal), "tau_heal", spec.friction.tau_heal,
            "give seconds, 0 for healing at once");
    require(spec.slew.none(), "vertex slew", spec.slew.speed,
            "give 0 with a surface: it has no vertices");
    return whole;
}

/// A place that can be rendered: finite, and small enough for squares of squares.
bool usable(const Vec3& hip) noexcept {
    for (int k = 0; k < 3; ++k) {
        if (!(std::fabs(hip[k]) <= kMaxCoordinate)) {
            return false;
        }
    }
    return true;
}

/// Different places, by more than the last bits of a foot.
bool apart(const SurfacePlace& a, const SurfacePlace& b) noexcept {
    return a.i != b.i || a.j != b.j || std::fabs(a.u - b.u) + std::fabs(a.v - b.v) > 1e-12;
}

}  // namespace

SurfaceScene::SurfaceScene(std::shared_ptr<const NurbsSurface> surface,
                           const SurfaceSceneSpec& spec)
    : feet_(std::move(surface)),
      spec_(checked(spec)),
      decay_(stribeck_decay(spec.contact.friction, spec.contact.period)),
      step_(spec.contact.friction.none() ? &SurfaceScene::step<false> : &SurfaceScene::step<true>) {
}

/// No contact: the closest point stands for the GO.
SurfaceContact SurfaceScene::free(SurfaceState& state, const Vec3& hip) const noexcept {
    state.touching = false;
    state.theta = 1.0;
    const SurfaceClosest& cp = state.seen;
    state.clear_at = hip;
    // One part in 1e12 less than the distance: rounding never hides a contact.
    const double clear = cp.distance * (1.0 - 1e-12);
    state.clear2 = spec_.skip_far && !cp.inside ? clear * clear : 0.0;
    return {.cp = cp, .go_u = cp.u, .go_v = cp.v, .go = cp.point};
}

template <bool HasFriction>
SurfaceContact SurfaceScene::step(SurfaceState& state, const Vec3& hip) const noexcept {
    const Vec3 moved = hip - state.clear_at;
    if (glm::dot(moved, moved) < state.clear2) {  // false for NaN; clear2 is 0 while touching
        ++state.skipped;
        SurfaceContact contact{.cp = state.seen,
                               .go_u = state.seen.u,
                               .go_v = state.seen.v,
                               .go = state.seen.point,
                               .skipped = true};
        contact.cp.distance -= glm::length(moved);
        return contact;
    }
    state.clear2 = 0.0;
    if (!usable(hip)) {
        state.touching = false;
        state.theta = 1.0;
        return {.refused = true};
    }
    state.seen = feet_.track(state.track, hip);
    if (!state.touching) {
        if (!state.seen.inside) {
            return free(state, hip);
        }
        state.touching = true;
        state.theta = 1.0;
        state.place = state.seen.place;
    }
    const Friction& friction = spec_.contact.friction;
    const double mu = HasFriction ? coefficient(friction, state.theta) : 0.0;
    const Vec3 h = hip - surface().origin();
    // Without friction the GO is the local foot: mostly the closest point, already found.
    const bool known = !HasFriction && feet_.same_bowl(state.track, state.place);
    const SurfacePlace from = known ? state.seen.place : state.place;
    const SurfaceSlide slide = slide_on_surface<HasFriction>(surface(), from, h, mu);
    const bool slipped = slide.slid > 0.0 || (known && apart(state.place, from));
    state.place = slide.place;
    if (!(slide.load > 0.0)) {
        return free(state, hip);
    }
    SurfaceContact contact = render(slide, h, mu);
    contact.cp = state.seen;
    contact.mode = !slipped ? Mode::stuck
                 : HasFriction && state.theta > kRelaxed && friction.mu_s > friction.mu_d
                     ? Mode::transition
                     : Mode::slip;
    if constexpr (HasFriction) {
        state.theta = next_theta(state.theta, slipped, decay_);
    }
    return contact;
}

SurfaceContact SurfaceScene::render(const SurfaceSlide& slide,
                                    const Vec3& h,
                                    double mu) const noexcept {
    const double k = spec_.contact.stiffness;
    SurfaceContact contact{.go_u = surface().u_of(slide.place),
                           .go_v = surface().v_of(slide.place),
                           .go = slide.point + surface().origin(),
                           .normal = slide.normal,
                           .normal_force = k * slide.load,
                           .mu = mu,
                           .held = slide.held_outside};
    const double cone = mu * slide.load;
    if (slide.held_outside && !slide.in_crease && slide.length > cone) {
        const double share = cone / slide.length;
        contact.force = k * (slide.load * slide.normal - share * slide.tangential);
        contact.tangential_force = k * cone;
        return contact;
    }
    contact.force = k * (slide.point - h);
    contact.tangential_force = k * slide.length;
    return contact;
}

void SurfaceScene::set_period(double period) {
    if (!(period > 0.0) || !std::isfinite(period)) {
        throw std::invalid_argument("tick period is " + number_text(period) +
                                    ": give seconds above 0");
    }
    spec_.contact.period = period;
    decay_ = stribeck_decay(spec_.contact.friction, period);
}

}  // namespace palpate::engine
