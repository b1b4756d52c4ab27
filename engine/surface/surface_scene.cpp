#include "engine/surface/surface_scene.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/refuse.hpp"

namespace palpate::engine {
namespace {

const SurfaceSceneSpec& checked(const SurfaceSceneSpec& whole) {
    static_cast<void>(checked(whole.contact));
    refuse_if(whole.contact.compliance > 0.0, "compliance is {:.9g}: give 0 with a surface",
              whole.contact.compliance);
    return whole;
}

/// What a search for the closest point may cost within a tick: a tenth of a millisecond.
constexpr Work kTickWork = 200'000;

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
    return a.surface != b.surface || a.i != b.i || a.j != b.j ||
           std::fabs(a.u - b.u) + std::fabs(a.v - b.v) > 1e-12;
}

/// Without contact the closest point stands for the GO.
SurfaceContact nothing_felt(const SurfaceClosest& cp) noexcept {
    return {.cp = cp,
            .surface = static_cast<int>(cp.place.surface),
            .go_u = cp.u,
            .go_v = cp.v,
            .go = cp.point};
}

void end_contact(SurfaceState& state) noexcept {
    state.touching = false;
    state.theta = 1.0;
    state.last_spring = Vec3{};
    state.fan.on = false;
}

/// Whether HIP, which is inside, came through the surface. A search that was broken off may find
/// too far a point: then, as without this question.
bool came_through(SurfaceState& state, const Vec3& from) noexcept {
    const Vec3& hip = state.last_hip;
    const double depth = state.seen.distance;
    const double size = std::fabs(hip.x) + std::fabs(hip.y) + std::fabs(hip.z);
    return !state.seen.proven ||
           state.approach.enters(depth, glm::length(hip - from), rounding_of(depth, size));
}

}  // namespace

SurfaceScene::SurfaceScene(std::shared_ptr<const NurbsSurface> surface,
                           const SurfaceSceneSpec& spec)
    : SurfaceScene(std::vector<std::shared_ptr<const NurbsSurface>>{std::move(surface)}, spec) {}

SurfaceScene::SurfaceScene(std::vector<std::shared_ptr<const NurbsSurface>> surfaces,
                           const SurfaceSceneSpec& spec)
    : feet_(std::make_shared<const SurfaceObject>(std::move(surfaces))),
      spec_(checked(spec)),
      decay_(stribeck_decay(spec.contact.friction, spec.contact.period)),
      step_(spec.contact.friction.none() ? &SurfaceScene::step<false> : &SurfaceScene::step<true>) {
}

SurfaceContact SurfaceScene::free(SurfaceState& state, const Vec3& hip) const noexcept {
    end_contact(state);
    const SurfaceClosest& cp = state.seen;
    state.approach.stay(cp.inside ? cp.distance : 0.0);
    state.clear_at = hip;
    const double clear = cp.distance * kClearShare;
    state.clear2 = spec_.skip_far && !cp.inside ? clear * clear : 0.0;
    return nothing_felt(cp);
}

/// The GO's way of a tick, from where it stands. `looks`: state.seen is of this tick.
template <bool HasFriction>
SurfaceSlide SurfaceScene::move(SurfaceState& state,
                                const Vec3& from_hip,
                                const Vec3& hip,
                                double mu,
                                bool looks,
                                bool& slipped) const noexcept {
    // Without friction the GO is the local foot: mostly the closest point, already found.
    // One that lies outside may be on the other side of a sheet that lies on itself.
    const Vec3 h = hip - object().origin();
    const bool slewed = !spec_.contact.slew.none();
    const bool known = !HasFriction && !slewed && looks && state.seen.inside &&
                       feet_.same_bowl(state.track, state.place);
    const SurfacePlace from = known ? state.seen.place : state.place;
    const SurfaceFan fan = state.fan;
    const SurfaceSlide slide =
        !slewed ? slide_on_surface(object(), from, h, mu)
                : slide_on_surface(object(), from, h, mu,
                                   {.from = from_hip - object().origin(),
                                    .budget = 2.0 * glm::length(hip - from_hip) +
                                              spec_.contact.slew.speed * spec_.contact.period,
                                    .radius = spec_.contact.slew.radius},
                                   state.fan);
    const bool turned = fan.on != state.fan.on || fan.angle != state.fan.angle;  // is no rest
    slipped = slide.slid > 0.0 || turned || (known && apart(state.place, from));
    state.place = slide.place;
    return slide;
}

