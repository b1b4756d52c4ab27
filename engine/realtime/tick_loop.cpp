#include "engine/realtime/tick_loop.hpp"

#include <cmath>

namespace palpate::engine {
namespace {

Trip found(const Reading& reading, const Contact& contact) noexcept {
    switch (reading.fault) {
        case DeviceFault::none:
            return contact.refused ? Trip::scene_refused : Trip::none;
        case DeviceFault::silent:
            return Trip::device_silent;
        case DeviceFault::stopped:
            return Trip::device_stopped;
        case DeviceFault::garbage:
            return Trip::device_garbage;
        case DeviceFault::unreachable:
            return Trip::out_of_workspace;
        case DeviceFault::lost:
        case DeviceFault::unguarded:
        case DeviceFault::ended:
            break;
    }
    return Trip::device_lost;
}

/// The flags of the safety chain, the clock and the device; those of the scene come with its
/// contact.
std::uint8_t flags_of(const Command& command,
                      const Applied& applied,
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

void TickLoop::begin(const Scene& scene, double rest) noexcept {
    scene_ = &scene;
    state_ = ContactState{};
    safety_ = fresh_state(safety_, limits_, rest);
    applied_ = Applied{};
    flight_.clear();
    next_ = 0;
}

TickRecord TickLoop::tick(const TickOrder& order) noexcept {
    const Reading reading = usable(device_->read());
    const Contact contact = scene_->tick(state_, reading.hip);
    const Command command = make_safe(
        safety_, limits_,
        {.force = contact.force,
         .spring = scene_->spring(state_, contact, reading.hip),
         .depth = contact.mode == Mode::free ? 0.0 : contact.normal_force / limits_.stiffness,
         .hip = reading.hip,
         .counts = reading.counts,
         .found = found(reading, contact),
         .fresh = reading.fresh,
         .behind = reading.behind,
         .time_ns = order.time_ns,
         .lateness_ns = order.lateness_ns,
         .load = applied_.load,
         .clipped = applied_.saturated,
         .screen_age = order.screen_age,
         .enable = order.enable,
         .held = order.held && reading.grip != Grip::released,
         .stop = order.stop});
    applied_ = device_->write(command.force);

    TickRecord record;
    record.tick = next_++;
    record.time_ns = order.time_ns;
    record.hip = reading.hip;
    record.command = command.force;
    record.counts = reading.counts;
    record.codes = applied_.codes;
    record.lateness_us = static_cast<float>(static_cast<double>(order.lateness_ns) * 1e-3);
    record.flags = flags_of(command, applied_, periods_late(order.lateness_ns, limits_.period) > 0,
                            reading.ok() && !reading.fresh);
    set_contact(record, contact, scene_->outline());
    flight_.add(record);
    return record;
}

Reading TickLoop::usable(Reading reading) noexcept {
    if (reading.ok() && !(std::isfinite(reading.hip.x) && std::isfinite(reading.hip.y))) {
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
    device_->write(Vec2{});
    return reading;
}

void TickLoop::silence() noexcept {
    device_->write(Vec2{});
}

}  // namespace palpate::engine
