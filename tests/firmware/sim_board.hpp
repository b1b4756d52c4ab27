#pragma once

#include "engine/device/emulator/port_board.hpp"
#include "tests/support/std.hpp"

struct avr_t;

namespace palpate::tests {

/// A chip that the firmware was built for.
struct Chip {
    const char* name;  ///< "atmega328p"
    char encoder_port;
    int encoder_pin;  ///< of A1; B1, A2, B2 and so on follow
    char stop_port;
    int stop_pin;
    /// Addresses of registers in data memory, and bits in them.
    std::uint16_t enable_port, enable_direction;
    std::uint8_t enable;
    std::uint16_t sign_port;
    std::array<std::uint8_t, 3> sign;
    std::uint16_t
        connect;  ///< TCCRnA: bit 7 connects motor 1's pin, bit 5 motor 2's, bit 3 motor 3's
    std::array<std::uint16_t, 3> duty;
};

inline constexpr Chip kAtmega328p{.name = "atmega328p",
                                  .encoder_port = 'D',
                                  .encoder_pin = 2,
                                  .stop_port = 'C',
                                  .stop_pin = 0,
                                  .enable_port = 0x25,
                                  .enable_direction = 0x24,
                                  .enable = 1,
                                  .sign_port = 0x2B,
                                  .sign = {0x40, 0x80},
                                  .connect = 0x80,
                                  .duty = {0x88, 0x8A}};
inline constexpr Chip kAtmega2560{.name = "atmega2560",
                                  .encoder_port = 'B',
                                  .encoder_pin = 0,
                                  .stop_port = 'A',
                                  .stop_pin = 3,
                                  .enable_port = 0x22,
                                  .enable_direction = 0x21,
                                  .enable = 4,
                                  .sign_port = 0x22,
                                  .sign = {1, 2, 16},
                                  .connect = 0xA0,
                                  .duty = {0xA8, 0xAA, 0xAC}};

/// The very binary of the firmware in simavr, with a plant on its pins: bytes come and go at
/// 1,000,000 baud, encoders turn an edge at a time. Its time is that of its cycles.
class SimBoard : public engine::PortBoard {
public:
    /// @param plant  outlives the board
    /// @param elf    the firmware
    /// @throws std::runtime_error if it cannot be loaded
    SimBoard(engine::BoardPlant& plant,
             const engine::Calibration& machine,
             const engine::OpenWiring& wired,
             const Chip& chip,
             const std::string& elf);
    ~SimBoard() override;

    void receive(std::span<const std::uint8_t> bytes) override;
    void poll() override { pass(); }
    void pass() override;
    [[nodiscard]] std::size_t transmit(std::span<std::uint8_t> into) override;
    [[nodiscard]] bool has_input() const noexcept override { return false; }
    [[nodiscard]] double time() const noexcept override;
    void power_cycle() override;

    void hush(bool /*silent*/) override {}
    void press_stop(bool pressed) noexcept override { stop_pressed_ = pressed; }
    [[nodiscard]] bool enabled() const noexcept;
    [[nodiscard]] engine::Vec3 torque() const noexcept override {
        return {torque_of(0), torque_of(1), torque_of(2)};
    }
    /// The motor's PWM pin is connected, or held high.
    [[nodiscard]] bool driven(std::size_t channel) const noexcept;
    /// How often the chip began anew.
    [[nodiscard]] int resets() const noexcept { return resets_; }
    /// Cycles that the chip has run, and has slept of them.
    [[nodiscard]] std::uint64_t cycles() const noexcept;
    [[nodiscard]] std::uint64_t slept() const noexcept { return slept_; }
    /// Keeps the program's loop from running on, and its interrupts unless they stay.
    void hang(bool interrupts) noexcept;
    /// From now on an encoder turns by itself, whatever the plant does; 0: no more.
    void spin(std::size_t channel, double counts_per_second) noexcept {
        spun_[channel] = static_cast<double>(at_[channel]) + 0.5 * static_cast<double>(channel);
        spin_[channel] = counts_per_second;
    }
    /// Both lines of an encoder change at once, as no encoder does; it stays there.
    void jump(std::size_t channel);
    /// Counts that the pins have gone since the beginning, by channel.
    [[nodiscard]] std::int64_t edges(std::size_t channel) const noexcept { return at_[channel]; }

    /// Called by the simulator.
    void sent(std::uint8_t byte);
    void chunk();
    void slept_for(std::uint64_t cycles) noexcept { slept_ += cycles; }

private:
    void attach();
    void set_pins(char port, int first, int count, unsigned lines);
    void turn_encoders();
    [[nodiscard]] std::array<std::int64_t, 3> wanted() const;
    [[nodiscard]] double torque_of(std::size_t axis) const noexcept;

    engine::BoardPlant* plant_;
    engine::Calibration machine_;
    engine::OpenWiring wired_;
    Chip chip_;
    avr_t* avr_ = nullptr;
    std::deque<std::uint8_t> in_{};
    struct Due {
        std::uint64_t cycle = 0;
        std::uint8_t byte = 0;
    };
    std::deque<Due> out_{};
    std::array<std::int64_t, 3> zero_{};                  ///< the plant's counts at the beginning
    std::array<std::int64_t, 3> at_{};                    ///< where the pins are
    std::map<char, std::array<std::uint8_t, 2>> held_{};  ///< by port: which pins, and how
    std::array<double, 3> spin_{};                        ///< counts/s
    std::array<double, 3> spun_{};
    std::uint64_t target_ = 0;
    std::uint64_t next_chunk_ = 0;
    std::uint64_t slept_ = 0;
    std::uint64_t chunks_ = 0;
    bool stop_pressed_ = false;
    bool pressed_ = false;  ///< as its pin has it
    int resets_ = 0;
};

}  // namespace palpate::tests
