#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <limits>
#include <span>
#include <vector>

#include "engine/device/emulator/port_board.hpp"

namespace palpate::engine {

/// What can go wrong between a board and its host.
struct BoardFaults {
    bool silent = false;  ///< no command is answered
    double delay = 0.0;   ///< s from a command to its answer
    int at_once = -1;     ///< bytes of an answer that come at once; -1: all
    double rest_delay = std::numeric_limits<double>::infinity();  ///< s until the others come
    std::vector<std::uint8_t> noise{};                            ///< comes before each answer
    bool wrong_id = false;    ///< the answer begins with another id
    double turned_deg = 0.0;  ///< the answer's last angle is off by this
    bool not_finite = false;  ///< the answer's last angle is NaN
};

/// What a test wants to know of a board.
struct BoardLog {
    int setups = 0;  ///< the firmware allocates new encoders each time: leaked ones
    int resets = 0;
    int hot_resets = 0;  ///< resets with a torque on, which nobody can zero then
    int exchanges = 0;   ///< of which `desyncs` moved no motor
    int desyncs = 0;     ///< exchanges whose id owns no motor: their torques are read as commands
    int unknown = 0;     ///< bytes that are no command, but for kHaplyNoCommand
    int missing = 0;     ///< bytes that were not there yet and read as 0xFF
    int undefined_duty = 0;  ///< torques that were not a number
    int id_0 = 0;            ///< exchanges with a torque that reached ports which were not set up
};

/// The firmware of a Haply board. Written from the protocol's table; it does all that the firmware
/// does wrong:
///
/// - no framing: one command a poll, and bytes that are not there yet read as 0xFF;
/// - no watchdog: a motor keeps its torque until the next exchange that reaches it;
/// - a reset clears the addresses and leaves the motors' duty on;
/// - an exchange whose id owns no motor takes no torque bytes, so that they are read as commands;
/// - id 0 reaches every port that was not set up;
/// - a torque that is not a number gives full duty (on the real board: anything);
/// - a set-up is not acknowledged, writes motor directions to slots 0, 1, ... whatever the ports
/// are,
///   and leaks an encoder object each time;
/// - torques are clamped at 0.123 N m and cut to 12 bits of duty.
class HaplyBoard : public PortBoard {
public:
    /// @param plant    outlives the board
    /// @param machine  resolution of the encoders as they are
    /// @param wired    how motors and encoders are wired in truth, whatever a set-up says
    HaplyBoard(BoardPlant& plant, const PantographSpec& machine, const HaplyWiring& wired);

    void poll() override;
    void pass() override;
    /// A poll now would fill the missing bytes with 0xFF.
    [[nodiscard]] bool command_is_cut() const noexcept override;
    [[nodiscard]] Vec3 torque() const noexcept override { return torque_; }
    /// s since it began, when the motors last got no torque any more.
    [[nodiscard]] double zero_since() const noexcept { return zero_since_; }
    [[nodiscard]] const BoardLog& journal() const noexcept { return log_; }

    void hush(bool silent) override { faults_ = {.silent = silent}; }
    /// All its faults at once, from the next exchange on.
    void set_faults(const BoardFaults& faults) { faults_ = faults; }
    /// Each answer goes out so many s after it was asked for.
    void delay_answers(double seconds) noexcept { faults_.delay = seconds; }
    /// The last encoder's disc has slipped on its shaft by so much.
    void turn_answers(double degrees) noexcept { faults_.turned_deg = degrees; }
    /// Each answer says where the handle was so many answers before: a firmware that lags, in time.
    void age_answers(std::size_t answers) noexcept { age_ = answers; }
    /// The first byte of the next exchange arrives as that of a reset: one bit is wrong.
    void misread_next() noexcept { misread_ = true; }
    /// Another program that has the port open says so many times, one each ms, what torque it
    /// wants.
    void meddle(int packets) noexcept { meddling_ = packets; }
    void set_sensor(double adc) noexcept { sensor_ = adc; }
    void power_cycle() override;

private:
    static constexpr std::size_t kPorts = 4;

    /// One of the four ports; two have a pivot.
    struct Motor {
        std::uint8_t address = 0;
        bool clockwise = false;
    };
    struct Encoder {
        std::uint8_t address = 0;
        bool clockwise = false;
        double resolution = 1.0;
        double preset = 0.0;    ///< counts
        std::int64_t zero = 0;  ///< true counts at set-up
    };

    std::uint8_t take() noexcept;
    float take_float() noexcept;
    void reset();
    void take_pins(std::vector<std::uint8_t>& pins);
    void set_up();
    void exchange();
    void drive(std::size_t port, float torque) noexcept;
    [[nodiscard]] double angle(std::size_t port, std::int64_t count) const noexcept;
    [[nodiscard]] int pivot_at(std::size_t port) const noexcept;
    [[nodiscard]] std::int64_t true_count(std::size_t port) const noexcept;
    void answer(std::uint8_t id);
    void hear_stranger();

    BoardPlant* plant_;
    PantographSpec machine_;
    HaplyWiring wired_;
    BoardFaults faults_{};
    BoardLog log_{};
    bool misread_ = false;
    std::size_t age_ = 0;
    std::deque<std::array<std::int64_t, kPorts>> counts_{};  ///< of the last answers
    int meddling_ = 0;
    double zero_since_ = 0.0;
    double sensor_ = 0.0;
    std::array<Motor, kPorts> motors_{};
    std::array<Encoder, kPorts> encoders_{};
    std::vector<std::uint8_t> sensors_{};
    std::vector<std::uint8_t> pwm_{};
    Vec3 torque_{};
};

}  // namespace palpate::engine
