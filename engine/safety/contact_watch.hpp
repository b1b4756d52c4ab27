#pragma once

#include <array>
#include <cstddef>

#include "engine/geometry/vec.hpp"

/// What the depth of a contact does that no hand does: it swings too fast, or runs away.
namespace palpate::engine {

/// An oscillation of this frequency or more is no hand's: fingers tap at 5 to 8 Hz, tremor ends at
/// 12 (R. J. Elble & W. C. Koller 1990), and that of a hand with a load is slower.
inline constexpr double kBuzzFrequency = 14.0;  ///< Hz
/// Swings of less are not looked at: the counts of a coarse encoder flicker by 0.1 mm.
inline constexpr double kBuzzSwing = 0.0003;  ///< m
/// Mean speed of the way up and down again. The most that a tremor does is 0.007 m/s (0.3 mm at 12
/// Hz).
inline constexpr double kBuzzSpeed = 0.02;  ///< m/s
/// Swings up and down again, one after the other, that make a buzz.
inline constexpr int kBuzzCycles = 5;
/// Share of the way before that each must have. A handle that strikes a wall rings as well; at a
/// damping ratio of 0.05 or more each swing has less than this of the last.
inline constexpr double kBuzzLasts = 0.73;

/// The swings of the depth in contact. A plain value.
struct BuzzWatch {
    bool rising = false;
    double extreme = 0.0;  ///< the deepest while rising, the least deep while falling, m
    double at = 0.0;       ///< when it was reached, s
    double top = 0.0;      ///< of the last swing that counted, m
    double trough = 0.0;   ///< after it, m
    double peak = 0.0;     ///< when the last top was reached, s
    double way = 0.0;      ///< down and up again before it, m
    int cycles = 0;        ///< quick ones in a row
};

/// True once the depth has gone up and down kBuzzCycles times in a row, each time by kBuzzSwing or
/// more, within 1 / kBuzzFrequency, at kBuzzSpeed or more in the mean, and does not die away. The
/// depth is that along the normal, 0 out of contact: what friction does along the surface, sticking
/// and slipping, does not count, and what bounces off the surface does.
/// @param depth  m, finite, >= 0   @param now  s, never less than before
[[nodiscard]] bool buzzes(BuzzWatch& watch, double depth, double now) noexcept;

/// Speeds are means over stretches of this length: 1.5 mm at the least that counts, far above a
/// count of 0.1 mm.
inline constexpr double kRunawayStretch = 0.015;  ///< s
/// Stretches in a row that make a runaway.
inline constexpr int kRunawayStretches = 2;
/// Depth that grows more slowly is let be.
inline constexpr double kRunawaySpeed = 0.1;  ///< m/s
/// How much faster than it came and moved before the handle has to go deeper. Simulated hands that
/// are stronger than the limit go through it at 0.3 to 1.0 times the speed of their way.
inline constexpr double kRunawayShare = 1.4;

/// How fast HIP moved before, and how fast it goes deeper under a full command. A plain value.
struct RunawayWatch {
    bool started = false;
    double since = 0.0;  ///< when the present stretch began, s
    Vec3 from{};         ///< HIP then, m
    double depth = 0.0;  ///< then, m
    bool free = true;    ///< all of the stretch was out of contact
    bool full = true;    ///< the command was full all through it
    double came = 0.0;   ///< m/s, the last speed out of contact
    /// m/s, of the last stretches. The newest five do not count: a runaway begins with the contact.
    std::array<double, 20> paces{};
    std::size_t next = 0;  ///< slot of paces
    int fast = 0;          ///< stretches in a row
};

/// True when the depth grew under a full command for 30 ms, by 0.1 m/s or more and clearly faster
/// than HIP had come to the object, and had moved until 75 ms before.
///
/// A hand that means to go on at its pace is slowed down by a force against it, and at its limit
/// the force lets it have its pace again, no more. Motors of the wrong sign add twice the limit to
/// what the hand does: it is let in faster the deeper it gets. A motor with the wrong sign alone,
/// or both swapped, do so on one side of an object. What this cannot see: a motor that is too
/// strong or too weak, and wrong signs under a hand so firm that it does not give way. And a hand
/// that is slow, then jabs, looks like a runaway; it hears what to do about either.
///
/// @param full   the command since the last reading was as strong as it may be
/// @param depth  along the normal, m; 0 out of contact: friction along the surface takes no part
/// @param hip    m   @param now  s, never less than before
[[nodiscard]] bool runs_away(
    RunawayWatch& watch, bool full, double depth, const Vec3& hip, double now) noexcept;

}  // namespace palpate::engine
