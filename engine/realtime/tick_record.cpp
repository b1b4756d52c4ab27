#include "engine/realtime/tick_record.hpp"

#include <cmath>

#include "engine/realtime/felt_scene.hpp"

namespace palpate::engine {

namespace {

/// What contacts in the plane and in space say alike.
[[gnu::always_inline]] inline void set_common(TickRecord& tick, const auto& contact) noexcept {
    tick.normal_force = contact.normal_force;
    tick.tangential_force = contact.tangential_force;
    tick.mu = contact.mu;
    tick.mode = contact.mode;
    const unsigned scene = static_cast<unsigned>(contact.skipped) * tick_skipped |
                           static_cast<unsigned>(contact.outside_cone) * tick_outside_cone;
    tick.flags = static_cast<std::uint8_t>((tick.flags & ~kSceneFlags) | scene);
}

[[gnu::always_inline]] inline void set(TickRecord& tick,
                                       const Contact& contact,
                                       const Outline& outline) noexcept {
    const SegmentPlace place = segment_place(outline, contact.place);
    const auto segment = static_cast<std::int16_t>(place.segment);  // Outline takes no more
    tick.go = Vec3(contact.go, 0.0);
    tick.force = Vec3(contact.force, 0.0);
    tick.u = place.on_vertex ? place.angle : place.u;
    tick.segment = place.on_vertex ? static_cast<std::int16_t>(-1 - segment) : segment;
    set_common(tick, contact);
}

}  // namespace

void set_contact(TickRecord& tick, const Contact& contact, const Outline& outline) noexcept {
    set(tick, contact, outline);
}

void set_contact(TickRecord& tick, const SurfaceContact& contact) noexcept {
    tick.go = contact.go;
    tick.force = contact.force;
    tick.u = contact.go_u;
    tick.v = contact.go_v;
    tick.segment = static_cast<std::int16_t>(contact.surface);
    set_common(tick, contact);
}

void set_contacts(std::span<TickRecord> ticks, const SceneView& scene, FeltState& state) noexcept {
    if (scene.plane != nullptr) {
        const Outline& outline = scene.plane->outline();
        for (TickRecord& tick : ticks) {
            set(tick, scene.plane->tick(state.plane, Vec2(tick.hip)), outline);
        }
    } else if (scene.space != nullptr) {
        for (TickRecord& tick : ticks) {
            set_contact(tick, scene.space->tick(state.space, tick.hip));
        }
    }
}

std::int64_t tick_period_ns(double rate_hz) noexcept {
    return static_cast<std::int64_t>(std::floor(1e9 / rate_hz + 0.5));
}

}  // namespace palpate::engine
