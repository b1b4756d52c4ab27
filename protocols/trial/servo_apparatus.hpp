#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/base/pcg32.hpp"
#include "engine/device/hand_path.hpp"
#include "engine/device/pointer_device.hpp"
#include "engine/device/replay_device.hpp"
#include "engine/device/simulated_gantry.hpp"
#include "engine/device/simulated_pantograph.hpp"
#include "engine/realtime/thread_servo.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/protocol/observer_model.hpp"
#include "protocols/protocol/protocol.hpp"
#include "protocols/trial/apparatus.hpp"

namespace palpate::protocols {

/// How a simulated participant explores. Every trial's way is drawn from the stream "hand" of its
/// position, that of a second interval from "hand.second", so that a resumed session explores as
/// the unbroken one.
class DrawnHand {
public:
    /// @param own  how fast and how deep this person goes, as factors
    DrawnHand(const Protocol& protocol,
              std::string protocol_hash,
              SessionKey key,
              std::uint64_t seed,
              const HandSpec& own = {});

    /// The way of a trial over plane objects. @param interval  1 or 2
    [[nodiscard]] engine::Exploration at(std::size_t position, std::size_t interval = 1) const;
    /// The same of a study of surfaces. @pre the protocol has them
    [[nodiscard]] engine::SurfaceExploration on_surface(std::size_t position,
                                                        std::size_t interval = 1) const;

private:
    [[nodiscard]] Pcg32 stream_of(std::size_t position, std::size_t interval) const;

    OutlineSpec outline_;
    SurfaceSpec surface_;
    engine::Vec2 start_;
    std::string protocol_hash_;
    SessionKey key_;
    std::uint64_t seed_;
    HandSpec own_;
};

/// N that are asked of a rig that nobody proved.
inline constexpr double kUnprovedForce = 0.3;

/// What protocol and device together ask of the servo. Limits on motion, energy, heat and lateness
/// are for devices that give force. @param spin_share see engine::ServoSpec
/// @param max_force  N, where the device may give less than the protocol's limit
[[nodiscard]] engine::ServoSpec servo_spec(
    const Protocol& protocol,
    const engine::Device& device,
    double spin_share = 0.0,
    double max_force = std::numeric_limits<double>::infinity());

/// An apparatus that is a servo and a little more.
class ServoApparatus : public Apparatus {
public:
    engine::ServoStatus advance() override { return servo_at_->advance(); }
    void end() override { servo_at_->end(); }
    [[nodiscard]] engine::TickRing& ring() noexcept override { return servo_at_->ring(); }
    [[nodiscard]] double elapsed_s() const noexcept override { return servo_at_->elapsed_s(); }
    [[nodiscard]] std::int64_t dropped() const noexcept override { return servo_at_->dropped(); }
    void hold(bool held) override { servo_at_->hold(held); }
    void beat() override { servo_at_->beat(); }
    void stop(engine::Trip why = engine::Trip::stopped) override { servo_at_->stop(why); }
    void allow() override { servo_at_->allow(); }
    [[nodiscard]] engine::Trip trip() const override { return servo_at_->trip(); }
    [[nodiscard]] std::vector<engine::TickRecord> last_ticks() const override {
        return servo_at_->last_ticks();
    }

    [[nodiscard]] std::string timing() const override;
    [[nodiscard]] std::string device_name() const override { return device().name(); }
    [[nodiscard]] std::string identity() const override { return device().identity(); }

    /// What the servo reads and drives; outlives every call.
    [[nodiscard]] const engine::Device& device() const noexcept { return servo_at_->device(); }
    /// Its clock is that of the wall.
    [[nodiscard]] bool real_time() const noexcept { return servo_at_->real_time(); }
    /// What the system granted to its servo.
    [[nodiscard]] const engine::RealtimeRights& rights() const noexcept {
        return servo_at_->rights();
    }

protected:
    /// @param servo  a member of the heir, which need not be made yet
    explicit ServoApparatus(engine::Servo& servo) : servo_at_(&servo) {}

private:
    engine::Servo* servo_at_;
};

/// A simulated machine and its hand on a virtual clock.
template <class Machine, class Model>
class MachineApparatus : public ServoApparatus {
public:
    /// @param pace  multiple of real time, 0: as fast as the machine
    MachineApparatus(const Protocol& protocol,
                     DrawnHand hand,
                     double pace = 0.0,
                     const Model& model = {})
        : ServoApparatus(servo_),
          hand_(std::move(hand)),
          machine_(model, 1.0 / protocol.apparatus.rate_hz),
          servo_(machine_, servo_spec(protocol, machine_), pace) {}

    void begin(const engine::SceneView& scene,
               std::size_t position,
               std::size_t interval) override {
        if constexpr (std::is_same_v<Machine, engine::SimulatedGantry>) {
            machine_.begin(hand_.on_surface(position, interval));
        } else {
            machine_.begin(hand_.at(position, interval));
        }
        servo_.begin(scene);
    }
    [[nodiscard]] bool hand_is_done() const noexcept override { return machine_.hand_is_done(); }

private:
    DrawnHand hand_;
    Machine machine_;
    engine::VirtualServo servo_;
};

using SimulatedApparatus = MachineApparatus<engine::SimulatedPantograph, engine::PantographModel>;
/// Of three axes, for surfaces.
using GantryApparatus = MachineApparatus<engine::SimulatedGantry, engine::GantryModel>;

/// Recorded hands: interval k of the plan, counted through all its trials from 0, gets recording k
/// modulo their number.
class ReplayApparatus : public ServoApparatus {
public:
    using Recording = std::vector<engine::Reading>;

