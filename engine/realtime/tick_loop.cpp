#include "engine/realtime/tick_loop.hpp"

#include <cmath>

#include "engine/realtime/felt_scene.hpp"

namespace palpate::engine {
namespace {

Trip found(const Reading& reading, bool refused) noexcept {
    return refused && reading.ok() ? Trip::scene_refused : trip_of(reading.fault);
}

/// The flags of the safety chain, the clock and the device; those of the scene come with its
/// contact.
std::uint8_t flags_of(const Command& command,
                      const AppliedForce& applied,
                      bool late,
                      bool stale) noexcept {
    const auto flag = [](bool set, TickFlag bit) {
        return set ? static_cast<unsigned>(bit) : 0U;
    };
    return static_cast<std::uint8_t>(
        flag(command.saturated || applied.saturated, tick_saturated) | flag(late, tick_late) |
        flag(command.ramped, tick_ramped) | flag(command.trip != Trip::none, tick_fault) |
        flag(command.force_slew, tick_force_slew) | flag(stale, tick_stale));
}

}  // namespace

TickLoop::TickLoop(Device& device, const SafetyLimits& limits)
    : device_(&device), limits_(limits), state_(std::make_unique<FeltState>()) {}

TickLoop::~TickLoop() = default;

void TickLoop::begin(const SceneView& scene, double rest) noexcept {
    scene_ = scene;
    *state_ = FeltState{};
    safety_ = fresh_state(safety_, limits_, rest);
    applied_ = AppliedForce{};
    flight_.clear();
    next_ = 0;
}

/// What does not depend on the contact.
SafetyInput TickLoop::input_of(const TickOrder& order, const Reading& reading) const noexcept {
    return {.hip = reading.hip,
            .counts = reading.counts,
            .fresh = reading.fresh,
            .behind = reading.behind,
            .time_ns = order.time_ns,
            .lateness_ns = order.lateness_ns,
            .load = applied_.load,
            .clipped = applied_.saturated,
            .screen_age = order.screen_age,
            .enable = order.enable,
            .held = order.held && reading.grip != Grip::released,
            .stop = order.stop};
}

/// All but the contact, after the force is written. Every member is named, for else g++ clears the
/// whole record first, by a slow string instruction.
TickRecord TickLoop::recorded(const TickOrder& order,
                              const Reading& reading,
                              const Command& command) noexcept {
    const bool late = periods_late(order.lateness_ns, limits_.period) > 0;
    return {.tick = next_++,
            .time_ns = order.time_ns,
            .hip = reading.hip,
            .cp = {},
            .go = {},
            .force = {},
            .command = command.force,
            .normal_force = 0.0,
            .tangential_force = 0.0,
            .mu = 0.0,
            .u = 0.0,
            .v = 0.0,
            .counts = reading.counts,
            .codes = applied_.codes,
            .lateness_us = static_cast<float>(static_cast<double>(order.lateness_ns) * 1e-3),
            .segment = 0,
            .mode = Mode::free,
            .flags = flags_of(command, applied_, late, reading.ok() && !reading.fresh)};
}

TickRecord TickLoop::tick_in_plane(const TickOrder& order) noexcept {
    const Reading reading = usable(device_->read());
    const Scene& scene = *scene_.plane;
    const Vec2 hip(reading.hip);
    const Contact contact = scene.tick(state_->plane, hip);
    SafetyInput input = input_of(order, reading);
    input.force = Vec3(contact.force, 0.0);
    input.spring = Vec3(scene.spring(state_->plane, contact, hip), 0.0);
    input.depth = contact.mode == Mode::free ? 0.0 : contact.normal_force / limits_.stiffness;
    input.found = found(reading, contact.refused);
    const Command command = make_safe(safety_, limits_, input);
    applied_ = device_->write(command.force);

    TickRecord record = recorded(order, reading, command);
    set_contact(record, contact, scene.outline());
    flight_.add(record);
    return record;
}

TickRecord TickLoop::tick_in_space(const TickOrder& order) noexcept {
    const Reading reading = usable(device_->read());
    const SurfaceContact contact = scene_.space->tick(state_->space, reading.hip);
    const bool free = contact.mode == Mode::free;
    SafetyInput input = input_of(order, reading);
    input.force = contact.force;
    input.spring = free ? Vec3{} : contact.go - reading.hip;
    input.depth = free ? 0.0 : contact.normal_force / limits_.stiffness;
    input.found = found(reading, contact.refused);
    const Command command = make_safe(safety_, limits_, input);
    applied_ = device_->write(command.force);

    TickRecord record = recorded(order, reading, command);
    set_contact(record, contact);
    flight_.add(record);
    return record;
}

Reading TickLoop::usable(Reading reading) noexcept {
    if (reading.ok() && !(std::isfinite(reading.hip.x) && std::isfinite(reading.hip.y) &&
                          std::isfinite(reading.hip.z))) {
        reading.fault = DeviceFault::garbage;
    }
    if (!reading.ok()) {
        reading.hip = hip_;
    }
    hip_ = reading.hip;
    return reading;
}

Reading TickLoop::idle() noexcept {
    const Reading reading = usable(device_->read());
    device_->write(Vec3{});
    return reading;
}

void TickLoop::silence() noexcept {
    device_->write(Vec3{});
}

}  // namespace palpate::engine
