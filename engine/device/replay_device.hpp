#pragma once

#include <cstddef>
#include <vector>

#include "engine/device/device.hpp"

namespace palpate::engine {

/// Gives back a recorded hand, one reading a tick. It feels no force. Past the end the hand
/// rests where it was; with nothing recorded every read fails.
class ReplayDevice : public Device {
public:
    /// Starts from the beginning of `readings`.
    void begin(std::vector<Reading> readings) {
        readings_ = std::move(readings);
        next_ = 0;
    }
    /// Readings not yet given back.
    [[nodiscard]] std::size_t left() const noexcept { return readings_.size() - next_; }
    [[nodiscard]] bool at_end() const noexcept { return next_ >= readings_.size(); }

    [[nodiscard]] Reading read() noexcept override {
        if (readings_.empty()) {
            return {.fault = DeviceFault::ended};
        }
        return at_end() ? readings_.back() : readings_[next_++];
    }
    AppliedForce write(const Vec3& /*force*/) noexcept override { return {}; }
    [[nodiscard]] std::string name() const override { return "replay"; }
    [[nodiscard]] DeviceTraits traits() const noexcept override { return {.gives_force = false}; }

private:
    std::vector<Reading> readings_;
    std::size_t next_ = 0;
};

}  // namespace palpate::engine
