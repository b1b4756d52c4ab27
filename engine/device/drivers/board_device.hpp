#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "engine/device/device.hpp"
#include "engine/device/drivers/board_line.hpp"
#include "engine/device/drivers/motor_guard.hpp"
#include "engine/device/machine.hpp"

namespace palpate::engine {

/// How long the driver of a board waits, s.
struct BoardTiming {
    double period = 1e-3;    ///< between ticks
    double patience = 0.5;   ///< share of the period that read() waits for an answer that is due
    double silence = 0.040;  ///< without an answer for this long the board counts as silent
    double still = 1.0;      ///< the handle rests for this long before its pose is taken for home
};

/// A machine on a board, a pantograph or three straight axes, that is asked once a tick, in
/// whatever language.
///
/// write() sends the torques, and a later read() collects the counts that the board measured when
/// it took them. How long answers take is measured when the board is opened (traits().round_trip):
/// d periods, rounded up, and so many questions are on their way at once. A reading is then d
/// periods old (traits().delay_ticks), and there is a new one every tick. If an answer comes later
/// than that, the reading is not fresh, or older than promised (Reading::behind). After that and
/// after every fault reconnect() measures again how long answers take. The first read() after a
/// rest asks once more, without a torque.
///
/// A fault is latched until reconnect(): from then on only zero torque is sent. No torque goes out
/// before the board has answered after its set-up, nor without a guard. Every way out, the
/// destructor's too, ends with the motors switched off.
///
/// The board knows counts since its set-up and nothing else. The pose at set-up is taken for
/// Calibration::home (without one, for count 0), so the handle must be there.
class BoardDevice : public Device {
public:
    /// Opens the link, gives it to the guard and sets the board up with the handle at home.
    /// @throws std::invalid_argument if the calibration does not describe such a board
    /// @throws std::runtime_error    if there is no port, no answer or no guard, with the remedy
    BoardDevice(const Calibration& calibration,
                std::unique_ptr<ByteLink> link,
                MakeLine make_line,
                std::unique_ptr<MotorGuard> guard,
                const BoardTiming& timing = {});
    ~BoardDevice() override;

    [[nodiscard]] Reading read() noexcept override;
    AppliedForce write(const Vec3& force) noexcept override;
    [[nodiscard]] std::string name() const override;
    [[nodiscard]] std::string identity() const override { return line_->identity(); }
    [[nodiscard]] DeviceTraits traits() const noexcept override;
    [[nodiscard]] std::optional<double> weakest_force(const Vec3& hip) const noexcept override {
        return machine_.weakest_force(hip);
    }
    [[nodiscard]] std::optional<double> reading_error(const Vec3& hip) const noexcept override {
        return machine_.reading_error(hip);
    }

    /// Zero torque needs a whole answer; without one the board is set up anew and gets zeros again,
    /// which loses the position as reconnect() says.
    bool prove_zero() noexcept override;
    void keep_off() noexcept override {
        if (left_) {
            line_->keep_off();
        }
    }
    /// Motors off first. If the board acknowledges it, its counts are still good and that is all.
    /// Otherwise the port is opened anew and the board set up again, which loses the position: then
    /// trouble() asks for the handle at home, and a later call takes the pose of a handle that
    /// rested.
    [[nodiscard]] bool reconnect() override;
    [[nodiscard]] std::size_t homings() const noexcept override { return homings_; }
    void forget_home() override {
        fault_ = DeviceFault::unreachable;
        homeless_ = home_asked_ = true;
    }
    [[nodiscard]] bool force_unproved() const override;
    [[nodiscard]] std::string trouble() const override {
        return warning() + (trouble_.empty() ? explained(fault_) : trouble_);
    }

    /// The handle may be elsewhere at the next read(): its first reading is asked for anew.
    void expect_move() noexcept { ask_anew_ = true; }

private:
    [[nodiscard]] bool mend();
    void take_over() noexcept;
    void leave() noexcept;
    [[nodiscard]] bool guarded();
    [[nodiscard]] bool open_board();
    [[nodiscard]] bool measure_answers();
    [[nodiscard]] bool answers_in_time();
    [[nodiscard]] bool rests();
    [[nodiscard]] BoardLine::Answer prime() noexcept;
    [[nodiscard]] Reading take(const BoardReply& reply) noexcept;
    void fail(DeviceFault fault) noexcept;
    [[nodiscard]] bool ask(const Vec3& torque) noexcept;
    void note_age(bool primed) noexcept;
    [[nodiscard]] double behind() const noexcept;
    [[nodiscard]] bool send_zero() noexcept;
    AppliedForce hold_off(const Vec3& force) noexcept;
    [[nodiscard]] std::string explained(DeviceFault fault) const;
    /// What to do first, while nothing has acknowledged zero torque.
    [[nodiscard]] std::string warning() const;

    Machine machine_;
    Machine::Counts bias_{};  ///< counts minus those of the board
    BoardTiming timing_;
    std::unique_ptr<ByteLink> link_;
    std::unique_ptr<MotorGuard> guard_;
    std::unique_ptr<BoardLine> line_;
    std::string trouble_;

    DeviceFault fault_ = DeviceFault::none;  ///< latched
    int zeros_left_ = 0;                     ///< zero packets still to be sent after a fault
    std::int64_t zeros_from_ns_ = 0;         ///< not before
    bool left_ = false;                      ///< nobody ticks: the guard repeats zeros
    bool zero_unproved_ = false;             ///< the board may keep its last torque
    bool homeless_ = false;                  ///< set up, but where the handle was is not known
    bool home_asked_ = false;                ///< trouble() asks for the handle at home
    std::size_t homings_ = 0;                ///< poses taken for home since it was opened
    double round_trip_ = 0.0;                ///< s, of the first set-up
    std::size_t depth_ = 0;                  ///< periods until an answer; 0: not measured yet
    bool ask_anew_ = true;
    std::uint64_t tick_ = 0;                    ///< read()s so far
    std::uint64_t asked_ = 0;                   ///< questions of write() so far
    std::array<std::uint64_t, 64> asked_at_{};  ///< ticks of the newest of them
    std::uint64_t measured_ = 0;                ///< tick of the question whose answer is last_
    /// A reading was older than promised, or a fault was mended, since answers were timed.
    bool was_late_ = false;
    Reading last_{};
    std::optional<Machine::Place> place_;
    AppliedForce applied_{};
};

}  // namespace palpate::engine
