#include "engine/rendering/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace palpate::engine {
namespace {

/// mu counts as relaxed once theta is below this: 1e-3 of mu_s - mu_d is 0.2 mN at 1 N.
constexpr double kRelaxed = 1e-3;

void require(bool ok, const char* what, double value, const char* remedy) {
    if (!ok) {
        throw std::invalid_argument(std::string(what) + " is " + std::to_string(value) + ": " +
                                    remedy);
    }
}

const SceneSpec& checked(const SceneSpec& spec) {
    const auto finite_from_zero = [](double v) {
        return std::isfinite(v) && v >= 0.0;
    };
    require(std::isfinite(spec.stiffness) && spec.stiffness > 0.0, "stiffness", spec.stiffness,
            "give N/m above 0");
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
    return spec;
}

}  // namespace

Scene::Scene(std::shared_ptr<const Outline> outline, const SceneSpec& spec)
    : outline_(std::move(outline)),
      spec_(checked(spec)),
      feet_(*outline_),
      decay_(stribeck_decay(spec.friction, spec.period)) {
    const bool friction = !spec.friction.none();
    const bool slew = !spec.slew.none();
    step_ = friction ? (slew ? &Scene::step<true, true> : &Scene::step<true, false>)
                     : (slew ? &Scene::step<false, true> : &Scene::step<false, false>);
}

template <bool HasFriction, bool HasSlew>
Contact Scene::step(ContactState& state, const Vec2& hip) const noexcept {
    if (!std::isfinite(hip.x) || !std::isfinite(hip.y)) {
        state.touching = false;
        state.theta = 1.0;
        return {.refused = true};
    }
    const double travelled = state.started ? glm::length(hip - state.last_hip) : 0.0;
    state.started = true;
    state.last_hip = hip;

    const ClosestPoint cp = feet_.closest(hip);
    if (!state.touching) {
        state.theta = 1.0;
        if (!cp.inside) {
            return {.cp = cp, .place = cp.place, .go = cp.point};
        }
        state.touching = true;
        state.place = cp.place;
    }

    const double mu = HasFriction ? coefficient(spec_.friction, state.theta) : 0.0;
    const double budget = HasSlew ? 2.0 * travelled + spec_.slew.speed * spec_.period
                                  : std::numeric_limits<double>::infinity();
    const Walk walk = walk_god_object<HasFriction>(*outline_, state.place, hip, mu, budget,
                                                   HasSlew ? spec_.slew.radius : 0.0);
    state.place = walk.place;

    if (walk.nu <= 0.0 && !walk.out_of_budget) {
        state.touching = false;
        state.theta = 1.0;
        return {.cp = cp, .place = cp.place, .go = cp.point};
    }
    Contact contact = render<HasFriction>(walk, hip, mu);
    contact.cp = cp;
    const bool slipped = walk.slid > 0.0;
    contact.mode =
        !slipped ? Mode::stuck
        : HasFriction && state.theta > kRelaxed && spec_.friction.mu_s > spec_.friction.mu_d
            ? Mode::transition
            : Mode::slip;
    if constexpr (HasFriction) {
        state.theta = next_theta(state.theta, slipped, decay_);
    }
    return contact;
}

template <bool HasFriction>
Contact Scene::render(const Walk& walk, const Vec2& hip, double mu) const noexcept {
    const double k = spec_.stiffness;
    Contact contact{.place = walk.place, .go = walk.point, .mu = mu, .slewed = walk.out_of_budget};
    if (walk.held_outside) {
        // The GO could not reach its cone in this tick: keep what the surface can carry here.
        const double load = std::max(walk.nu, 0.0);
        const double most = cone_radius<HasFriction>(mu, load);
        contact.normal_force = k * load;
        contact.tangential_force = k * std::clamp(-walk.tau, -most, most);
        contact.force =
            contact.normal_force * walk.normal + contact.tangential_force * walk.tangent;
        return contact;
    }
    contact.force = k * (walk.point - hip);
    contact.normal_force = k * walk.nu;
    contact.tangential_force = -k * walk.tau;
    return contact;
}

}  // namespace palpate::engine
