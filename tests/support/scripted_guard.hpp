#pragma once

#include <cstdint>
#include <vector>

#include "engine/device/drivers/motor_guard.hpp"

namespace palpate::tests {

/// A guard that only says what it is given to say, and counts what it hears.
class ScriptedGuard : public engine::MotorGuard {
public:
    struct Script {
        bool there = true;  ///< watch() works
        bool alive = true;
        bool tripped = false;
        bool force = false;    ///< what the driver said last
        bool repeats = false;  ///< zeros
        int watches = 0;
        int releases = 0;
        std::vector<std::uint8_t> zero{};  ///< the packet that switches the motors off
    };

    explicit ScriptedGuard(Script& script) : script_(&script) {}

    [[nodiscard]] bool watch(int /*port*/, const engine::GuardPackets& packets) override {
        ++script_->watches;
        script_->zero.assign(packets.zero.begin(), packets.zero.end());
        script_->tripped = false;
        script_->alive = script_->alive || script_->there;
        return script_->there;
    }
    void release() noexcept override { ++script_->releases; }
    void force_on() noexcept override { script_->force = true; }
    void force_off() noexcept override { script_->force = false; }
    void repeat_zeros(bool on) noexcept override { script_->repeats = on; }
    [[nodiscard]] bool alive() const noexcept override { return script_->alive; }
    [[nodiscard]] bool tripped() const noexcept override { return script_->tripped; }

private:
    Script* script_;
};

}  // namespace palpate::tests
