#pragma once

#include <string>

#include "engine/device/emulator/emulated_board.hpp"
#include "engine/realtime/thread_servo.hpp"
#include "protocols/trial/servo_apparatus.hpp"

namespace palpate::protocols {

/// An emulated board of `machine` with a simulated hand on it, and its driver, patient as a machine
/// that is busy needs it.
/// @param period  s between ticks   @param link  see engine::PtyBoard
/// @throws as engine::EmulatedHaply
[[nodiscard]] engine::EmulatedHaply emulated_haply(const engine::Calibration& machine,
                                                   double period,
                                                   const std::string& link = {});

/// An emulated Haply board with a simulated hand on it, in real time over a serial port: everything
/// that a session on a real board does, without one. Board and guard are processes of their own;
/// make it before threads.
class EmulatedHaplyApparatus : public ServoApparatus {
public:
    /// Late ticks and stale readings are recorded but trip nothing: nobody holds this handle.
    /// @param spin_share  see engine::ServoSpec
    /// @param link  see engine::PtyBoard; needed to unplug the board
    /// @throws as engine::EmulatedHaply
    EmulatedHaplyApparatus(const Protocol& protocol,
                           DrawnHand hand,
                           const engine::Calibration& machine,
                           double spin_share = 0.0,
                           const std::string& link = {});

    /// The handle is at the start, the hand sets off.
    void begin(const engine::SceneView& scene, std::size_t position, std::size_t interval) override;
    [[nodiscard]] bool hand_is_done() const noexcept override { return haply_.hand_is_done(); }
    [[nodiscard]] bool reconnect() override {
        servo_.park();
        return haply_.device().reconnect();
    }
    [[nodiscard]] std::string trouble() const override { return haply_.device().trouble(); }
    [[nodiscard]] bool force_unproved() const override { return haply_.device().force_unproved(); }
    [[nodiscard]] std::string device_name() const override { return "emulated " + device().name(); }
    /// The other end of the cable.
    [[nodiscard]] engine::EmulatedBoard& board() noexcept { return haply_.board(); }

private:
    DrawnHand hand_;
    engine::EmulatedHaply haply_;
    engine::ThreadServo servo_;
};

}  // namespace palpate::protocols
