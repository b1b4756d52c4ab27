#pragma once

#include "engine/commissioning/rig_record.hpp"
#include "engine/device/device.hpp"
#include "engine/device/machine.hpp"
#include "tests/support/std.hpp"

namespace palpate::tests {

/// How three encoders, or three motors, are connected in truth.
struct Cables {
    std::array<std::size_t, 3> axis{0, 1, 2};     ///< that each sees, or moves
    std::array<double, 3> factor{1.0, 1.0, 1.0};  ///< < 0 reversed; 0 dead

    friend bool operator==(const Cables&, const Cables&) = default;
};

/// A free handle on three straight axes whose motors and encoders are not connected as its
/// calibration says, on a virtual clock: a torque written at one tick acts from the next one on.
/// Each axis is integrated by itself in explicit steps of 20 us, with a standstill that friction
/// holds.
class MiswiredGantry : public engine::Device {
public:
    MiswiredGantry(const engine::Calibration& machine,
                   const std::array<engine::AxisDynamics, 3>& axes,
                   const Cables& seen,
                   const Cables& moved)
        : encoders(seen),
          motors(moved),
          gantry_(*machine.gantry),
          axes_(axes),
          place_(machine.gantry->home()) {}

    /// A person brings the handle there and lets go.
    void bring(const engine::Vec3& place) {
        place_ = from_ = place;
        speed_ = engine::Vec3{};
        past_.clear();
    }

    Cables encoders;
    Cables motors;
    /// From this tick on the device has this fault.
    int fails_at = std::numeric_limits<int>::max();
    std::size_t late = 0;    ///< ticks that its answers are older than they should be
    double strongest = 0.0;  ///< the most force that was ever asked for, N
    double furthest = 0.0;   ///< m from where it was brought, along one axis
    engine::Vec3 last{};     ///< N, written last
    int ticks = 0;

    [[nodiscard]] engine::Reading read() noexcept override {
        ++ticks;
        advance();
        past_.push_back(place_);
        if (past_.size() > late + 1) {
            past_.pop_front();
        }
        engine::Reading reading;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto axis = static_cast<int>(encoders.axis[i]);
            const double way = past_.front()[axis] - gantry_.spec().home()[axis];
            reading.counts[i] = static_cast<std::int32_t>(
                std::floor(encoders.factor[i] * way / gantry_.quantum()[axis] + 0.5));
        }
        const auto hip = gantry_.locate(reading.counts);
        reading.hip = hip.value_or(engine::Vec3{});
        reading.fault = ticks >= fails_at ? engine::DeviceFault::lost
                      : hip               ? engine::DeviceFault::none
                                          : engine::DeviceFault::unreachable;
        return reading;
    }
    engine::AppliedForce write(const engine::Vec3& force) noexcept override {
        strongest = std::max(strongest, glm::length(force));
        last = force;
        force_ = waiting_;
        waiting_ = engine::Vec3{};
        for (std::size_t i = 0; i < 3; ++i) {
            waiting_[static_cast<int>(motors.axis[i])] +=
                motors.factor[i] * force[static_cast<int>(i)];
        }
        return {};
    }
    [[nodiscard]] std::string name() const override { return "a miswired gantry"; }
    [[nodiscard]] engine::DeviceTraits traits() const noexcept override {
        return {.delay_ticks = 1.0, .axes = 3};
    }

private:
    void advance() noexcept {
        constexpr int kSteps = 50;
        constexpr double kStep = 1e-3 / kSteps;
        for (int i = 0; i < 3; ++i) {
            const engine::AxisDynamics& axis = axes_[static_cast<std::size_t>(i)];
            const double pushed = force_[i] - axis.pull;
            if (speed_[i] == 0.0 && std::fabs(pushed) <= axis.friction) {
                continue;
            }
            for (int k = 0; k < kSteps; ++k) {
                const double way = speed_[i] != 0.0 ? speed_[i] : pushed;
                const double rub = std::copysign(axis.friction, way);
                const double free = pushed - axis.damping * speed_[i];
                const double next = speed_[i] + kStep * (free - rub) / axis.mass;
                const bool stops = axis.friction > 0.0 && speed_[i] * next < 0.0;
                speed_[i] = stops ? 0.0 : next;
                place_[i] += kStep * speed_[i];
                if (stops && std::fabs(pushed) <= axis.friction) {
                    break;
                }
            }
            furthest = std::max(furthest, std::fabs(place_[i] - from_[i]));
        }
    }

    engine::Gantry gantry_;
    std::array<engine::AxisDynamics, 3> axes_;
    engine::Vec3 place_{};
    std::deque<engine::Vec3> past_;
    engine::Vec3 from_{};
    engine::Vec3 speed_{};
    engine::Vec3 force_{};
    engine::Vec3 waiting_{};
};

}  // namespace palpate::tests
