#include "tests/firmware/sim_board.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#include <simavr/avr_extint.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_io.h>

#ifdef PALPATE_SANITIZED
/// What simavr never frees is not ours.
extern "C" [[gnu::visibility("default")]] const char* __lsan_default_suppressions() {
    return "leak:libsimavr\n";
}
#endif

namespace palpate::tests {
namespace {

constexpr std::uint64_t kHz = 16'000'000;
constexpr std::uint64_t kByte = 160;  ///< cycles of 10 bits at 1,000,000 baud
constexpr std::uint64_t kPoll = 800;  ///< of 50 us

void say_nothing(avr_t* /*avr*/, const int /*level*/, const char* /*format*/, va_list /*list*/) {}

void on_byte(avr_irq_t* /*irq*/, std::uint32_t value, void* board) {
    static_cast<SimBoard*>(board)->sent(static_cast<std::uint8_t>(value));
}

avr_cycle_count_t on_chunk(avr_t* /*avr*/, avr_cycle_count_t when, void* board) {
    static_cast<SimBoard*>(board)->chunk();
    return when + kByte;
}

SimBoard* sleeper = nullptr;  ///< simavr's sleep knows no parameter

void sleep_without_sleeping(avr_t* /*avr*/, avr_cycle_count_t cycles) {
    sleeper->slept_for(cycles);
}

/// One edge of a quadrature encoder: A is bit 0, B bit 1, and A leads.
std::uint8_t lines_at(std::int64_t count) {
    constexpr std::array<std::uint8_t, 4> kLines{0, 1, 3, 2};
    return kLines[static_cast<std::size_t>(count & 3)];
}

avr_uart_t* uart_of(avr_t* avr) {
    for (avr_io_t* io = avr->io_port; io != nullptr; io = io->next) {
        auto* uart = reinterpret_cast<avr_uart_t*>(io);
        if (std::strcmp(io->kind, "uart") == 0 && uart->name == '0') {
            return uart;
        }
    }
    return nullptr;
}

}  // namespace

SimBoard::SimBoard(engine::BoardPlant& plant,
                   const engine::Calibration& machine,
                   const engine::OpenWiring& wired,
                   const Chip& chip,
                   const std::string& elf)
    : plant_(&plant), machine_(machine), wired_(wired), chip_(chip) {
    avr_global_logger_set(say_nothing);
    elf_firmware_t firmware{};
    avr_ =
        elf_read_firmware(elf.c_str(), &firmware) == 0 ? avr_make_mcu_by_name(chip.name) : nullptr;
    if (avr_ == nullptr) {
        throw std::runtime_error("simavr does not load " + elf);
    }
    avr_init(avr_);
    avr_->frequency = kHz;
    firmware.frequency = kHz;
    avr_load_firmware(avr_, &firmware);
    avr_->sleep = sleep_without_sleeping;
    std::uint32_t flags = 0;
    avr_ioctl(avr_, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    avr_irq_register_notify(avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
                            on_byte, this);
    zero_ = wanted();
    attach();
}

SimBoard::~SimBoard() {
    avr_terminate(avr_);
    std::free(avr_);
}

/// After a reset the simulator has forgotten timers and levels.
void SimBoard::attach() {
    for (int i = 0; i < 8; ++i) {
        avr_extint_set_strict_lvl_trig(avr_, static_cast<std::uint8_t>(i), 0);
    }
    for (std::size_t channel = 0; channel < machine_.axes(); ++channel) {
        set_pins(chip_.encoder_port, chip_.encoder_pin + 2 * static_cast<int>(channel), 2,
                 lines_at(at_[channel]));
    }
    pressed_ = stop_pressed_;
    set_pins(chip_.stop_port, chip_.stop_pin, 1, pressed_ ? 1 : 0);
    next_chunk_ = avr_->cycle + kByte;
    avr_cycle_timer_register(avr_, kByte, on_chunk, this);
}

/// Bits of `lines` on so many pins at once, held against the pull-up, which simavr would let win at
/// each write of a port.
void SimBoard::set_pins(char port, int first, int count, unsigned lines) {
    auto& [mask, value] = held_[port];
    const unsigned pins = ((1U << static_cast<unsigned>(count)) - 1U) << first;
    mask = static_cast<std::uint8_t>(mask | pins);
    value = static_cast<std::uint8_t>((value & ~pins) | lines << first);
    avr_ioport_external_t external{};
    external.name = static_cast<unsigned char>(port);
    external.mask = mask;
    external.value = value;
    avr_ioctl(avr_, AVR_IOCTL_IOPORT_SET_EXTERNAL(port), &external);
    for (int i = 0; i < count; ++i) {
        avr_raise_irq(avr_io_getirq(avr_, AVR_IOCTL_IOPORT_GETIRQ(port), first + i),
                      lines >> i & 1);
    }
}

std::array<std::int64_t, 3> SimBoard::wanted() const {
    std::array<std::int64_t, 3> counts{};
    for (std::size_t i = 0; i < machine_.axes(); ++i) {
        const std::size_t channel = wired_.channel[i] - 1U;
        const double turns = plant_->angle(i) / (2.0 * engine::kPi);
        const auto count =
            static_cast<std::int64_t>(std::floor(turns * machine_.axis(i).counts_per_turn + 0.5));
        counts[channel] = (wired_.encoder_clockwise[i] ? -count : count) - zero_[channel];
    }
    return counts;
}

/// After a plant that jumps at 25,000 counts/s; a spin has its own speed.
void SimBoard::turn_encoders() {
    const bool follows = ++chunks_ % 4 == 0;
    auto goal = follows ? wanted() : at_;
    for (std::size_t channel = 0; channel < machine_.axes(); ++channel) {
        if (spin_[channel] != 0.0) {
            spun_[channel] +=
                spin_[channel] * static_cast<double>(kByte) / static_cast<double>(kHz);
            goal[channel] = static_cast<std::int64_t>(std::floor(spun_[channel]));
        }
        if (goal[channel] == at_[channel]) {
            continue;
        }
        const std::uint8_t before = lines_at(at_[channel]);
        at_[channel] += goal[channel] > at_[channel] ? 1 : -1;
        const unsigned now = lines_at(at_[channel]);
        const int line = (before ^ now) >> 1U;
        set_pins(chip_.encoder_port, chip_.encoder_pin + 2 * static_cast<int>(channel) + line, 1,
                 now >> line & 1U);
    }
}

void SimBoard::jump(std::size_t channel) {
    at_[channel] += 2;
    spin_[channel] = 1e-9;
    spun_[channel] = static_cast<double>(at_[channel]) + 0.5;
    set_pins(chip_.encoder_port, chip_.encoder_pin + 2 * static_cast<int>(channel), 2,
             lines_at(at_[channel]));
}

void SimBoard::sent(std::uint8_t byte) {
    out_.push_back({avr_->cycle + kByte, byte});
}

/// Every 10 us: a byte of the host, an edge of each encoder.
void SimBoard::chunk() {
    next_chunk_ = avr_->cycle + kByte;
    if (avr_uart_t* uart = uart_of(avr_)) {
        uart->cycles_per_byte = kByte;  // simavr reckons with 11 bits
    }
    if (!in_.empty()) {
        avr_raise_irq(avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT), in_.front());
        in_.pop_front();
    }
    if (pressed_ != stop_pressed_) {
        pressed_ = stop_pressed_;
        set_pins(chip_.stop_port, chip_.stop_pin, 1, pressed_ ? 1 : 0);
    }
    turn_encoders();
}

void SimBoard::pass() {
    target_ += kPoll;
    sleeper = this;
    while (avr_->cycle < target_) {
        avr_run(avr_);
        if (avr_->cycle > next_chunk_ + 4 * kByte) {
            ++resets_;
            attach();
        }
    }
    plant_->set_torque(torque());
    plant_->advance(kPollPeriod);
}

void SimBoard::receive(std::span<const std::uint8_t> bytes) {
    in_.insert(in_.end(), bytes.begin(), bytes.end());
}

std::size_t SimBoard::transmit(std::span<std::uint8_t> into) {
    std::size_t sent = 0;
    while (sent < into.size() && !out_.empty() && out_.front().cycle <= avr_->cycle) {
        into[sent++] = out_.front().byte;
        out_.pop_front();
    }
    return sent;
}

double SimBoard::time() const noexcept {
    return static_cast<double>(target_) / static_cast<double>(kHz);
}

std::uint64_t SimBoard::cycles() const noexcept {
    return avr_->cycle;
}

void SimBoard::power_cycle() {
    in_.clear();
    out_.clear();
    avr_reset(avr_);
    attach();
}

/// The program stands on an instruction that jumps to itself.
void SimBoard::hang(bool interrupts) noexcept {
    avr_->sreg[S_I] = interrupts ? 1 : 0;
    avr_->state = cpu_Running;
    const std::uint32_t at = avr_->pc;
    avr_->flash[at] = 0xFF;  // rjmp .-2
    avr_->flash[at + 1] = 0xCF;
}

bool SimBoard::enabled() const noexcept {
    return (avr_->data[chip_.enable_port] & avr_->data[chip_.enable_direction] & chip_.enable) != 0;
}

bool SimBoard::driven(std::size_t channel) const noexcept {
    return (avr_->data[chip_.connect] & (0x80 >> 2 * channel)) != 0;
}

double SimBoard::torque_of(std::size_t axis) const noexcept {
    constexpr double kSteps = 800.0;
    if (axis >= machine_.axes() || !enabled() || !driven(wired_.channel[axis] - 1U)) {
        return 0.0;
    }
    const std::size_t channel = wired_.channel[axis] - 1U;
    const std::uint16_t at = chip_.duty[channel];
    const int duty = avr_->data[at] + 256 * avr_->data[at + 1] + 1;
    const bool negative = (avr_->data[chip_.sign_port] & chip_.sign[channel]) != 0;
    const double size = machine_.axis(axis).torque_limit * duty / kSteps;
    return negative != wired_.motor_clockwise[axis] ? -size : size;
}

}  // namespace palpate::tests

#pragma GCC diagnostic pop
