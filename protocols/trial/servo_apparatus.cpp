#include "protocols/trial/servo_apparatus.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/refuse.hpp"
#include "engine/math/elementary.hpp"
#include "engine/safety/passivity.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "protocols/design/session_plan.hpp"

namespace palpate::protocols {
namespace {

/// Uniform in [0, 1) with 32 bits: exact in double.
double unit(Pcg32& random) {
    return static_cast<double>(random.next()) * 0x1p-32;
}

/// m/s between two readings beyond any hand: an encoder skipped or a cable came loose.
constexpr double kJumpSpeed = 10.0;
/// s without a new reading after which the force has nothing to stand on: it is off until there is
/// one. And after which nobody answers: what a kernel's workers keep back on a busy machine was
/// never as old.
constexpr double kQuiet = 0.010;
constexpr double kSilence = 0.040;
/// s without a sign of life of the screen, after which nobody could end the force.
constexpr double kScreenSilence = 0.25;
/// Ticks that readings may be older than the device promised, whatever stiffness and damping: a
/// busy machine keeps some answers back. And where it is not known what the device damps.
constexpr double kSpareDelay = 0.5;
constexpr double kUnknownSpare = 1.0;
/// m of strokes under a straight axis that stands still, see EncoderWatch.
constexpr double kStuckInSpace = 0.080;
/// A place that was read so long ago is no place, ns; and how many ticks a new one is awaited.
constexpr std::int64_t kFreshNs = 50'000'000;
constexpr int kLooks = 30;
/// s after explore_timeout_s: the session's own loop has ended the exploration before.
constexpr double kTimeToSpare = 0.5;

/// What watches over people and motors, where there is a force.
void set_limits_of_force(const Protocol& protocol,
                         const engine::DeviceTraits& traits,
                         engine::SafetyLimits& limits) {
    const ApparatusSpec& apparatus = protocol.apparatus;
    const SafetySpec& safety = protocol.safety;
    const double period = limits.period;
    const double damping = contact_damping(protocol);
    limits.speed = safety.speed_limit;
    limits.jump = kJumpSpeed * period;
    limits.late_run = static_cast<std::int32_t>(safety.late_run);
    limits.late_share = static_cast<std::int32_t>(safety.late_share);
    limits.quiet_run = static_cast<std::int32_t>(std::ceil(kQuiet / period));
    limits.silent_run = static_cast<std::int32_t>(std::ceil(kSilence / period));
    limits.energy = safety.energy_limit;
    limits.damping =
        std::max(traits.damping.value_or(0.0),
                 engine::min_damping(apparatus.stiffness, period, traits.delay_ticks, damping));
    limits.delay_ticks = traits.delay_ticks;
    limits.spare_delay = traits.damping
                           ? std::max(kSpareDelay, engine::spare_delay(apparatus.stiffness, period,
                                                                       traits.delay_ticks, damping,
                                                                       *traits.damping))
                           : kUnknownSpare;
    limits.heat_step = traits.motor_time > 0.0 ? period / traits.motor_time : 0.0;
    limits.watch_encoders = true;
    limits.axes = traits.axes;
    limits.stuck_travel = traits.axes > 2 ? kStuckInSpace : limits.stuck_travel;
    limits.watch_runaway = true;
    limits.watch_buzz = true;
    limits.screen_silence = kScreenSilence;
    limits.time_limit = protocol.timing.explore_timeout + kTimeToSpare;
    limits.dead_man = safety.dead_man;
}

}  // namespace

DrawnHand::DrawnHand(const Protocol& protocol,
                     std::string protocol_hash,
                     SessionKey key,
                     std::uint64_t seed,
                     const HandSpec& own)
    : outline_(protocol.outline),
      surface_(protocol.surface.value_or(SurfaceSpec{})),
      start_(protocol.apparatus.start),
      protocol_hash_(std::move(protocol_hash)),
      key_(std::move(key)),
      seed_(seed),
      own_(own) {}

Pcg32 DrawnHand::stream_of(std::size_t position, std::size_t interval) const {
    return stream(session_stream(protocol_hash_, key_, seed_),
                  interval == 1 ? purpose::hand : purpose::second_hand, position);
}

engine::SurfaceExploration DrawnHand::on_surface(std::size_t position, std::size_t interval) const {
    Pcg32 random = stream_of(position, interval);
    engine::SurfaceExploration plan{
        .start = engine::Vec3(start_, surface_.start_height),
        .radius = (0.36 + 0.08 * unit(random)) * surface_.size,  // within the patch all around
    };
    plan.speed = own_.speed * (0.065 + 0.030 * unit(random));
    plan.press_depth = own_.press * (0.0085 + 0.0015 * unit(random));
    plan.strokes = 6 + static_cast<int>(random.bounded(3));
    plan.turn = 2.0 * engine::kPi * unit(random);
    plan.tremor_phase = 2.0 * engine::kPi * unit(random);
    return plan;
}

engine::Exploration DrawnHand::at(std::size_t position, std::size_t interval) const {
    Pcg32 random = stream_of(position, interval);
    engine::Exploration plan{
        .start = start_, .a = outline_.a, .vertex = outline_.vertex, .b = outline_.b};
    plan.speed = own_.speed * (0.065 + 0.030 * unit(random));  // 65 to 95 mm/s
    // 8.5 to 10 mm: reaches into every object.
    plan.press_depth = own_.press * (0.0085 + 0.0015 * unit(random));
    plan.sweeps = 3 + static_cast<int>(random.bounded(3));
    plan.tremor_phase = 2.0 * engine::kPi * unit(random);
    return plan;
}

engine::ServoSpec servo_spec(const Protocol& protocol,
                             const engine::Device& device,
                             double spin_share,
                             double max_force) {
    const ApparatusSpec& apparatus = protocol.apparatus;
    const engine::DeviceTraits traits = device.traits();
    const double period = 1.0 / apparatus.rate_hz;
    engine::SafetyLimits limits{.period = period,
                                .max_force = std::min(apparatus.force_limit, max_force),
                                .ramp_step = engine::ramp_step(apparatus.force_ramp, period),
                                .slew = protocol.safety.slew_limit * period,
                                .stiffness = apparatus.stiffness};
    if (traits.gives_force) {
        set_limits_of_force(protocol, traits, limits);
    }
    return {
        .rate_hz = apparatus.rate_hz, .limits = limits, .realtime = {}, .spin_share = spin_share};
}

std::string ServoApparatus::timing() const {
    const bool ticked = servo_at_->real_time() && servo_at_->lateness().count() > 0;
    return ticked ? describe(servo_at_->lateness()) : std::string();
}

ReplayApparatus::ReplayApparatus(const Protocol& protocol,
                                 std::vector<Recording> recordings,
                                 std::string source,
                                 double pace)
    : ServoApparatus(servo_),
      recordings_(std::move(recordings)),
      intervals_(intervals_of(protocol)),
      source_(std::move(source)),
      servo_(device_, servo_spec(protocol, device_), pace) {
    refuse_if(recordings_.empty(), "{} holds no recorded trial to replay", source_);
    for (const Recording& recording : recordings_) {
        refuse_if(recording.empty(), "{} holds a trial without ticks: name another trial", source_);
    }
}

void ReplayApparatus::begin(const engine::SceneView& scene,
                            std::size_t position,
                            std::size_t interval) {
    const std::size_t at = position * intervals_ + interval - 1;
    device_.begin(recordings_[at % recordings_.size()]);
    servo_.begin(scene);
}

bool ReplayApparatus::exhausted() const noexcept {
    // The recording's last ticks are its ramp out: leave them for ours.
    return static_cast<std::int64_t>(device_.left()) <= servo_.ramp_ticks();
}

DeviceApparatus::DeviceApparatus(const Protocol& protocol,
                                 std::unique_ptr<engine::Device> device,
                                 double spin_share,
                                 double max_force)
    : ServoApparatus(servo_),
      device_(std::move(device)),
      servo_(*device_, servo_spec(protocol, *device_, spin_share, max_force)),
      homings_(device_->homings()) {}

bool DeviceApparatus::reconnect() {
    servo_.park();  // nobody else may use the device meanwhile
    if (!device_->reconnect()) {
        return false;
    }
    if (asks_ && looked_at_ != device_->homings()) {
        other_ = asks_();
        looked_at_ = other_.empty() ? std::optional(device_->homings()) : std::nullopt;
    }
    return other_.empty();
}

bool DeviceApparatus::began_anew() {
    return std::exchange(homings_, device_->homings()) != device_->homings();
}

engine::ShortForm RigProof::place(engine::Device& device) {
    if (!device.reconnect()) {
        return {.refused = device.trouble(), .found = {}};
    }
    const std::size_t homings = device.homings();
    const engine::ShortForm form = homings != proved_homings ? mark(device) : home(device);
    if (form.refused.empty()) {
        proved_homings = homings;
    }
    return form;
}

engine::ShortForm DeviceApparatus::prove_place() {
    servo_.park();
    const engine::ShortForm form = proof_.place(*device_);
    unproved_ = form.refused;
    return form;
}

engine::ShortForm DeviceApparatus::prove_motors() {
    servo_.park();
    const engine::ShortForm form = proof_.motors(*device_);
    unproved_ = form.refused;
    servo_.unpark();
    return form;
}

std::optional<engine::Vec3> DeviceApparatus::place() {
    const auto look = [this]() -> std::optional<engine::Vec3> {
        const auto last = servo_.resting();
        const bool fresh = last && monotonic_ns() - last->at_ns < kFreshNs;
        const bool read = fresh && last->fault == engine::DeviceFault::none;
        place_fault_ = fresh && !read ? trip_of(last->fault) : engine::Trip::device_silent;
        return read ? std::optional(last->hip) : std::nullopt;
    };
    std::optional<engine::Vec3> place = look();
    if (!place) {
        servo_.unpark();  // it rests where it was not parked
    }
    for (int i = 0; i < kLooks && !place; ++i) {
        sleep_until(monotonic_ns() + servo_.period_ns());
        place = look();
    }
    if (place && servo_.moved() != engine::Trip::none) {  // what it says is not believed
        place_fault_ = servo_.moved();
        place.reset();
    }
    return place.value_or(engine::Vec3(std::numeric_limits<double>::infinity()));
}

PointerApparatus::PointerApparatus(const Protocol& protocol)
    : ServoApparatus(servo_),
      start_(protocol.apparatus.start),
      servo_(device_, servo_spec(protocol, device_)) {}

}  // namespace palpate::protocols
