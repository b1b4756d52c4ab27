#pragma once

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

}  // namespace palpate::engine
