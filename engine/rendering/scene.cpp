#include "engine/rendering/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/friction/walk_at_once.hpp"

namespace palpate::engine {
namespace {

/// The foot of h is as sharp as doubles can tell it: h is not near the centre of curvature.
bool is_sharp(const Jet<2>& jet, const Vec2& h) noexcept {
    const double speed2 = glm::dot(jet.first, jet.first);
    return speed2 + glm::dot(jet.point - h, jet.second) > 0.1 * speed2;
}

/// What the walk of the god-object gives: with a law of friction of its own none.
SceneSpec felt_by_walk(SceneSpec spec) noexcept {
    if (spec.law.traits != nullptr) {
        spec.friction = {};
    }
    return spec;
}

}  // namespace

const SceneSpec& checked(const SceneSpec& spec) {
    const auto finite_from_zero = [](double v) {
        return std::isfinite(v) && v >= 0.0;
    };
    require(std::isfinite(spec.stiffness) && spec.stiffness > 0.0, "stiffness", spec.stiffness,
            "give N/m above 0");
    require(finite_from_zero(spec.damping), "damping", spec.damping, "give N s/m, 0 for none");
    require(std::isfinite(spec.period) && spec.period > 0.0, "tick period", spec.period,
            "give seconds above 0");
    require(finite_from_zero(spec.friction.mu_d), "mu_d", spec.friction.mu_d, "give 0 or more");
    require(std::isfinite(spec.friction.mu_s) && spec.friction.mu_s >= spec.friction.mu_d, "mu_s",
            spec.friction.mu_s, "give a finite value not below mu_d");
    require(finite_from_zero(spec.friction.tau_slip), "tau_slip", spec.friction.tau_slip,
            "give seconds, 0 for a sharp drop");
    require(finite_from_zero(spec.friction.tau_heal), "tau_heal", spec.friction.tau_heal,
            "give seconds, 0 for healing at once");
    require(finite_from_zero(spec.slew.speed), "vertex slew", spec.slew.speed,
            "give m/s, 0 for none");
    require(spec.slew.none() || (std::isfinite(spec.slew.radius) && spec.slew.radius > 0.0),
            "vertex radius", spec.slew.radius, "give m above 0 when there is a vertex slew");
    require(finite_from_zero(spec.compliance), "compliance", spec.compliance,
            "give m/N, 0 for a rigid object");
    const bool soft = spec.compliance > 0.0;
    require(!soft || spec.damping == 0.0, "damping", spec.damping,
            "give 0 N s/m with a compliance: the object has a damping of its own");
    require(!soft || spec.slew.none(), "vertex slew", spec.slew.speed,
            "give 0 m/s with a compliance: the vertex yields");
    refuse_if(soft && spec.law.traits != nullptr,
              "an object with a compliance takes friction \"frictionless\", \"gos\" or "
              "\"coulomb\": give one of them, or leave the compliance out");
    return spec;
}

Scene::Scene(std::shared_ptr<const Outline> outline, const SceneSpec& spec)
    : outline_(std::move(outline)),
      spec_(checked(spec)),
      tracker_(*outline_),
      forms_(*outline_, tracker_.feet().tree().pieces(), felt_by_walk(spec).friction.mu_s),
      decay_(stribeck_decay(spec.friction, spec.period)),
      step_(step_for(felt_by_walk(spec))) {
    add_law();
    add_softness();
}

Scene::Step Scene::step_for(const SceneSpec& spec) const noexcept {
    const auto chosen = [&spec]<bool F, bool S>() {
        return spec.damping > 0.0 ? &Scene::step<F, S, true> : &Scene::step<F, S, false>;
    };
    if (spec.friction.none()) {
        return spec.slew.none() ? chosen.operator()<false, false>()
                                : chosen.operator()<false, true>();
    }
    return spec.slew.none() ? chosen.operator()<true, false>() : chosen.operator()<true, true>();
}

void Scene::set_period(double period) {
    spec_.period = period;
    static_cast<void>(checked(spec_));
    decay_ = stribeck_decay(spec_.friction, period);
    add_law();
    add_softness();
}

/// Out of contact: how far HIP may go before the next look.
Contact Scene::free(ContactState& state, const ClosestPoint& cp) const noexcept {
    state.touching = false;
    state.theta = 1.0;
    state.last_spring = Vec2{};
    state.clear_from = state.last_hip;
    const Vec2& h = state.last_hip;
    const double rounding = 4.0 * kEpsilon * (std::fabs(h.x) + std::fabs(h.y));
    const double clear = cp.inside ? 0.0 : std::max(cp.distance * kClearShare - rounding, 0.0);
    state.approach.stay(cp.inside ? cp.distance : 0.0);
    state.clear2 = clear * clear;
    state.away = {.place = cp.place, .go = cp.point, .skipped = true};
    Contact contact = state.away;
    contact.skipped = false;
    return contact;
}

template <bool HasFriction, bool HasSlew, bool HasDamper>
Contact Scene::step(ContactState& state, const Vec2& hip) const noexcept {
    if (state.touching && !state.go.place.on_seam) {
        const RationalBezier<2>* cubic = forms_.cubic(state.go.place.index);
        if (cubic == nullptr) {
            return arc_step<HasFriction, HasSlew, HasDamper>(state, hip);
        }
        const double mu = HasFriction ? coefficient(spec_.friction, state.theta) : 0.0;
        Walk walk;
        if (walk_at_once<HasFriction, HasSlew>(Cubic{*cubic}, state.go, hip, mu,
                                               budget<HasSlew>(state, hip), walk)) {
            state.last_hip = hip;
            return felt<HasFriction, HasDamper>(state, walk, hip, mu);
        }
    }
    return long_step<HasFriction, HasSlew, HasDamper>(state, hip);
}

template <bool HasFriction, bool HasSlew, bool HasDamper>
[[gnu::noinline]] Contact Scene::arc_step(ContactState& state, const Vec2& hip) const noexcept {
    if (const Arc* arc = forms_.arc(state.go.place.index)) {
        const double mu = HasFriction ? coefficient(spec_.friction, state.theta) : 0.0;
        Walk walk;
        if (walk_at_once<HasFriction, HasSlew>(*arc, state.go, hip, mu, budget<HasSlew>(state, hip),
                                               walk)) {
            state.last_hip = hip;
            return felt<HasFriction, HasDamper>(state, walk, hip, mu);
        }
    }
    return long_step<HasFriction, HasSlew, HasDamper>(state, hip);
}

/// Travel allowed in this tick, m.
template <bool HasSlew>
double Scene::budget(const ContactState& state, const Vec2& hip) const noexcept {
    if constexpr (HasSlew) {
        const double travelled = state.started ? glm::length(hip - state.last_hip) : 0.0;
        return 2.0 * travelled + spec_.slew.speed * spec_.period;
    }
    return std::numeric_limits<double>::infinity();
}

template <bool HasFriction, bool HasSlew, bool HasDamper>
[[gnu::noinline]] Contact Scene::long_step(ContactState& state, const Vec2& hip) const noexcept {
    state.clear2 = 0.0;
    if (!std::isfinite(hip.x) || !std::isfinite(hip.y)) {
        state.touching = false;
        state.theta = 1.0;
        state.last_spring = Vec2{};
        state.approach = {};
        return {.refused = true};
    }
    const double way = budget<HasSlew>(state, hip);
    const Vec2 from = state.last_hip;
    state.started = true;
    state.last_hip = hip;
    if (!state.touching) {
        return look<HasFriction, HasDamper>(state, from);
    }
    const double mu = HasFriction ? coefficient(spec_.friction, state.theta) : 0.0;
    Walk walk;
    if (!walk_on_span<HasFriction>(forms_, state.go, hip, mu, way, walk)) {
        walk = walk_god_object<HasFriction>(forms_, state.go, HasSlew ? from : hip, hip, mu, way,
                                            HasSlew ? spec_.slew.radius : 0.0);
    }
    const bool ends = walk.nu <= 0.0 && !walk.out_of_budget;
    if (outline_->closed() && (ends || walk.lost_beyond)) {
        // Past a thin spike HIP may be in the object still, and is felt there at once.
        const ContactState held = state;
        state.touching = false;
        const Contact contact = look<HasFriction, HasDamper>(state, from);
        if (ends || state.touching) {
            return contact;
        }
        state = held;
    }
    if (ends) {
        return free(state, tracker_.track(state.track, hip));
    }
    return felt<HasFriction, HasDamper>(state, walk, hip, mu);
}

/// A closed outline has no way round.
bool Scene::enters(ContactState& state, const ClosestPoint& cp, const Vec2& from) const noexcept {
    const Vec2& hip = state.last_hip;
    const double size = std::fabs(hip.x) + std::fabs(hip.y);
    return outline_->closed() || state.approach.enters(cp.distance, glm::length(hip - from),
                                                       rounding_of(cp.distance, size));
}

/// Without a contact so far: does one begin?
template <bool HasFriction, bool HasDamper>
Contact Scene::look(ContactState& state, const Vec2& from) const noexcept {
    const Vec2 hip = state.last_hip;
    state.theta = 1.0;
    ClosestPoint cp = tracker_.track(state.track, hip);
    if (!cp.inside) {
        return free(state, cp);
    }
    if (!forms_.tame(cp.place.index) || !is_sharp(state.track.best.jet, hip)) {
        cp = tracker_.feet().closest(
            hip);  // followed, it may be 1e-12 beside, and on the other side
        if (!cp.inside) {
            return free(state, cp);
        }
    }
    if (!enters(state, cp, from)) {
        return free(state, cp);
    }
    state.touching = true;
    const Walk walk = touch_down(*outline_, state.go, cp.place, hip);
    if (walk.nu <= 0.0) {
        return free(state, cp);
    }
    Contact contact = felt<HasFriction, HasDamper>(
        state, walk, hip, HasFriction ? coefficient(spec_.friction, 1.0) : 0.0);
    contact.began = true;
    return contact;
}

/// The force of a god-object after its walk.
template <bool HasFriction, bool HasDamper>
[[gnu::always_inline]] inline Contact Scene::felt(ContactState& state,
                                                  const Walk& walk,
                                                  const Vec2& hip,
                                                  double mu) const noexcept {
    Contact contact = pressed_by(walk, hip, state.go.place, spec_.stiffness);
    contact.mode = mode_of<HasFriction>(walk.slid, state.theta, spec_.friction);
    contact.mu = mu;
    if (walk.outside_cone) {
        cut_to_cone<HasFriction>(walk, spec_.stiffness, contact);
    }
    if constexpr (HasDamper) {
        damp<HasFriction>(state, walk, contact);
    }
    if constexpr (HasFriction) {
        state.theta = next_theta(state.theta, walk.slid, decay_);
    }
    return contact;
}

/// The damper acts on the rate of the spring. The surface still only pushes, and friction stays in
/// its cone; in a concave vertex, where two normals carry, the force may not turn against the
/// spring.
template <bool HasFriction>
void Scene::damp(ContactState& state, const Walk& walk, Contact& contact) const noexcept {
    const Vec2 spring = contact.force / spec_.stiffness;
    const Vec2 rate = (spring - state.last_spring) / spec_.period;
    state.last_spring = spring;
    const Vec2 force = contact.force + spec_.damping * rate;
    if (walk.in_corner) {
        contact.force = glm::dot(force, contact.force) > 0.0 ? force : Vec2{};
        contact.normal_force = std::max(glm::dot(contact.force, walk.normal), 0.0);
        contact.tangential_force = glm::dot(contact.force, walk.tangent);
        return;
    }
    contact.normal_force = std::max(glm::dot(force, walk.normal), 0.0);
    const double limit = cone_radius<HasFriction>(contact.mu, contact.normal_force);
    contact.tangential_force = std::clamp(glm::dot(force, walk.tangent), -limit, limit);
    contact.force = contact.normal_force * walk.normal + contact.tangential_force * walk.tangent;
}

}  // namespace palpate::engine
