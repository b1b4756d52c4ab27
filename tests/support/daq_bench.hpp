#pragma once

#include "engine/device/drivers/comedi_device.hpp"
#include "tests/support/std.hpp"

namespace palpate::tests {

/// A card in memory. It lives on when the driver is gone, as a real one does.
struct DaqBench {
    std::array<std::uint32_t, 2> counter{};
    std::uint32_t counter_top = 0xFFFFFF;
    engine::DaqCard::Output output{.min = -10.0, .max = 10.0, .top = 65535};
    std::array<std::uint32_t, 2> code{12345, 54321};  ///< what a program before us left
    std::vector<std::uint32_t> range_used;
    bool is_open = false;
    int opened = 0;
    int open_error = 0;
    int calls = 0;          ///< of a running driver: reads and writes
    int failing_call = -1;  ///< this one and `failing_calls` from it on fail with `error`
    int failing_calls = 1;
    int error = ENODEV;

    int step() {
        const int call = calls++;
        const bool fails =
            failing_call >= 0 && call >= failing_call && call < failing_call + failing_calls;
        return fails ? error : 0;
    }
};

class FakeCard : public engine::DaqCard {
public:
    FakeCard(DaqBench& bench, const engine::ComediWiring& wiring)
        : bench_(bench), wiring_(wiring) {}
    int open() noexcept override {
        ++bench_.opened;
        bench_.is_open = bench_.open_error == 0;
        return bench_.open_error;
    }
    void close() noexcept override { bench_.is_open = false; }
    int prepare_counter(std::size_t axis, std::uint32_t& top) noexcept override {
        top = bench_.counter_top;
        return wiring_.counter_subdevice == 4 && wiring_.counter[axis] < 2 ? 0 : EINVAL;
    }
    int prepare_output(std::size_t axis, Output& output) noexcept override {
        const std::uint32_t channel = wiring_.output[axis];
        output = bench_.output;
        return wiring_.output_subdevice == 1 && channel >= 2 && channel < 4 ? 0 : EINVAL;
    }
    int read_counter(std::size_t axis, std::uint32_t& value) noexcept override {
        value = bench_.counter.at(wiring_.counter[axis]);
        return bench_.is_open ? bench_.step() : EBADF;
    }
    int write_output(std::size_t axis, std::uint32_t code) noexcept override {
        const int error = bench_.is_open ? bench_.step() : EBADF;
        if (error == 0) {
            bench_.code.at(wiring_.output[axis] - 2) = code;
            bench_.range_used.push_back(wiring_.range);
        }
        return error;
    }
    std::string name() const override { return "/dev/comedi7"; }
    std::string explain(int error) const override { return "error " + std::to_string(error); }

private:
    DaqBench& bench_;
    engine::ComediWiring wiring_;
};

inline engine::Calibration daq_calibration() {
    engine::Calibration all;
    all.comedi = engine::ComediWiring{.counter_subdevice = 4,
                                      .counter = {0, 1},
                                      .output_subdevice = 1,
                                      .output = {2, 3},
                                      .range = 3,
                                      .volts_per_newton_metre = {10.0, -8.0},
                                      .counter_clockwise = {false, true}};
    all.home = engine::Vec2{0.0, 0.060};
    return all;
}

inline std::unique_ptr<engine::ComediDevice> plug(
    DaqBench& bench, const engine::Calibration& how = daq_calibration()) {
    return std::make_unique<engine::ComediDevice>(
        std::make_unique<FakeCard>(bench, how.comedi.value_or(engine::ComediWiring{})), how);
}

inline double volts_of(const DaqBench& bench, std::size_t axis) {
    return bench.output.min +
           bench.code[axis] * (bench.output.max - bench.output.min) / bench.output.top;
}

inline bool at_zero(const DaqBench& bench) {
    const double half_code = 0.5 * (bench.output.max - bench.output.min) / bench.output.top;
    return std::fabs(volts_of(bench, 0)) <= half_code * (1.0 + 1e-9) &&
           std::fabs(volts_of(bench, 1)) <= half_code * (1.0 + 1e-9);
}

}  // namespace palpate::tests
