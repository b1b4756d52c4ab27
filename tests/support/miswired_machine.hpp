#pragma once

#include "engine/commissioning/commissioning.hpp"
#include "engine/device/emulator/hands.hpp"
#include "tests/support/std.hpp"

namespace palpate::tests {

/// Somebody who brings the handle wherever it is wanted, and lets a tick pass when waited for.
template <class Bring, class Tick>
engine::CommissioningDesk attended(Bring bring, Tick tick, double period = 1e-3) {
    return {.bring =
                [bring](const engine::Vec3& place) mutable {
                    bring(place);
                    return true;
                },
            .wait =
                [tick]() mutable {
                    tick();
                    return true;
                },
            .period = period};
}

/// What a refusal should name of the motors, or should not; empty: nothing.
inline std::string misnamed(const std::string& refused, const engine::Connection& motors) {
    std::string wrong;
    const auto names = [&](const std::string& words, bool is_so) {
        wrong += (refused.find(words) != std::string::npos) == is_so ? "" : words + ", ";
    };
    names("swapped", motors.swapped);
    names("motor 1 is reversed", motors.factor[0] < 0.0);
    names("motor 2 is reversed", motors.factor[1] < 0.0);
    return wrong;
}

/// A free handle on a machine whose motors and encoders are not connected as its calibration says,
/// on a virtual clock: a torque written at one tick acts from the next one on.
class MiswiredMachine : public engine::Device {
public:
    /// @param plant  the machine as it is, with what its motors and its handle are
    MiswiredMachine(const engine::PlantModel& plant,
                    const engine::Connection& encoders,
                    const engine::Connection& motors,
                    double period = 1e-3)
        : machine_(plant.machine),
          plant_(free_handle(plant)),
          encoders_(encoders),
          motors_(motors),
          period_(period) {}

    /// A person brings the handle there and lets go.
    void bring(const engine::Vec2& place) {
        plant_.begin({.start = place, .tremor = 0.0});
        brought_ = place;
        past_.clear();
        acting_ = {};
        if (!homed_) {
            home_ = zero_ = plant_.angles();
            homed_ = true;
        }
    }
    [[nodiscard]] const engine::PantographPlant& plant() const { return plant_; }
    /// The last torque written was not zero.
    [[nodiscard]] bool pushes() const { return waiting_ != engine::Vec2{}; }
    /// The most torque that the motors ever gave, N m.
    [[nodiscard]] double strongest() const { return strongest_; }
    /// The most force that was ever asked for, N.
    [[nodiscard]] double max_asked() const { return max_asked_; }

    /// From now on a cable pulls the handle back to where it is brought, N/m.
    void tie(double stiffness) { cable_ = stiffness; }
    /// From now on a drag grows with the square of its speed, N s^2/m^2.
    void dip(double drag) { drag_ = drag; }
    /// From now on its answers are so many ticks older than they should be.
    void lag(std::size_t ticks) { lag_ = ticks; }
    /// It falls silent, and takes the pose in which it is opened anew for home.
    void fall_silent() { silent_ = true; }
    [[nodiscard]] bool reconnect() override {
        zero_ = silent_ ? plant_.angles() : zero_;
        silent_ = false;
        return true;
    }

    [[nodiscard]] engine::Reading read() noexcept override {
        plant_.set_torque(acting_ + pulled());
        const auto before = machine_.locate(plant_.angles());
        plant_.advance(period_);
        const auto after = machine_.locate(plant_.angles());
        speed_ = before && after ? (after->hip - before->hip) / period_ : engine::Vec2{};
        engine::Reading reading;
        if (silent_) {
            reading.fault = engine::DeviceFault::silent;
            return reading;
        }
        const auto at_home = machine_.counts(home_);
        past_.push_back(plant_.angles());
        while (past_.size() > lag_ + 1) {
            past_.pop_front();
        }
        for (std::size_t i = 0; i < 2; ++i) {
            const std::size_t joint = encoders_.swapped ? 1 - i : i;
            const double turned =
                (past_.front()[joint] - zero_[joint]) / machine_.spec().axes[joint].count_angle();
            reading.counts[i] = at_home[i] + static_cast<std::int32_t>(
                                                 std::floor(turned * encoders_.factor[i] + 0.5));
        }
        fix_ = machine_.locate(machine_.angles(reading.counts));
        if (fix_) {
            reading.hip = engine::Vec3(fix_->hip, 0.0);
        } else {
            reading.fault = engine::DeviceFault::unreachable;
        }
        return reading;
    }
    engine::AppliedForce write(const engine::Vec3& force) noexcept override {
        max_asked_ = std::fmax(max_asked_, glm::length(force));
        const engine::Vec2 asked =
            fix_ ? engine::Vec2(machine_.drive(*fix_, engine::Vec2(force)).torque) : engine::Vec2{};
        engine::Vec2 given{};
        for (int i = 0; i < 2; ++i) {
            given[i] =
                motors_.factor[static_cast<std::size_t>(i)] * asked[motors_.swapped ? 1 - i : i];
        }
        strongest_ = std::fmax(strongest_, std::fmax(std::fabs(given.x), std::fabs(given.y)));
        acting_ = waiting_;
        waiting_ = given;
        return {};
    }
    [[nodiscard]] std::string name() const override { return "a miswired machine"; }
    [[nodiscard]] engine::DeviceTraits traits() const noexcept override {
        return {.delay_ticks = 1.0 + plant_.model().current_time / period_};
    }

private:
    static engine::PlantModel free_handle(engine::PlantModel plant) {
        plant.hand = engine::kNobody;
        return plant;
    }
    /// N m of the cable and the drag.
    [[nodiscard]] engine::Vec2 pulled() const noexcept {
        const auto fix = machine_.locate(plant_.angles());
        return fix ? fix->jacobian.transposed(cable_ * (brought_ - fix->hip) -
                                              drag_ * glm::length(speed_) * speed_)
                   : engine::Vec2{};
    }

    engine::Pantograph machine_;
    engine::PantographPlant plant_;
    engine::Connection encoders_;
    engine::Connection motors_;
    double period_;
    engine::JointAngles home_{};
    engine::JointAngles zero_{};  ///< where it counts as at home
    bool silent_ = false;
    bool homed_ = false;
    std::optional<engine::Pantograph::Fix> fix_{};
    engine::Vec2 waiting_{};
    engine::Vec2 acting_{};
    engine::Vec2 brought_{};
    double cable_ = 0.0;  ///< N/m
    double drag_ = 0.0;   ///< N s^2/m^2
    engine::Vec2 speed_{};
    std::deque<engine::JointAngles> past_;
    std::size_t lag_ = 0;
    double strongest_ = 0.0;
    double max_asked_ = 0.0;
};

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

    void bring(const engine::Vec2& place) { handle_.put(place); }
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
