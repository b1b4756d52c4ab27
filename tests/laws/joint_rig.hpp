#pragma once

#include "engine/device/drivers/board_device.hpp"
#include "engine/device/drivers/haply_line.hpp"
#include "engine/device/emulator/haply_board.hpp"
#include "engine/device/emulator/open_board.hpp"
#include "engine/device/open/open_line.hpp"
#include "engine/realtime/tick_loop.hpp"
#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "protocols/trial/servo_apparatus.hpp"
#include "tests/support/board_link.hpp"
#include "tests/support/emulated_machine.hpp"
#include "tests/support/random.hpp"
#include "tests/support/tally.hpp"

// Board, wire, processes and screen fail together, one to three things at a time, while a hand
// presses. All of palpate's own is real: tick, chain, driver and, on an open board, its firmware.
// The guard process is modelled by what it promises, and all live on one clock.

namespace palpate::tests::joint {

using namespace palpate::engine;

enum class Cause : std::uint8_t {
    unplugged,
    hushed,
    stop_pressed,  ///< an open board's emergency stop
    skipped_edge,  ///< of an open board's encoder
    reset,
    cut_packet,
    host_stalls,
    host_dies,
    guard_dies,
    screen_stands,
    let_go,
    stopped,
    encoders_die,  ///< all at once: their supply
    focus_lost,
    misread,   ///< a packet is read as a reset
    stranger,  ///< another program's torques, one each ms
    count,
};

struct Event {
    Cause cause = Cause::count;
    int at = 0;  ///< ms since the trial began
    int size =
        0;  ///< ms of a stall or of a stranger; bytes that are left of a packet, but for whole tens
};

constexpr double kMs = 1e-3;
constexpr double kNever = 1e9;
/// s: without a reading in the chain, of the board's watchdog, the guard's patience and the
/// screen's; a tick and the wire beside.
constexpr double kSilence = 0.014;
constexpr double kWatchdog = 0.022;
constexpr double kGuardPatience = 0.028;
constexpr double kScreen = 0.254;
constexpr double kStill = kStillTrip + 0.004;
constexpr double kSoon = 0.006;
/// s until zero is proved.
constexpr double kProof = 0.050;

/// ms that half a packet may stay the last word: the guard's zeros to a host that hangs are so far
/// apart.
constexpr int kAstray = 21;

/// The driver, and what it was given.
class Watched : public Device {
public:
    explicit Watched(BoardDevice& device) : device_(&device) {}
    [[nodiscard]] Reading read() noexcept override { return device_->read(); }
    AppliedForce write(const Vec3& force) noexcept override {
        strongest = std::max(strongest, glm::length(force));
        last = force;
        return device_->write(force);
    }
    [[nodiscard]] std::string name() const override { return device_->name(); }
    [[nodiscard]] DeviceTraits traits() const noexcept override { return device_->traits(); }
    bool prove_zero() noexcept override { return device_->prove_zero(); }
    void keep_off() noexcept override { device_->keep_off(); }

    double strongest = 0.0;
    Vec3 last{};

private:
    BoardDevice* device_;
};

/// A rig at which a hand presses on a line, and what befalls it.
class Rig {
public:
    Rig(Random& random, bool open) : open_(open), random_(&random) {
        machine_.home = kStart;
        if (open) {
            machine_.haply.reset();
            machine_.board = OpenWiring{};
        }
        plant_ = std::make_unique<GuidedHand>(machine_);
        if (open) {
            board_ = std::make_unique<OpenBoard>(*plant_, machine_, *machine_.board);
        } else {
            board_ = std::make_unique<HaplyBoard>(*plant_, machine_.pantograph, *machine_.haply);
        }
        cable_ = std::make_unique<BoardCable>(*board_);
        device_ = std::make_unique<BoardDevice>(machine_, std::make_unique<BoardLink>(*cable_),
                                                open ? open_line : haply_line,
                                                std::make_unique<tests::ScriptedGuard>(guard_));
    }

