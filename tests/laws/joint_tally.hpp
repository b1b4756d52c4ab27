#pragma once

#include <algorithm>
#include <string>

#include "engine/device/drivers/board_device.hpp"

namespace palpate::tests::joint {

using namespace palpate::engine;

/// The driver, and what it was given.
class Watched : public Device {
public:
    explicit Watched(BoardDevice& device) : device_(&device) {}
    [[nodiscard]] Reading read() noexcept override { return device_->read(); }
    AppliedForce write(const Vec3& force) noexcept override {
        strongest = std::max(strongest, glm::length(force));
        last = force;
        return device_->write(force);
    }
    [[nodiscard]] std::string name() const override { return device_->name(); }
    [[nodiscard]] DeviceTraits traits() const noexcept override { return device_->traits(); }
    bool prove_zero() noexcept override { return device_->prove_zero(); }
    void keep_off() noexcept override { device_->keep_off(); }

    double strongest = 0.0;
    Vec3 last{};

private:
    BoardDevice* device_;
};

struct JointTally {
    int schedules = 0;
    int pressed = 0;  ///< schedules in which the motors had a torque
    int tripped = 0;
    int over_limit = 0;
    int not_latched = 0;
    int not_recorded = 0;
    int not_zero_in_time = 0;
    int false_trips = 0;
    std::string worst;

    [[nodiscard]] int broken() const {
        return over_limit + not_latched + not_recorded + not_zero_in_time + false_trips;
    }
};

}  // namespace palpate::tests::joint