    /// @throws std::invalid_argument without recordings, or if one is empty
    ReplayApparatus(const Protocol& protocol,
                    std::vector<Recording> recordings,
                    std::string source,
                    double pace = 0.0);

    void begin(const engine::SceneView& scene, std::size_t position, std::size_t interval) override;
    [[nodiscard]] bool hand_is_done() const noexcept override { return exhausted(); }
    [[nodiscard]] bool exhausted() const noexcept override;
    [[nodiscard]] std::string device_name() const override { return "replay of " + source_; }
    [[nodiscard]] bool repeats() const noexcept override { return true; }

private:
    std::vector<Recording> recordings_;
    std::size_t intervals_;  ///< of a trial
    std::string source_;
    engine::ReplayDevice device_;
    engine::VirtualServo servo_;
};

/// How a commissioned rig is proved between trials, while nobody else uses its device.
struct RigProof {
    using Step = std::function<engine::ShortForm(engine::Device&)>;
    Step home;    ///< the handle rests at home
    Step mark;    ///< it rests at the second mark
    Step motors;  ///< weak pulses move it as they should

    /// The device has to work; home is enough where it was proved before, the mark is asked for
    /// where it was taken anew, or the plugs are in doubt.
    [[nodiscard]] engine::ShortForm place(engine::Device& device);

    /// Of those that the device had, so many met the mark; none: the plugs are in doubt.
    std::optional<std::size_t> proved_homings = 0;
};

/// A real device in real time, on the servo's own thread.
class DeviceApparatus : public ServoApparatus {
public:
    /// @param spin_share, max_force  see servo_spec()
    DeviceApparatus(const Protocol& protocol,
                    std::unique_ptr<engine::Device> device,
                    double spin_share = 0.0,
                    double max_force = std::numeric_limits<double>::infinity());

    void begin(const engine::SceneView& scene, std::size_t, std::size_t) override {
        servo_.begin(scene);
    }
    [[nodiscard]] bool reconnect() override;
    [[nodiscard]] bool began_anew() override;
    [[nodiscard]] std::string trouble() const override {
        const std::string trouble = device_->trouble();
        return !trouble.empty() ? trouble : !other_.empty() ? other_ : unproved_;
    }
    [[nodiscard]] bool force_unproved() const override { return device_->force_unproved(); }
    [[nodiscard]] bool gives_force() const noexcept override {
        return device_->traits().gives_force;
    }
    void stop(engine::Trip why) override {
        stopped_.store(true);
        ServoApparatus::stop(why);
    }
    void allow() override {
        stopped_.store(false);
        ServoApparatus::allow();
    }
    /// stop() was called, and allow() not since. Any thread.
    [[nodiscard]] bool stopped() const noexcept { return stopped_.load(); }
    [[nodiscard]] bool has_proof() const noexcept override { return bool{proof_.motors}; }
    [[nodiscard]] engine::ShortForm prove_place() override;
    void doubt_plugs() override {
        proof_.proved_homings.reset();
        looked_at_.reset();
    }
    [[nodiscard]] engine::ShortForm prove_motors() override;
    [[nodiscard]] std::optional<engine::Vec3> place() override;
    [[nodiscard]] engine::Trip place_fault() const override { return place_fault_; }
    [[nodiscard]] engine::Trip moved() const override { return servo_.moved(); }
    void forget_move() override { servo_.forget_move(); }

    /// @param proof  of the rig that was opened and proved with it
    void prove_by(RigProof proof) { proof_ = std::move(proof); }
    /// @param other  asked by reconnect() wherever the device began anew or may be another one: why
    ///               the session may not go on with it, a sentence; empty: it may
    void ask_by(std::function<std::string()> other) { asks_ = std::move(other); }

private:
    std::unique_ptr<engine::Device> device_;
    engine::ThreadServo servo_;
    RigProof proof_;
    std::atomic<bool> stopped_{false};
    engine::Trip place_fault_ = engine::Trip::device_silent;
    std::size_t homings_;  ///< of the device, when it was last asked whether it began anew
    std::function<std::string()> asks_;
    std::optional<std::size_t> looked_at_ = homings_;  ///< of the device that was asked about
    std::string other_;                                ///< why it is not the session's
    std::string unproved_;  ///< what was found wrong, and nothing has disproved since
};

/// The screen pointer as the handle, in real time on a thread of its own.
class PointerApparatus : public ServoApparatus {
public:
    /// At the protocol's rate and limits; each interval begins with the handle at its start, where
    /// it is until the window moves it.
    explicit PointerApparatus(const Protocol& protocol);

    void begin(const engine::SceneView& scene, std::size_t, std::size_t) override {
        device_.publish(start_);
        servo_.begin(scene);
    }
    /// The window moves it.
    [[nodiscard]] engine::PointerDevice& pointer() noexcept { return device_; }

private:
    engine::Vec2 start_;
    engine::PointerDevice device_;
    engine::ThreadServo servo_;
};

}  // namespace palpate::protocols
