#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <type_traits>

#include "engine/geometry/vec.hpp"
#include "engine/rendering/mode.hpp"

namespace palpate::engine {

struct Contact;
class Outline;
struct SurfaceContact;
struct FeltState;
struct SceneView;

/// Bits of TickRecord::flags.
enum TickFlag : std::uint8_t {
    tick_saturated = 1U << 0U,  ///< the device could not give the commanded force
    tick_late = 1U << 1U,       ///< woke more than half a period after the deadline
    tick_ramped = 1U << 2U,     ///< the command was scaled down by the enable or disable ramp
    tick_fault = 1U << 3U,      ///< the safety chain has tripped; the command is zero
    /// out of reach: nothing was computed, go is the last closest point that was looked for
    tick_skipped = 1U << 4U,
    /// the GO stopped outside its cone (vertex slew, an open end): the force is cut
    tick_outside_cone = 1U << 5U,
    tick_force_slew = 1U << 6U,  ///< the command changed as fast as the force slew allows
    tick_stale = 1U << 7U,       ///< no new reading: the last HIP was used again
};

/// The flags that follow from the scene and HIP; the others are the safety chain's and the
/// device's.
inline constexpr unsigned kSceneFlags = tick_skipped | tick_outside_cone;

/// Everything that one servo tick read, decided and commanded. Frame: the object's, z up, SI. In
/// the plane every z, v and what is of a third motor are 0.
struct TickRecord {
    std::int64_t tick = 0;  ///< 0 at the first tick of the trial
    /// Since the trial's first deadline, on the servo's clock. Ticks are numbered without a gap;
    /// time jumps where the servo slept through deadlines, and lateness_us says so.
    std::int64_t time_ns = 0;
    Vec3 hip{};                     ///< haptic interaction point, m
    Vec3 cp{};                      ///< closest point of the object, m; by a replay, else 0
    Vec3 go{};                      ///< god-object, m
    Vec3 force{};                   ///< rendered force on the user, K (GO - HIP), N
    Vec3 command{};                 ///< force asked of the device after the safety chain, N
    double normal_force = 0.0;      ///< F . n at the GO, N, >= 0
    double tangential_force = 0.0;  ///< F . t at the GO, N, t = direction of travel
    double mu = 0.0;                ///< friction coefficient in force during this tick
    /// Of the GO on its segment, the segment's own parameter (0 to 1, or its knots'); on a vertex
    /// the fan angle phi, rad.
    double u = 0.0;
    double v = 0.0;  ///< of the GO on its surface, as u; `segment` is the surface then
    std::array<std::int32_t, 3> counts{};  ///< encoder counts as read (0 without encoders)
    std::array<std::int32_t, 3> codes{};   ///< DAC codes as written (0 without motors)
    float lateness_us = 0.0F;              ///< wake-up minus deadline, us (0 on a virtual clock)
    std::int16_t segment = 0;  ///< i >= 0: the GO is on segment i; -1 - j: on vertex j at its end
    Mode mode = Mode::free;
    std::uint8_t flags = 0;  ///< TickFlag bits
};
static_assert(std::is_trivially_copyable_v<TickRecord>);

/// Sets the columns that follow from the scene and HIP (go to mode, and the scene's flags) and
/// leaves the others alone: no force needs the closest point, a replay finds it. Servo and replay
/// both call this, and nothing else sets these columns.
/// @param outline  of the scene that made `contact`
void set_contact(TickRecord& tick, const Contact& contact, const Outline& outline) noexcept;
/// The same of a contact in space: u and v are the surface's own parameters.
void set_contact(TickRecord& tick, const SurfaceContact& contact) noexcept;

/// The same for ticks one after the other, whose HIP is set: what a replay does. @param state after
/// the tick before them
void set_contacts(std::span<TickRecord> ticks, const SceneView& scene, FeltState& state) noexcept;

/// Time from tick to tick, ns: 1e9 / rate, rounded. @param rate_hz  > 0
[[nodiscard]] std::int64_t tick_period_ns(double rate_hz) noexcept;

}  // namespace palpate::engine
