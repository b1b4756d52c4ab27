#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "engine/device/emulator/port_board.hpp"
#include "engine/device/gantry_plant.hpp"

namespace palpate::engine {

/// The handle of an emulated machine of three straight axes, on a board: held by a hand, or free.
///
/// The hand brings the handle home whenever the board is set up; it rests there, explores the patch
/// about the origin, comes home, and so on. It gives way as the hand of a SimulatedGantry does.
class GantryHand : public BoardPlant {
public:
    static constexpr double kRest = 3.0;    ///< s at home
    static constexpr double kSettle = 0.5;  ///< s, after the way home

    /// @param machine  with a gantry
    /// @param held     false: nobody holds the handle, and motors move it
    /// @throws std::invalid_argument for a machine without a gantry
    explicit GantryHand(const Calibration& machine, bool held = true);

    /// Somebody brings the handle there and lets go, m, or where a hand holds it keeps it there.
    /// @throws std::invalid_argument outside the workspace
    void bring(const Vec3& place);
    /// From now on its motors give `gain` times what is asked of them.
    void strengthen(double gain) noexcept { gain_ = Vec3(gain); }
    /// The same of one motor. @param motor  below 3
    void strengthen(std::size_t motor, double gain) noexcept {
        gain_[static_cast<int>(motor)] = gain;
    }
    /// The cables of two motors change places. @param one, other  below 3
    void swap_motors(std::size_t one, std::size_t other) noexcept {
        std::swap(moves_[one], moves_[other]);
    }
    /// It rubs and weighs so much from now on, N. @throws std::invalid_argument as
    /// GantryPlant::burden
    void burden(double friction, double weight) { plant_.burden(friction, weight); }
    [[nodiscard]] const GantryModel& model() const noexcept { return plant_.model(); }
    /// From now on a hand holds it where it is, until the board is set up again, or nobody does.
    void hold(bool held);
    /// A hand takes it at home, and explores.
    void explore();

    void set_torque(const Vec3& newton_metres) noexcept override;
    void advance(double seconds) noexcept override;
    /// rad from home
    [[nodiscard]] double angle(std::size_t axis) const noexcept override;
    void before_set_up() noexcept override;

    /// Where the handle truly is, object frame, m.
    [[nodiscard]] const Vec3& hip() const noexcept { return plant_.position(); }

private:
    GantrySpec machine_;
    bool held_;
    GantryPlant plant_;
    Vec3 force_{};  ///< N, of the motors
    Vec3 gain_{1.0};
    std::array<std::size_t, 3> moves_{0, 1, 2};  ///< which axis each motor moves
    double rested_ = 0.0;                        ///< s at home
    double settled_ = 0.0;                       ///< s after the way home
    bool explores_ = false;
    bool keeps_ = false;  ///< the hand that holds it stands still
};

}  // namespace palpate::engine
