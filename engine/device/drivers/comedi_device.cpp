#include "engine/device/drivers/comedi_device.hpp"

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include "engine/base/refuse.hpp"

namespace palpate::engine {
namespace {

/// Bits below this wrap within a stroke.
constexpr std::uint32_t kMinCounter = 0xFFFF;

ComediWiring comedi_wiring(const Calibration& calibration) {
    refuse_if(!calibration.comedi,
              "the calibration {} says nothing of a DAQ card: add its table [comedi]",
              calibration.pantograph.name);
    for (const double gain : calibration.comedi->volts_per_newton_metre) {
        refuse_if(!(std::fabs(gain) > 0.0) || !std::isfinite(gain),
                  "volts_per_newton_metre is {:f}: give a number other than 0", gain);
    }
    refuse_if(calibration.home && !Pantograph(calibration.pantograph).reach(*calibration.home),
              "the home of {} is out of its reach: calibrate again", calibration.pantograph.name);
    return *calibration.comedi;
}

DeviceFault fault_of(int error) noexcept {
    switch (error) {
        case EAGAIN:
        case EBUSY:
        case EINTR:
        case ETIME:
        case ETIMEDOUT:
            return DeviceFault::silent;
        default:
            return DeviceFault::lost;
    }
}

/// A counter's value around 0 as people count: 2^bits - 1 is -1.
std::int64_t as_signed(std::uint32_t value, std::uint32_t top) noexcept {
    const auto wide = static_cast<std::int64_t>(value);
    return value > top / 2 ? wide - static_cast<std::int64_t>(top) - 1 : wide;
}

std::string volts(double value) {
    std::string text = std::to_string(value);
    text.erase(text.find_last_not_of('0') + 1);
    return (text.ends_with('.') ? text.substr(0, text.size() - 1) : text) + " V";
}

}  // namespace

ComediDevice::ComediDevice(std::unique_ptr<DaqCard> card, const Calibration& calibration)
    : card_(std::move(card)),
      calibration_(calibration),
      wiring_(comedi_wiring(calibration)),
      pantograph_(calibration.pantograph) {
    const std::string problem = start();
    if (!problem.empty()) {
        shut();
        throw std::runtime_error(problem);
    }
}

ComediDevice::~ComediDevice() {
    shut();
}

void ComediDevice::shut() noexcept {
    if (open_) {
        silence();
        card_->close();
        open_ = false;
    }
}

std::string ComediDevice::start() {
    shut();
    fix_.reset();
    channels_ = {};
    if (const int error = card_->open(); error != 0) {
        return refused(error);
    }
    open_ = true;
    PantographSpec spec = calibration_.pantograph;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        if (std::string problem = prepare(axis); !problem.empty()) {
            return problem;
        }
        const DaqCard::Output& output = channels_[axis].output;
        const double reach = std::fmin(output.max, -output.min);
        Axis& motor = spec.axes[axis];
        motor.torque_limit =
            std::fmin(motor.torque_limit, reach / std::fabs(wiring_.volts_per_newton_metre[axis]));
        motor.torque_forever = std::fmin(motor.torque_forever, motor.torque_limit);
        channels_[axis].volts =
            motor.torque_limit * std::fabs(wiring_.volts_per_newton_metre[axis]);
    }
    pantograph_ = Pantograph(spec);
    if (calibration_.home) {
        const Pantograph::Counts home = pantograph_.counts(*pantograph_.reach(*calibration_.home));
        for (std::size_t axis = 0; axis < 2; ++axis) {
            channels_[axis].offset = home[axis] - counted(axis);
        }
    }
    fault_ = DeviceFault::none;
    error_ = 0;
    return {};
}

/// Output first: whatever a program before us left there ends now.
std::string ComediDevice::prepare(std::size_t axis) {
    Channel& channel = channels_[axis];
    DaqCard::Output output;
    int error = card_->prepare_output(axis, output);
    if (error != 0) {
        return refused(error);
    }
    if (!(output.min < 0.0 && output.max > 0.0) || output.top == 0) {
        return card_->name() + ": range " + std::to_string(wiring_.range) + " of output " +
               std::to_string(wiring_.output[axis]) + " goes from " + volts(output.min) + " to " +
               volts(output.max) + ": choose one with both signs in the calibration";
    }
    channel.output = output;
    channel.zero = code(axis, 0.0);
    error = card_->write_output(axis, channel.zero);
    if (error == 0) {
        error = card_->prepare_counter(axis, channel.counter_top);
    }
    if (error == 0) {
        error = card_->read_counter(axis, channel.last);
    }
    if (error != 0) {
        return refused(error);
    }
    const std::uint32_t top = channel.counter_top;
    if (top < kMinCounter || (top & (top + 1U)) != 0 || channel.last > top) {
        return card_->name() + ": counter " + std::to_string(wiring_.counter[axis]) +
               " counts to " + std::to_string(top) + ": an encoder needs one of 16 to 32 bits";
    }
    channel.count = as_signed(channel.last, top);
    return {};
}

std::string ComediDevice::refused(int error) const {
    std::string remedy = "check that the card is there and its driver loaded";
    if (error == EACCES || error == EPERM) {
        remedy = "you may not open it: join the group that owns the file";
    } else if (error == EBUSY) {
        remedy = "another program uses it: end that one";
    } else if (error == EINVAL) {
        remedy = "check subdevices, channels and range in the calibration";
    }
    return card_->name() + ": " + card_->explain(error) + "; " + remedy;
}

