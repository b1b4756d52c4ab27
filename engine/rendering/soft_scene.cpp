#include <algorithm>
#include <cmath>

#include "engine/deformation/soft_walk.hpp"
#include "engine/rendering/scene.hpp"

/// The ticks of objects that yield, apart from the others: what rigid scenes are compiled to must
/// not depend on these.
///
/// Each tick the shape makes its step under the spring of the contact, the god-object keeps its
/// place on the material, and then goes on along the new shape to where its stretch fits the cone.
/// With E = K/2 |GO - HIP|^2 and what the curves store and move with, a tick begins with F_k .
/// (h_k+1 - h_k) = E_k - E' + K/2 |h_k+1 - h_k|^2 as on a rigid object; the step of the curves and
/// the walk only lower the sum, and so does whatever ends a contact. The curves keep what a contact
/// left in them for the next. So it is from the first contact on, all together, that the user gets
/// no more than the leak of the ledger (engine/rendering/energy_ledger.hpp), for any K, c and T.
namespace palpate::engine {

void Scene::add_softness() {
    if (spec_.compliance == 0.0) {
        return;
    }
    soft_ = std::make_shared<const SoftShape>(outline_, spec_.compliance, spec_.period);
    step_ = &Scene::yielding;
}

/// Out of contact while the surface still goes back to its rest.
Contact Scene::waning(ContactState& state) const noexcept {
    state.touching = false;
    state.theta = 1.0;
    Contact contact = state.away;
    contact.skipped = false;
    return contact;
}

/// Whether HIP has met the surface, which then holds the god-object; else `contact` is the tick's
/// answer.
bool Scene::meets(ContactState& state, const Vec2& from, Contact& contact) const noexcept {
    SoftState& soft = state.soft;
    const Vec2& hip = state.last_hip;
    state.theta = 1.0;
    if (!soft.moving) {
        ClosestPoint cp = tracker_.track(state.track, hip);
        if (!cp.inside) {
            contact = free(state, cp);
            return false;
        }
        state.go.place = tracker_.feet().closest(hip).place;
        soft.moving = true;
        return true;
    }
    soft.clear -= glm::length(hip - from);
    if (soft.clear <= 0.0) {
        const SoftShape::Met met = soft_->nearest(soft, hip);
        if (met.depth > 0.0) {
            state.go.place = {.index = met.at.span, .parameter = met.at.u};
            return true;
        }
        soft.clear = -met.depth;
    }
    const SoftState before = soft;
    soft.clear -= soft_->advance(soft);
    if (soft.clear <= 0.0) {
        soft = before;
        const SoftShape::Met met = soft_->advance_to(soft, hip, spec_.stiffness);
        if (met.touches) {
            state.touching = true;
            state.go.place = {.index = met.at.span, .parameter = met.at.u};
            contact = pressed(state,
                              {.point = met.point,
                               .normal = met.normal,
                               .tangent = -perp(met.normal),
                               .tau = -0.0,
                               .nu = met.depth},
                              hip);
            return false;
        }
        soft.clear = -met.depth;
    }
    if (SoftShape::all_but_still(soft)) {
        const ClosestPoint cp = tracker_.track(state.track, hip);
        if (!cp.inside) {
            soft = {};
            contact = free(state, cp);
            return false;
        }
    }
    contact = waning(state);
    return false;
}

Contact Scene::yielding(ContactState& state, const Vec2& hip) const noexcept {
    state.clear2 = 0.0;
    if (!std::isfinite(hip.x) || !std::isfinite(hip.y)) {
        state.soft.clear = 0.0;
        Contact contact = waning(state);
        contact.refused = true;
        return contact;
    }
    const Vec2 from = state.started ? state.last_hip : hip;
    state.started = true;
    state.last_hip = hip;
    Contact contact;
    if (!state.touching && !meets(state, from, contact)) {
        return contact;
    }
    state.touching = true;
    soft_->advance(state.soft, material_at(*outline_, state.go.place), hip, spec_.stiffness);
    const double mu = coefficient(spec_.friction, state.theta);
    const Walk walk = walk_on_soft(*soft_, state.soft, state.go.place, hip, mu);
    if (walk.nu <= 0.0) {
        state.soft.clear = 0.0;
        state.away = {.place = state.go.place, .go = walk.point};
        return waning(state);
    }
    return pressed(state, walk, hip);
}

Contact Scene::pressed(ContactState& state, const Walk& walk, const Vec2& hip) const noexcept {
    Contact contact = pressed_by(walk, hip, state.go.place, spec_.stiffness);
    contact.mode = mode_of<true>(walk.slid, state.theta, spec_.friction);
    contact.mu = coefficient(spec_.friction, state.theta);
    if (walk.outside_cone) {
        cut_to_cone<true>(walk, spec_.stiffness, contact);
    }
    state.theta = next_theta(state.theta, walk.slid, decay_);
    return contact;
}

Vec2 Scene::soft_spring(const ContactState& state, const Vec2& stretch) const noexcept {
    const double stored = 2.0 * soft_->stored(state.soft) / spec_.stiffness;
    const double length2 = glm::dot(stretch, stretch);
    return Vec2{std::sqrt(length2 + std::fmax(stored, 0.0)), 0.0};
}

}  // namespace palpate::engine
