#include "engine/realtime/tick_loop.hpp"

namespace palpate::engine {
namespace {

std::int16_t feature_of(const Place& place) noexcept {
    const auto index = static_cast<std::int16_t>(place.index);
    return place.on_joint ? static_cast<std::int16_t>(-1 - index) : index;
}

}  // namespace

void TickLoop::begin(const Scene& scene) noexcept {
    scene_ = &scene;
    state_ = ContactState{};
    gate_ = ForceGate{};
    next_ = 0;
}

TickRecord TickLoop::tick(std::int64_t time_ns, std::int64_t lateness_ns, bool enable) noexcept {
    const Reading reading = device_->read();
    const Contact contact = scene_->tick(state_, reading.hip);
    if (!reading.ok || contact.refused) {
        gate_.faulted = true;
    }
    const Command command = guard(gate_, limits_, contact.force, enable);
    const Applied applied = device_->write(command.force);

    TickRecord record;
    record.tick = next_++;
    record.time_ns = time_ns;
    record.hip = reading.hip;
    record.cp = contact.cp.point;
    record.go = contact.go;
    record.force = contact.force;
    record.command = command.force;
    record.normal_force = contact.normal_force;
    record.tangential_force = contact.tangential_force;
    record.mu = contact.mu;
    record.parameter = contact.place.parameter;
    record.counts = reading.counts;
    record.codes = applied.codes;
    record.lateness_us = static_cast<float>(static_cast<double>(lateness_ns) * 1e-3);
    record.feature = feature_of(contact.place);
    record.mode = contact.mode;
    const double late = kLateShare * scene_->spec().period * 1e9;
    const auto flag = [](bool set, TickFlag bit) {
        return set ? static_cast<unsigned>(bit) : 0U;
    };
    record.flags = static_cast<std::uint8_t>(
        flag(command.saturated || applied.saturated, tick_saturated) |
        flag(static_cast<double>(lateness_ns) > late, tick_late) |
        flag(command.ramped, tick_ramped) | flag(command.refused, tick_fault) |
        flag(contact.skipped, tick_skipped) | flag(contact.held, tick_held));
    return record;
}

void TickLoop::silence() noexcept {
    gate_ = ForceGate{};
    device_->write(Vec2{});
}

}  // namespace palpate::engine
