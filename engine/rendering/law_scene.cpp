#include <cmath>

#include "engine/rendering/scene.hpp"

/// The ticks of scenes with a law of friction from the literature, apart from the others: what they
/// are compiled to must not depend on these.
namespace palpate::engine {
namespace {

/// A hand goes no farther in a tick, m, and no law needs more load, N: so that products stay
/// finite.
constexpr double kFarTravel = 1e3;
constexpr double kHardLoad = 1e9;

}  // namespace

void Scene::add_law() {
    if (spec_.law.traits == nullptr) {
        return;
    }
    law_ = FrictionLaw(spec_.law, spec_.friction, spec_.stiffness, spec_.period);
    if (lengths_.whole() == 0.0) {
        lengths_ = ArcLength(*outline_);
        const Vec2 begin = outline_->spans().front().at(0.0).point;
        size_ = lengths_.whole() + std::fabs(begin.x) + std::fabs(begin.y);
    }
    if (step_ != &Scene::rubbed) {
        smooth_ = step_;
        step_ = &Scene::rubbed;
    }
}

/// The frictionless tick, and on it the friction of the law along the tangent: across the force.
Contact Scene::rubbed(ContactState& state, const Vec2& hip) const noexcept {
    Contact contact = (this->*smooth_)(state, hip);
    if (contact.mode == Mode::free) {
        return contact;
    }
    FrictionMemory& rubbing = state.rubbing;
    if (contact.began) {
        rubbing = {.law = {.draws = rubbing.law.draws}, .hip = hip};
    }
    const Vec2 way = hip - rubbing.hip;
    const double along_tangent = glm::dot(rubbing.tangent, way);
    // A press straight down travels by what rounding makes of the tangent: no way at all.
    const double travel =
        std::fabs(along_tangent) > rubbing.blur * (std::fabs(way.x) + std::fabs(way.y))
            ? along_tangent
            : 0.0;
    const FrictionForce rubbed =
        law_.step(rubbing.law, {.travel = std::fmax(-kFarTravel, std::fmin(travel, kFarTravel)),
                                .load = std::fmin(contact.normal_force, kHardLoad),
                                .place = law_.wants_place() ? along(state.go.place) : 0.0});
    const double size = glm::length(contact.force);
    if (size > 0.0) {
        rubbing.tangent = -perp(contact.force * (1.0 / size));
        rubbing.blur =
            4.0 * kEpsilon * (size_ + std::fabs(hip.x) + std::fabs(hip.y)) * spec_.stiffness / size;
    }
    rubbing.hip = hip;
    contact.force += rubbed.force * rubbing.tangent;
    contact.tangential_force += rubbed.force;
    contact.mu = rubbed.mu;
    contact.mode = rubbed.slid || !(spec_.friction.mu_s > 0.0) ? Mode::slip : Mode::stuck;
    return contact;
}

/// Where a place lies along the outline, m.
double Scene::along(const Place& place) const noexcept {
    if (place.on_seam) {
        return lengths_.at(outline_->seams()[place.index].before, 1.0);
    }
    return lengths_.at(place.index, place.parameter);
}

}  // namespace palpate::engine