    void run(const std::vector<Event>& events, Tally& tally) {
        protocols::Protocol protocol;
        protocol.apparatus.stiffness = 500.0;
        protocol.apparatus.force_limit = random_->in(0.5, 1.6);
        protocol.apparatus.force_ramp = random_->in(0.005, 0.03);
        protocol.safety.dead_man = true;
        Watched device(*device_);
        const SafetyLimits limits = protocols::servo_spec(protocol, device).limits;
        const Scene scene(stimuli::make_outline({.curvature = 0.0}),
                          {.stiffness = limits.stiffness, .period = kMs});
        TickLoop loop(device, limits);
        loop.begin(scene);
        began_ = next_ = cable_->now_ns();
        const auto has = [&](Cause cause) {
            return std::ranges::count(events, cause, &Event::cause) > 0;
        };
        const int end = has(Cause::encoders_die) ? 640 : has(Cause::screen_stands) ? 420 : 200;
        bool pressed = false;
        for (int ms = 0; ms < end; ++ms) {
            for (const Event& event : events) {
                if (event.at == ms) {
                    befall(event);
                }
            }
            if (!encoders_dead_) {
                plant_->lead(way(ms));
            }
            meddle();
            if (host_alive_ && now() >= stalled_until_) {
                tick(loop, device, events.empty(), tally);
            }
            guard_acts();
            next_ += 1'000'000;
            cable_->pass(std::max<std::int64_t>(next_ - cable_->now_ns(), 100'000));
            pressed = pressed || board_->torque() != Vec3{};
            judge(tally);
        }
        tally.pressed += pressed ? 1 : 0;
        tally.tripped += loop.trip() != Trip::none ? 1 : 0;
        tally.must(device.strongest <= limits.max_force * (1.0 + 1e-12),
                   "each force within its limit");
    }

private:
    static constexpr Vec2 kInward{0.70710678118654752, -0.70710678118654752};
    static constexpr Vec2 kAlong{0.70710678118654752, 0.70710678118654752};
    static constexpr Vec2 kStart{-0.0314, 0.0114};  ///< 2 mm outside the left side

    /// In to 4 mm, then along it, all at 0.1 m/s.
    [[nodiscard]] static Vec2 way(int ms) {
        const double in = std::min(1e-4 * ms, 0.006);
        const double along = std::min(1e-4 * std::max(ms - 60, 0), 0.03);
        return kStart + in * kInward + along * kAlong;
    }
    /// s since the trial began.
    [[nodiscard]] double now() const {
        return 1e-9 * static_cast<double>(cable_->now_ns() - began_);
    }

    /// By when the force must be off, whoever sees to it.
    void due(double within) { deadline_ = std::min(deadline_, now() + within); }
    /// The same of what the host has to see: a stall keeps it waiting, and with its death others
    /// take over.
    void host_due(double within) {
        if (host_alive_) {
            host_deadline_ = std::min(host_deadline_, std::max(now(), stalled_until_) + within);
        }
    }

    void befall(const Event& event) {
        switch (event.cause) {
            case Cause::unplugged:
                cable_->plug(false);
                due(kSoon);
                break;
            case Cause::hushed:
                board_->hush(true);
                host_due(kSilence);
                break;
            case Cause::stop_pressed:
                board_->press_stop(true);
                due(open_ ? kSoon : kNever);
                break;
            case Cause::skipped_edge:
                if (auto* board = dynamic_cast<OpenBoard*>(board_.get())) {
                    board->skip_edge();
                    host_due(kSilence);  // or never seen, on a board that was hushed before
                }
                break;
            case Cause::reset:
                board_->power_cycle();
                due(kSoon);
                break;
            case Cause::cut_packet:
                cable_->cut_next(static_cast<std::size_t>(event.size % 10));
                cuts_ += open_ ? 0 : 1;
                host_due(kSilence);
                break;
            case Cause::host_stalls:
                stalled_until_ = std::max(stalled_until_, now() + kMs * event.size);
                alone_ += guard_.alive ? 0 : event.size;
                host_deadline_ += host_deadline_ < kNever ? kMs * event.size : 0.0;
                // Nobody else than the host knows of a board without its address, or sets it up.
                excused_ += excused_ > now() && excused_ < kNever ? kMs * event.size : 0.0;
                if (kMs * event.size > (open_ ? kWatchdog : kGuardPatience)) {
                    due(open_ ? kWatchdog : guard_.alive ? kGuardPatience : kNever);
                }
                break;
            case Cause::host_dies:
                if (host_alive_) {
                    excused_ = excused_ > now() ? kNever : excused_;
                    foreign_ = 0;
                    died_ = now();
                    host_alive_ = false;
                    host_deadline_ = kNever;
                    due(guard_.alive ? kSoon : open_ ? kWatchdog : kNever);
                }
                break;
            case Cause::guard_dies:
                guard_.alive = false;
                foreign_ = open_ ? foreign_ : 0;
                host_due(kSoon);
                if (!host_alive_ && zeros_ == 0) {  // both at once: the board alone is left
                    deadline_ = open_ ? std::max(deadline_, died_ + kWatchdog) : kNever;
                } else if (!open_ && now() < stalled_until_) {
                    deadline_ = kNever;
                }
                break;
            case Cause::screen_stands:
                screen_since_ = std::min(screen_since_, now());
                host_due(kScreen);
                break;
            case Cause::let_go:
            case Cause::stopped:
            case Cause::focus_lost:
                held_ = held_ && event.cause != Cause::let_go;
                stop_ = event.cause == Cause::let_go ? stop_ : Trip::stopped;
                stop_ = event.cause == Cause::focus_lost ? Trip::focus_lost : stop_;
                host_due(kSoon);
                break;
            case Cause::encoders_die:
                encoders_dead_ = true;
                break;
            case Cause::misread:
                cable_->spoil_next(2);
                if (!open_) {
                    excuse(kProof);
                    host_due(kProof);
                }
                break;
            case Cause::stranger:
                foreign_ = event.size;
                break;
            case Cause::count:
                break;
        }
    }

    /// Dead encoders are distinguished from a hand at rest by a force that stands for some time.
    void still(const Watched& device) {
        if (encoders_dead_ && pushed_since_ == kNever && glm::length(device.last) > kStillForce) {
            pushed_since_ = now();
            host_due(kStill);
        }
    }

    /// Nobody is left to end a torque that came from elsewhere, or it takes a while.
    void excuse(double within) {
        const bool nobody = !host_alive_ || !guard_.alive;
        excused_ = std::max(excused_,
                            nobody && !open_ ? kNever : std::max(now(), stalled_until_) + within);
    }

    void meddle() {
        if (foreign_ > 0 && cable_->plugged()) {
            --foreign_;
            const auto seq = static_cast<std::uint16_t>(random_->below(65536));
            if (open_) {
                board_->receive(open_frame(open_torque(seq, {100'000, 100'000})).view());
            } else {
                board_->receive(torque_packet(machine_.haply->id, {0.1, 0.1})->view());
            }
            excuse(kProof);
            if (foreign_ == 0 && !open_) {
                host_due(kProof);
            }
        }
    }

    void tick(TickLoop& loop, const Watched& device, bool sound, Tally& tally) {
        const std::int64_t stalled =
            last_tick_ns_ == 0 ? 0 : cable_->now_ns() - last_tick_ns_ - 1'000'000;
        last_tick_ns_ = cable_->now_ns();
        const Trip before = loop.trip();
        if (before != Trip::none) {
            loop.keep_off();
            return;
        }
        const TickRecord record =
            loop.tick({.time_ns = cable_->now_ns() - began_,
                       .lateness_ns = stalled > 500'000 ? stalled : 0,
                       .held = held_,
                       .screen_age = screen_since_ < kNever ? now() - screen_since_ : 0.0,
                       .stop = stop_});
        if (before == Trip::none && loop.trip() != Trip::none) {
            const auto ticks = loop.flight().last();
            const bool kept = !ticks.empty() && ticks.back().tick == record.tick &&
                              (ticks.back().flags & tick_fault) != 0 &&
                              ticks.back().command == Vec3{};
            tally.must(kept, "a trip is recorded");
            tally.must(!sound, "no trip without a fault");
            loop.prove_zero();
        }
        if (loop.trip() != Trip::none) {
            const bool latched = device.last == Vec3{} && record.command == Vec3{} &&
                                 (before == Trip::none || loop.trip() == before);
            tally.must(latched, "after a trip no force and no other cause");
        }
        still(device);
    }

    /// Five zeros after a death, and one that has to be answered; five after 25 ms without a packet
    /// while the force is on, then one every 5 ms while the host has not taken the force back.
    void guard_acts() {
        if (!guard_.alive) {
            return;
        }
        const bool hung = host_alive_ && guard_.force && now() < stalled_until_ &&
                          cable_->now_ns() - last_tick_ns_ > 25'000'000;
        guard_.tripped = guard_.tripped || hung;
        const bool dead = !host_alive_ && now() > died_ + 1e-3;
        if (dead || hung) {
            ++zeros_;
            if (zeros_ <= 5 || (hung && zeros_ % 5 == 0) || (dead && !last_whole_)) {
                last_whole_ = cable_->plugged() && cable_->send(guard_.zero) && zeros_ > 5;
            }
        } else if (guard_.repeats && ++looks_ % 20 == 0) {
            static_cast<void>(cable_->plugged() && cable_->send(guard_.zero));
        }
    }

    void judge(Tally& tally) {
        const Vec3 torque = board_->torque();
        const double max = machine_.pantograph.axes[0].torque_limit * (1.0 + 1e-3);
        tally.must(std::fabs(torque.x) <= max && std::fabs(torque.y) <= max,
                   "each torque within its limit");
        const bool due = now() > std::max(std::min(deadline_, host_deadline_), excused_);
        // Half a packet makes a Haply board give any torque until the next one, also after a trip.
        astray_ += due && torque != Vec3{} ? 1 : 0;
        const int may = cuts_ > 0 ? kAstray * cuts_ + alone_ : 0;
        tally.must(astray_ <= may, "no torque when it is due to be off");
    }

    bool open_;
    Random* random_;
    Calibration machine_ = tests::emulated_calibration("gen3");
    std::unique_ptr<GuidedHand> plant_;
    std::unique_ptr<PortBoard> board_;
    std::unique_ptr<BoardCable> cable_;
    tests::ScriptedGuard::Script guard_;
    std::unique_ptr<BoardDevice> device_;

    std::int64_t began_ = 0;
    std::int64_t next_ = 0;
    std::int64_t last_tick_ns_ = 0;
    double stalled_until_ = 0.0;
    double screen_since_ = kNever;
    double deadline_ = kNever;
    double host_deadline_ = kNever;
    double died_ = kNever;
    bool host_alive_ = true;
    double pushed_since_ = kNever;  ///< with dead encoders
    bool encoders_dead_ = false;
    bool held_ = true;
    Trip stop_ = Trip::none;
    double excused_ = -kNever;  ///< until then a torque may be on that palpate did not give
    int foreign_ = 0;           ///< packets that a stranger still sends
    int looks_ = 0;
    int zeros_ = 0;
    bool last_whole_ = false;  ///< the zero behind the first five was answered
    int cuts_ = 0;             ///< packets cut on the way to a Haply board
    int alone_ = 0;            ///< ms that a host stalled whose guard was dead: nobody sends a zero
    int astray_ = 0;           ///< ms with a torque when there should be none
};

}  // namespace palpate::tests::joint
