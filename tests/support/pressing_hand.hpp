#pragma once

#include <cmath>

#include "engine/device/emulator/emulated_board.hpp"
#include "engine/device/pantograph.hpp"

namespace palpate::tests {

/// A hand on an emulated board that no torque moves: it rests where the board is set up, then goes
/// to the left side of a straight object and does one thing there for ever.
class PressingHand : public engine::BoardHand {
public:
    enum class Does : std::uint8_t {
        presses,    ///< 5 mm inside, to and fro along it at 0.5 Hz
        buzzes,     ///< the same, with 3.5 mm of swing at 18 Hz
        runs_away,  ///< comes slowly, and at 8 mm goes deeper at 0.25 m/s; again and again
    };
    static constexpr double kRest = 3.0;  ///< s at home; a reconnection looks for one of rest

    PressingHand(const engine::Calibration& machine, Does does)
        : pantograph_(machine.pantograph), does_(does) {
        home_ =
            machine.home ? pantograph_.reach(*machine.home).value() : pantograph_.angles({0, 0});
        start_ = pantograph_.locate(home_).value().hip;
        angles_ = home_;
    }

    void begin(const engine::Exploration& /*plan*/) override {}
    [[nodiscard]] bool hand_is_done() const noexcept override { return false; }
    void set_torque(const engine::Vec3& /*newton_metres*/) noexcept override {}
    void before_set_up() noexcept override {
        angles_ = home_;
        time_ = 0.0;
    }
    void advance(double seconds) noexcept override {
        time_ += seconds;
        if (time_ > kRest) {
            angles_ = pantograph_.reach(place(time_ - kRest)).value_or(angles_);
        }
    }
    [[nodiscard]] double angle(std::size_t axis) const noexcept override { return angles_[axis]; }

private:
    /// @param t  s since it left its home
    [[nodiscard]] engine::Vec2 place(double t) const noexcept {
        constexpr double kGlide = 1.0;  // s
        const double along = 0.004 * std::sin(3.141592653589793 * t);
        const double s = std::sqrt(0.5);
        const engine::Vec2 inwards{s, -s};
        const engine::Vec2 there =
            engine::Vec2{-0.02, 0.02} + along * engine::Vec2{s, s} + depth(t) * inwards;
        const double share = std::fmin(t / kGlide, 1.0);
        return start_ + share * share * (3.0 - 2.0 * share) * (there - start_);
    }
    [[nodiscard]] double depth(double t) const noexcept {
        switch (does_) {
            case Does::presses:
                break;
            case Does::buzzes:
                return 0.003 + 0.00175 * std::sin(18.0 * 6.283185307179586 * t);
            case Does::runs_away: {
                const double round = std::fmod(t, 1.4);  // s
                const double in = std::fmin(0.04 * round, 0.028) +
                                  0.25 * std::fmin(std::fmax(0.0, round - 0.7), 0.06);
                return -0.020 + in - 0.086 * std::fmax(0.0, round - 0.9);
            }
        }
        return 0.005;
    }

    engine::Pantograph pantograph_;
    Does does_;
    engine::JointAngles home_{};
    engine::JointAngles angles_{};
    engine::Vec2 start_{};
    double time_ = 0.0;
};

}  // namespace palpate::tests
