#pragma once

#include <cmath>
#include <deque>

#include "engine/commissioning/encoder_proof.hpp"
#include "engine/device/emulator/hands.hpp"

namespace palpate::tests {

/// A free handle whose encoders and motors hang on a board as `encoders` and `motors` say.
class MiswiredHandle : public engine::BoardPlant {
public:
    /// At home. @param machine  has one
    MiswiredHandle(const engine::Calibration& machine,
                   const engine::Connection& encoders,
                   const engine::Connection& motors)
        : encoders_(encoders), motors_(motors), handle_(plant_of(machine), *machine.home) {
        home_ = handle_.angles();
    }

    void bring(const engine::Vec2& place) { handle_.bring(place); }
    /// Somebody changes plugs.
    void connect(const engine::Connection& encoders, const engine::Connection& motors) {
        encoders_ = encoders;
        motors_ = motors;
    }
    /// The disc of an encoder slips on its shaft, rad.
    void slip(std::size_t joint, double angle) noexcept { slipped_[joint] += angle; }
    /// From now on its answers are of so long ago, s.
    void lag(double seconds) noexcept { lag_ = seconds; }
    [[nodiscard]] engine::JointAngles true_angles() const noexcept { return handle_.angles(); }

    void set_torque(const engine::Vec3& torque) noexcept override {
        asked = std::fmax(asked, glm::length(torque));
        const auto [one, two] =
            motors_.swapped ? std::array{torque.y, torque.x} : std::array{torque.x, torque.y};
        handle_.set_torque({motors_.factor[0] * one, motors_.factor[1] * two, 0.0});
    }
    void advance(double seconds) noexcept override {
        handle_.advance(seconds);
        time_ += seconds;
        if (lag_ == 0.0) {
            past_.clear();
            return;
        }
        past_.push_back({time_, handle_.angles()});
        while (past_.size() > 1 && past_[1].first <= time_ - lag_) {
            past_.pop_front();
        }
    }
    [[nodiscard]] double angle(std::size_t axis) const noexcept override {
        const engine::JointAngles& now = past_.empty() ? handle_.angles() : past_.front().second;
        const std::size_t joint = encoders_.swapped ? 1 - axis : axis;
        return home_[axis] +
               (encoders_.factor[axis] * (now[joint] - home_[joint]) + slipped_[axis]);
    }
    double asked = 0.0;  ///< the most torque that the motors were asked to give, N m

private:
    static engine::PlantModel plant_of(const engine::Calibration& machine) {
        engine::PlantModel plant;
        plant.machine = machine.pantograph;
        return plant;
    }

    engine::Connection encoders_;
    engine::Connection motors_;
    engine::FreeHandle handle_;
    engine::JointAngles home_{};
    engine::JointAngles slipped_{};
    double lag_ = 0.0;
    double time_ = 0.0;
    std::deque<std::pair<double, engine::JointAngles>> past_;
};

}  // namespace palpate::tests