void ComediDevice::silence() noexcept {
    for (std::size_t axis = 0; axis < 2; ++axis) {
        if (channels_[axis].output.top != 0) {
            static_cast<void>(card_->write_output(axis, channels_[axis].zero));
        }
    }
}

void ComediDevice::fail(DeviceFault fault, int error) noexcept {
    fault_ = fault;
    error_ = error;
    fix_.reset();
    silence();
}

std::uint32_t ComediDevice::code(std::size_t axis, double volts) const noexcept {
    const DaqCard::Output& output = channels_[axis].output;
    const double max = channels_[axis].volts;
    const double cut = std::fmin(std::fmax(volts, -max), max);
    const double share = (cut - output.min) / (output.max - output.min);
    const double nearest = std::floor(share * output.top + 0.5);
    return static_cast<std::uint32_t>(
        std::fmin(std::fmax(nearest, 0.0), static_cast<double>(output.top)));
}

std::int64_t ComediDevice::counted(std::size_t axis) const noexcept {
    const Channel& channel = channels_[axis];
    return (wiring_.counter_clockwise[axis] ? -channel.count : channel.count) + channel.offset;
}

/// Reads one counter and follows it around its end. False: a fault.
bool ComediDevice::follow(std::size_t axis) noexcept {
    Channel& channel = channels_[axis];
    std::uint32_t value = 0;
    const int error = card_->read_counter(axis, value);
    if (error != 0) {
        fail(fault_of(error), error);
        return false;
    }
    const std::uint32_t top = channel.counter_top;
    const std::int64_t step = as_signed((value - channel.last) & top, top);
    channel.last = value;
    channel.count += step;
    const std::int64_t now = counted(axis);
    constexpr std::int64_t kMax = std::numeric_limits<std::int32_t>::max();
    // Over a quarter of the counter at once, nobody knows any more which way round it went.
    if (value > top || std::abs(step) > static_cast<std::int64_t>(top / 4) ||
        std::abs(now) > kMax) {
        fail(DeviceFault::garbage, 0);
        return false;
    }
    return true;
}

Reading ComediDevice::read() noexcept {
    if (fault_ != DeviceFault::none || !follow(0) || !follow(1)) {
        return {.fault = fault_};
    }
    Reading reading;
    reading.counts = {static_cast<std::int32_t>(counted(0)), static_cast<std::int32_t>(counted(1))};
    fix_ = pantograph_.locate(pantograph_.angles(reading.counts));
    if (!fix_) {
        silence();
        reading.fault = DeviceFault::unreachable;
        return reading;
    }
    reading.hip = Vec3(fix_->hip, 0.0);
    return reading;
}

AppliedForce ComediDevice::write(const Vec3& force) noexcept {
    AppliedForce applied;
    std::array<std::uint32_t, 2> codes{channels_[0].zero, channels_[1].zero};
    if (fix_) {
        const MotorDrive drive = pantograph_.drive(*fix_, Vec2(force));
        if (std::isfinite(drive.torque.x) && std::isfinite(drive.torque.y)) {
            applied.saturated = drive.saturated;
            applied.load = drive.load;
            codes = {code(0, drive.torque.x * wiring_.volts_per_newton_metre[0]),
                     code(1, drive.torque.y * wiring_.volts_per_newton_metre[1])};
        }
    }
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const int error = card_->write_output(axis, codes[axis]);
        if (error != 0 && fault_ == DeviceFault::none) {
            fail(fault_of(error), error);
            codes = {channels_[0].zero, channels_[1].zero};
            applied.load = {};
            break;
        }
    }
    applied.codes = {static_cast<std::int32_t>(codes[0]), static_cast<std::int32_t>(codes[1])};
    return applied;
}

std::string ComediDevice::name() const {
    return "comedi " + card_->name() + " (" + calibration_.pantograph.name + ")";
}

DeviceTraits ComediDevice::traits() const noexcept {
    return {.damping = calibration_.pantograph.damping,
            .motor_time = calibration_.pantograph.motor_time,
            .holds_force = std::numeric_limits<double>::infinity()};
}

bool ComediDevice::prove_zero() noexcept {
    bool written = true;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const int error = card_->write_output(axis, channels_[axis].zero);
        if (error != 0 && fault_ == DeviceFault::none) {
            fail(fault_of(error), error);
        }
        written = written && error == 0;
    }
    return written;
}

bool ComediDevice::reconnect() {
    if (fault_ == DeviceFault::none) {
        return true;
    }
    problem_ = start();
    if (problem_.empty()) {
        homings_ += calibration_.home ? 1U : 0U;
        return true;
    }
    shut();
    return false;
}

void ComediDevice::forget_home() {
    fail(DeviceFault::unreachable, 0);
}

std::string ComediDevice::trouble() const {
    const std::string rest = calibration_.home ? "; bring the handle to its rest pose" : "";
    if (!problem_.empty()) {
        return problem_ + rest;
    }
    switch (fault_) {
        case DeviceFault::none:
            return {};
        case DeviceFault::garbage:
            return card_->name() + ": a counter jumped: check the encoder cables" + rest;
        default:
            return refused(error_) + rest;
    }
}

}  // namespace palpate::engine