template <bool HasFriction>
SurfaceContact SurfaceScene::step(SurfaceState& state, const Vec3& hip) const noexcept {
    const Vec3 moved = hip - state.clear_at;
    if (glm::dot(moved, moved) < state.clear2) {  // false for NaN; clear2 is 0 while touching
        ++state.skipped;
        state.last_hip = hip;
        SurfaceContact contact = nothing_felt(state.seen);
        contact.skipped = true;
        contact.cp.distance -= glm::length(moved);
        return contact;
    }
    state.clear2 = 0.0;
    if (!usable(hip)) {
        end_contact(state);
        state.approach = {};
        return {.refused = true};
    }
    const Vec3 from_hip = state.started ? state.last_hip : hip;
    state.started = true;
    state.last_hip = hip;
    const bool looks = !state.touching || spec_.look_in_contact;
    if (looks) {
        state.seen = feet_.track(state.track, hip, kTickWork);
    }
    if (!state.touching) {
        if (!state.seen.inside || !came_through(state, from_hip)) {
            return free(state, hip);
        }
        state.touching = true;
        state.theta = 1.0;
        state.place = state.seen.place;
        state.fan.on = false;
    }
    const Friction& friction = spec_.contact.friction;
    const double mu = HasFriction ? coefficient(friction, state.theta) : 0.0;
    bool slipped = false;
    const SurfaceSlide slide = move<HasFriction>(state, from_hip, hip, mu, looks, slipped);
    if (!(slide.load > 0.0) && !slide.out_of_budget) {
        if (!looks) {
            state.seen = feet_.track(state.track, hip, kTickWork);
        }
        SurfaceContact ended = free(state, hip);
        ended.on_flow = slide.on_flow;
        ended.settled = slide.settled;
        return ended;
    }
    SurfaceContact contact = render(slide, hip - object().origin(), mu);
    if (spec_.contact.damping > 0.0) {
        damp(state, slide, contact);
    }
    contact.cp = state.seen;
    contact.mode = mode_of<HasFriction>(slipped, state.theta, friction);
    if constexpr (HasFriction) {
        state.theta = next_theta(state.theta, slipped, decay_);
    }
    return contact;
}

SurfaceContact SurfaceScene::render(const SurfaceSlide& slide,
                                    const Vec3& h,
                                    double mu) const noexcept {
    const double k = spec_.contact.stiffness;
    const double load = std::max(slide.load, 0.0);
    SurfaceContact contact{.surface = static_cast<int>(slide.place.surface),
                           .go_u = object().u_of(slide.place),
                           .go_v = object().v_of(slide.place),
                           .go = slide.point + object().origin(),
                           .normal = slide.normal,
                           .normal_force = k * load,
                           .mu = mu,
                           .vertex_slew = slide.out_of_budget,
                           .outside_cone = slide.outside_cone,
                           .in_crease = slide.in_crease,
                           .on_flow = slide.on_flow,
                           .settled = slide.settled};
    const double cone = mu * load;
    // Without friction what is left along the surface is rounding, or held by a border.
    if ((cone == 0.0 && !slide.in_crease) || (slide.outside_cone && slide.length > cone)) {
        const double share = cone > 0.0 ? cone / slide.length : 0.0;
        contact.force = k * (load * slide.normal - share * slide.tangential);
        contact.tangential_force = k * cone;
        return contact;
    }
    contact.force = k * (slide.point - h);
    contact.tangential_force = k * slide.length;
    return contact;
}

/// The damper acts on the rate of the spring, as Scene's: the surface still only pushes, friction
/// stays in its cone, and in a concave crease the force may not turn against the spring.
void SurfaceScene::damp(SurfaceState& state,
                        const SurfaceSlide& slide,
                        SurfaceContact& contact) const noexcept {
    const Vec3 spring = contact.force / spec_.contact.stiffness;
    const Vec3 rate = (spring - state.last_spring) / spec_.contact.period;
    state.last_spring = spring;
    Vec3 force = contact.force + spec_.contact.damping * rate;
    if (slide.in_crease) {
        force = glm::dot(force, contact.force) > 0.0 ? force : Vec3{};
        contact.normal_force = std::max(glm::dot(force, slide.normal), 0.0);
        contact.tangential_force = glm::length(force - contact.normal_force * slide.normal);
        contact.force = force;
        return;
    }
    contact.normal_force = std::max(glm::dot(force, slide.normal), 0.0);
    const Vec3 along = force - glm::dot(force, slide.normal) * slide.normal;
    const double length = glm::length(along);
    contact.tangential_force = std::min(length, contact.mu * contact.normal_force);
    contact.force = contact.normal_force * slide.normal +
                    (length > 0.0 ? contact.tangential_force / length : 0.0) * along;
}

void SurfaceScene::set_period(double period) {
    spec_.contact.period = period;
    static_cast<void>(checked(spec_));
    decay_ = stribeck_decay(spec_.contact.friction, period);
}

}  // namespace palpate::engine
