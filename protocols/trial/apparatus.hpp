#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/commissioning/short_form.hpp"
#include "engine/realtime/servo.hpp"
#include "protocols/design/plan.hpp"

namespace palpate::protocols {

/// The port to what is felt: a device and its servo, on a real or a virtual clock.
class Apparatus {
public:
    Apparatus() = default;
    Apparatus(const Apparatus&) = delete;
    Apparatus& operator=(const Apparatus&) = delete;
    virtual ~Apparatus() = default;

    /// Starts an interval (1 or 2) of a trial, at its position in the plan.
    /// @param scene  what it looks at outlives end()
    virtual void begin(const engine::SceneView& scene,
                       std::size_t position,
                       std::size_t interval) = 0;
    /// Lets a little time pass; ticks come out of ring().
    virtual engine::ServoStatus advance() = 0;
    /// Force out, zero written. The ramp's ticks are still in ring().
    virtual void end() = 0;

    /// Where the ticks come out; its reader is the session.
    [[nodiscard]] virtual engine::TickRing& ring() noexcept = 0;
    /// Since the interval's first tick, s, by the apparatus' own clock.
    [[nodiscard]] virtual double elapsed_s() const noexcept = 0;
    /// Ticks lost because the ring was full.
    [[nodiscard]] virtual std::int64_t dropped() const noexcept = 0;
    /// A simulated hand has finished exploring; always false for people.
    [[nodiscard]] virtual bool hand_is_done() const noexcept { return false; }
    /// Nothing more will come (end of a replay): exploration ends now.
    [[nodiscard]] virtual bool exhausted() const noexcept { return false; }
    [[nodiscard]] virtual std::string device_name() const = 0;
    /// engine::Device::identity()
    [[nodiscard]] virtual std::string identity() const { return {}; }
    /// Recorded hands: they feel the same each time, so that running a trial again would change
    /// nothing and no answer is judged by how its object was felt.
    [[nodiscard]] virtual bool repeats() const noexcept { return false; }

    /// The dead-man switch is held. Any thread.
    virtual void hold(bool held) { static_cast<void>(held); }
    /// Whoever could end the force is alive; said again and again while something is felt. Any
    /// thread.
    virtual void beat() {}
    /// By hand: force off now, and none until allow(). Any thread.
    /// @param why  Trip::stopped or Trip::focus_lost
    virtual void stop(engine::Trip why = engine::Trip::stopped) { static_cast<void>(why); }
    /// Between trials: what stopped it is settled.
    virtual void allow() {}
    /// After advance() said faulted: why, and the last ticks up to then.
    [[nodiscard]] virtual engine::Trip trip() const { return engine::Trip::none; }
    [[nodiscard]] virtual std::vector<engine::TickRecord> last_ticks() const { return {}; }
    /// Between trials: makes a device that failed work again. @return false while it is still away
    [[nodiscard]] virtual bool reconnect() { return true; }
    /// Since this was last asked the device began anew, whatever the cause: it may be another one,
    /// and took the pose in which its handle rested for home.
    [[nodiscard]] virtual bool began_anew() { return false; }
    /// What is wrong with the device and what to do, a sentence; empty when nothing is.
    [[nodiscard]] virtual std::string trouble() const { return {}; }
    /// The device may still give its last force: nothing has acknowledged zero.
    [[nodiscard]] virtual bool force_unproved() const { return false; }
    /// Somebody's hand may feel a force of it: of a rig, commissioned or not.
    [[nodiscard]] virtual bool gives_force() const noexcept { return has_proof(); }
    /// It gives the force of a commissioned rig, and nobody may feel it before that was proved (see
    /// Trust). Else there is nothing to prove.
    [[nodiscard]] virtual bool has_proof() const noexcept { return false; }
    /// Between trials, on any thread while nobody else uses it: is the free handle where its
    /// encoders say? After they lost their place, or doubt_plugs(), at the second mark.
    [[nodiscard]] virtual engine::ShortForm prove_place() { return {}; }
    /// The device was away, and whatever is plugged into it may be plugged in otherwise.
    virtual void doubt_plugs() {}
    /// The same: do weak pulses move it as when the rig was commissioned?
    [[nodiscard]] virtual engine::ShortForm prove_motors() { return {}; }
    /// Between trials: where the free handle is, m, read with zero force; infinitely far while the
    /// device does not say. None: no hand is brought to a start (a simulated one, a pointer that is
    /// put there).
    [[nodiscard]] virtual std::optional<engine::Vec3> place() { return std::nullopt; }
    /// Why the last place() was infinitely far: what the device then said of itself.
    [[nodiscard]] virtual engine::Trip place_fault() const { return engine::Trip::device_silent; }
    /// Between trials: how the handle moved as no hand does while nothing was felt, Trip::jump or
    /// Trip::over_speed; none: it did not. It stays until forget_move().
    [[nodiscard]] virtual engine::Trip moved() const { return engine::Trip::none; }
    /// Between trials: it is kept as a fault.
    virtual void forget_move() {}
    /// Between trials: how late the ticks of this run were, a sentence for the record. Empty on a
    /// virtual clock, which is never late.
    [[nodiscard]] virtual std::string timing() const { return {}; }
};

/// One interval of a trial: the force goes off when it ends, however it ends.
class ForceScope {
public:
    ForceScope(Apparatus& apparatus,
               const engine::SceneView& scene,
               std::size_t position,
               std::size_t interval)
        : apparatus_(&apparatus) {
        apparatus.begin(scene, position, interval);
    }
    ForceScope(const ForceScope&) = delete;
    ForceScope& operator=(const ForceScope&) = delete;
    ~ForceScope() { end(); }
    void end() {
        if (apparatus_ != nullptr) {
            apparatus_->end();
            apparatus_ = nullptr;
        }
    }

private:
    Apparatus* apparatus_;
};

}  // namespace palpate::protocols
