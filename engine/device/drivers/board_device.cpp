#include "engine/device/drivers/board_device.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "engine/base/clock.hpp"
#include "engine/base/text.hpp"

namespace palpate::engine {
namespace {

constexpr std::int64_t kFirstWait = 10 * kMillisecond;
constexpr int kLastZeros = 5;
constexpr std::int64_t kGuardsLast = 2 * kMillisecond;  ///< until its last zero is on its way
constexpr std::size_t kTimed = 31;      ///< answers whose middle time is that of them all
constexpr std::size_t kDeepest = 32;    ///< questions on their way
constexpr double kLongestTrip = 0.010;  ///< s: the force would follow a place of long ago
constexpr int kStillCounts = 1;         ///< an encoder at rest may flicker by one

std::int64_t nanoseconds(double seconds) noexcept {
    return static_cast<std::int64_t>(std::floor(seconds * 1e9 + 0.5));
}

}  // namespace

BoardDevice::BoardDevice(const Calibration& calibration,
                         std::unique_ptr<ByteLink> link,
                         MakeLine make_line,
                         std::unique_ptr<MotorGuard> guard,
                         const BoardTiming& timing)
    : machine_(calibration),
      timing_(timing),
      link_(std::move(link)),
      guard_(std::move(guard)),
      line_(make_line(*link_, calibration)) {
    if (!open_board()) {
        throw std::runtime_error(trouble_);
    }
    bias_ = machine_.home();
    leave();
}

BoardDevice::~BoardDevice() {
    if (line_->is_set_up()) {
        take_over();
        line_->part();
    }
    guard_->release();
    link_->close();
}

DeviceTraits BoardDevice::traits() const noexcept {
    return {.gives_force = true,
            .damping = machine_.calibration().damping(),
            .delay_ticks = static_cast<double>(depth_),
            .motor_time = machine_.calibration().motor_time(),
            .holds_force = line_->holds_force(),
            .round_trip = round_trip_,
            .axes = static_cast<int>(machine_.axes())};
}

/// Somebody switches the motors off if palpate cannot, and has nothing against a force any more.
bool BoardDevice::guarded() {
    return guard_->watch(link_->descriptor(), line_->guard_packets());
}

/// Port, guard and set-up; the position is lost.
bool BoardDevice::open_board() {
    guard_->release();  // its copy of a port that is gone would keep the port's name taken
    line_->start_over();
    if (!link_->reopen()) {
        trouble_ = link_->trouble();
        return false;
    }
    if (!guarded()) {
        link_->close();
        trouble_ =
            "no guard process can be started, so nobody would switch the motors off if palpate "
            "died: end some programs and try again";
        return false;
    }
    if (line_->set_up() != BoardLine::Answer::complete) {
        trouble_ = line_->refusal();
        return false;
    }
    zero_unproved_ = false;
    ask_anew_ = true;
    return measure_answers();
}

/// How long answers take is part of what was promised of the device: a board that comes back must
/// not be slower than it was.
bool BoardDevice::measure_answers() {
    const auto trip = line_->round_trip(kTimed);
    if (!trip) {
        trouble_ = "the board at " + link_->name() +
                   " answers, then falls silent: check its power and cable";
        return false;
    }
    const double periods = std::ceil(*trip / timing_.period);
    const std::size_t depth = periods > 1.0 ? static_cast<std::size_t>(periods) : 1;
    if (*trip > kLongestTrip || depth > kDeepest || (depth_ > 0 && depth > depth_)) {
        trouble_ = "answers of the board at " + link_->name() + " take " +
                   number_text(std::round(*trip * 1e5) / 100.0) + " ms, " +
                   (depth_ > 0 && *trip <= kLongestTrip ? "more than when the session began"
                                                        : "too long for a force") +
                   ": use a port of the computer itself without a hub, and end programs that keep "
                   "it busy";
        return false;
    }
    if (depth_ == 0) {
        depth_ = depth;
        round_trip_ = *trip;
    }
    return true;
}

Reading BoardDevice::take(const BoardReply& reply) noexcept {
    Reading reading;
    for (std::size_t i = 0; i < machine_.axes(); ++i) {
        reading.counts[i] = reply.counts[i] + bias_[i];
    }
    reading.grip = reply.grip;
    place_ = machine_.locate(reading.counts);
    if (place_) {
        reading.hip = place_->hip;
    } else {
        reading.fault = DeviceFault::unreachable;
    }
    return reading;
}

/// What came before a rest is old, so it is asked for once more.
BoardLine::Answer BoardDevice::prime() noexcept {
    applied_ = {};
    take_over();
    const auto awake = line_->wake(kFirstWait);
    ask_anew_ = awake == BoardLine::Answer::pending;
    if (awake == BoardLine::Answer::complete) {
        guard_->force_off();
    }
    return awake;
}

/// @param primed  last_ was asked for in this very tick
void BoardDevice::note_age(bool primed) noexcept {
    const std::uint64_t owed = line_->owed();
    if (primed) {
        measured_ = tick_;
    } else if (owed < asked_) {
        measured_ = std::max(measured_, asked_at_[(asked_ - owed - 1) % asked_at_.size()]);
    }
}

double BoardDevice::behind() const noexcept {
    const std::uint64_t age = tick_ - measured_;
    return age > depth_ ? static_cast<double>(age - depth_) : 0.0;
}

Reading BoardDevice::read() noexcept {
    ++tick_;
    if (fault_ == DeviceFault::none && guard_->tripped()) {
        fail(DeviceFault::held);
    }
    if (fault_ == DeviceFault::none && !guard_->alive()) {
        fail(DeviceFault::unguarded);
    }
    if (fault_ != DeviceFault::none) {
        return {.fault = fault_, .fresh = false};
    }
    const bool rested = ask_anew_ || !line_->awaiting() ||
                        link_->now_ns() - line_->owed_since_ns() > BoardLine::kStale;
    const auto answer =
        rested ? prime() : line_->hear(nanoseconds(timing_.patience * timing_.period), depth_ - 1);
    switch (answer) {
        case BoardLine::Answer::complete:
            last_ = take(line_->reply());
            note_age(rested);
            last_.behind = behind();
            was_late_ = was_late_ || last_.behind > 0.0;
            return last_;
        case BoardLine::Answer::pending:
            if (link_->now_ns() - line_->owed_since_ns() > nanoseconds(timing_.silence)) {
                fail(DeviceFault::silent);
            }
            break;
        case BoardLine::Answer::garbage:
            fail(DeviceFault::garbage);
            break;
        case BoardLine::Answer::lost:
            fail(DeviceFault::lost);
            break;
        case BoardLine::Answer::stopped:
            fail(DeviceFault::stopped);
            break;
    }
    Reading stale = last_;
    stale.fresh = false;
    stale.behind = behind();
    was_late_ = was_late_ || stale.behind > 0.0;
    if (fault_ != DeviceFault::none) {
        stale.fault = fault_;
    }
    return stale;
}

bool BoardDevice::ask(const Vec3& torque) noexcept {
    const bool sent = line_->ask({torque.x, torque.y, torque.z});
    if (sent) {
        asked_at_[asked_++ % asked_at_.size()] = tick_;
    }
    return sent;
}

bool BoardDevice::send_zero() noexcept {
    applied_ = {};
    const bool sent = ask({});
    if (sent) {  // otherwise the guard stays on its toes
        guard_->force_off();
    }
    return sent;
}

void BoardDevice::fail(DeviceFault fault) noexcept {
    // After the guard has spoken answers are those to its zeros, and the board is not to blame.
    const bool odd = fault == DeviceFault::silent || fault == DeviceFault::garbage;
    fault_ = odd && guard_->tripped() ? DeviceFault::held : fault;
    zeros_left_ = kLastZeros;
    // Behind half a packet a zero torque would be misread: a little later.
    zeros_from_ns_ = fault == DeviceFault::lost ? link_->now_ns() + kMillisecond / 2 : 0;
    static_cast<void>(hold_off({}));
}

/// A fault is latched: nothing but zeros, until so many went out whole (half of one is any torque).
AppliedForce BoardDevice::hold_off(const Vec3& force) noexcept {
    if (zeros_left_ > 0 && link_->now_ns() >= zeros_from_ns_ && send_zero()) {
        --zeros_left_;
    }
    return {.saturated = force != Vec3{}};
}

/// Others no longer speak to the board, and their answers have come.
void BoardDevice::take_over() noexcept {
    if (left_) {
        left_ = false;
        guard_->repeat_zeros(false);
        link_->pause(kGuardsLast + nanoseconds(round_trip_));
    }
}

/// Nobody ticks from now on.
void BoardDevice::leave() noexcept {
    left_ = true;
    guard_->repeat_zeros(true);
    ask_anew_ = true;
}

bool BoardDevice::prove_zero() noexcept {
    applied_ = {};
    take_over();
    const BoardLine::Off off = line_->part();
    if (off != BoardLine::Off::unproved) {
        guard_->force_off();
        zeros_left_ = 0;
    }
    if (off != BoardLine::Off::proved && fault_ == DeviceFault::none) {
        fault_ = off == BoardLine::Off::anew ? DeviceFault::garbage : DeviceFault::silent;
    }
    zero_unproved_ = off == BoardLine::Off::unproved;
    homeless_ = homeless_ || off == BoardLine::Off::anew;
    leave();
    return off != BoardLine::Off::unproved;
}

AppliedForce BoardDevice::write(const Vec3& force) noexcept {
    if (fault_ != DeviceFault::none) {
        return hold_off(force);
    }
    const MotorDrive drive = place_ && last_.ok() ? machine_.drive(*place_, force) : MotorDrive{};
    const bool finite = std::isfinite(drive.torque.x) && std::isfinite(drive.torque.y) &&
                        std::isfinite(drive.torque.z);
    if (!finite || drive.torque == Vec3{}) {
        if (!send_zero()) {
            fail(DeviceFault::lost);
        }
        return {.saturated = force != Vec3{}};
    }
    guard_->force_on();
    if (line_->full(depth_)) {  // no more questions than answers take periods: the torques stay
        return applied_;
    }
    if (guard_->tripped() || !guard_->alive()) {
        fail(guard_->tripped() ? DeviceFault::held : DeviceFault::unguarded);
        return {.saturated = true};
    }
    if (!ask(drive.torque)) {
        fail(DeviceFault::lost);
        return {.saturated = true};
    }
    const auto code = [&](std::size_t i, double torque) {
        const Axis& axis = machine_.axis(i);
        return static_cast<std::int32_t>(
            std::floor(torque / axis.torque_limit * axis.codes_full_scale + 0.5));
    };
    applied_ = {.codes = {code(0, drive.torque.x), code(1, drive.torque.y),
                          machine_.axes() > 2 ? code(2, drive.torque.z) : 0},
                .saturated = drive.saturated,
                .load = drive.load};
    return applied_;
}

/// After readings that came late or not at all: are answers as quick as when the board was opened?
/// One that is mute may have gone to another port.
bool BoardDevice::answers_in_time() {
    ask_anew_ = true;
    static_cast<void>(line_->wake(kFirstWait));  // past the answers to the guard's zeros
    was_late_ = !measure_answers();
    if (!was_late_) {
        trouble_.clear();
        static_cast<void>(line_->silence());  // it was armed to answer
    } else if (line_->probe(100 * kMillisecond) != BoardLine::Answer::complete) {
        fail(DeviceFault::silent);
    }
    return !was_late_;
}

bool BoardDevice::rests() {
    Machine::Counts smallest{};
    Machine::Counts largest{};
    bool first = true;
    if (line_->wake(100 * kMillisecond) !=
        BoardLine::Answer::complete) {  // past the guard's answers
        homeless_ = false;              // and back to the port
        return false;
    }
    const std::int64_t end = link_->now_ns() + nanoseconds(timing_.still);
    while (link_->now_ns() < end) {
        if (line_->probe(100 * kMillisecond) != BoardLine::Answer::complete || line_->awaiting()) {
            homeless_ = false;  // and back to the port
            return false;
        }
        const Machine::Counts raw = line_->reply().counts;
        for (std::size_t i = 0; i < machine_.axes(); ++i) {
            smallest[i] = first ? raw[i] : std::min(smallest[i], raw[i]);
            largest[i] = first ? raw[i] : std::max(largest[i], raw[i]);
            if (largest[i] - smallest[i] > kStillCounts) {
                return false;
            }
            bias_[i] = machine_.home()[i] - raw[i];
        }
        first = false;
        link_->pause(10 * kMillisecond);
    }
    homeless_ = first || guarded();
    return !first && homeless_;
}

bool BoardDevice::reconnect() {
    if (fault_ == DeviceFault::none && !left_) {
        static_cast<void>(prove_zero());
    }
    take_over();
    const bool back = (fault_ == DeviceFault::none || mend()) && (!was_late_ || answers_in_time());
    leave();
    return back;
}

bool BoardDevice::mend() {
    trouble_ = explained(fault_);
    const bool quiet =
        !homeless_ && line_->silence();  // a link that is gone may still let it through
    was_late_ = true;                    // what it was before the fault is believed no more
    bool back = false;
    if (homeless_) {
        back = home_asked_ && rests();  // nobody puts it there unasked
        homeless_ = homeless_ && !back;
        homings_ += back ? 1U : 0U;
    } else if (fault_ == DeviceFault::stopped && quiet) {
        back = line_->forgive() && guarded();
    } else if (fault_ != DeviceFault::lost && quiet && guarded()) {
        back = true;
    } else if (open_board()) {
        homeless_ = true;
    }
    home_asked_ = homeless_;
    if (homeless_) {
        trouble_ = explained(DeviceFault::unreachable);
    }
    if (back) {
        zero_unproved_ = false;
        trouble_.clear();
        fault_ = DeviceFault::none;
        zeros_left_ = 0;
        ask_anew_ = true;
    }
    return back;
}

}  // namespace palpate::engine
