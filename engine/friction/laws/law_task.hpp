#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "engine/friction/laws/law_spec.hpp"

/// What every law of this folder is given, and gives.
namespace palpate::engine {

/// One tick of the contact, as a law sees it.
struct Rub {
    /// Way of HIP along the tangent along which friction was held since the tick before, m: what
    /// the held force worked on, whatever the tangent is now.
    double travel = 0.0;
    double load = 0.0;   ///< F_N, N, >= 0
    double place = 0.0;  ///< of the closest point along the outline, m; for snags, else 0
};

/// What is felt of it.
struct FrictionForce {
    double force = 0.0;  ///< on the user, along the tangent, N
    double mu = 0.0;     ///< coefficient in force
    bool slid = false;   ///< most of the travel was slip
};

/// What lives on from tick to tick. A plain value; new at every contact but for `draws`.
struct LawState {
    double stretch = 0.0;                         ///< of the law's spring, m
    double force = 0.0;                           ///< on the user in the tick before, N
    double way = 0.0;                             ///< of sliding: +1 or -1
    double place = 0.0;                           ///< of the tick before, m
    bool sliding = false;                         ///< not held by the spring
    bool placed = false;                          ///< `place` is one
    std::uint64_t draws = 0;                      ///< of random numbers so far
    std::array<double, kMaxBristles> bristles{};  ///< their stretches, m
};

/// A law with all its numbers.
struct LawTask {
    LawSpec spec{};
    double mu_s = 0.0;
    double mu_d = 0.0;
    double stiffness = 1000.0;  ///< N/m, > 0
    double period = 0.001;      ///< s
};

/// What a law is, and what is known of it before it is felt.
struct LawTraits {
    std::string_view word{};   ///< in files
    std::string_view paper{};  ///< who published it
    /// One tick on. No allocation, no lock; finite for finite numbers, the same bits everywhere.
    FrictionForce (*step)(const LawTask&, LawState&, const Rub&) noexcept = nullptr;
    /// Numbers of LawSpec that it reads, as files call them, without their unit.
    std::array<std::string_view, 4> reads{};
    bool needs_first = false;  ///< the first of them has to be given
    bool sticks = false;       ///< reads mu_s beside mu_d
    int max_mu_s = 0;          ///< in mu_d; 0: any
    bool by_place = false;     ///< wants to know where on the outline the contact is
    /// Held for a tick it gives no more than its springs' leak of K/2 |dh|^2: the same proof as
    /// that of the god-object spring law, for it only ever lets its spring's anchor go towards HIP.
    /// On an object that is hollow by kappa the leak is that of K + |kappa| d K.
    bool passive = false;
    bool in_cone = false;   ///< |F_T| <= mu_s F_N on every tick
    bool creeps = false;    ///< drifts under an oscillating load that would not break it away
    bool chatters = false;  ///< its force jumps with the encoder's steps at low speed
};

/// +1, 0 or -1; of NaN 0.
[[nodiscard]] constexpr double sign_of(double value) noexcept {
    return value > 0.0 ? 1.0 : value < 0.0 ? -1.0 : 0.0;
}

/// A uniform number in [0, 1) of its place in a sequence: the mixing of SplitMix64 (Steele, Lea &
/// Flood 2014), which needs no state.
[[nodiscard]] constexpr double uniform(std::uint64_t seed, std::uint64_t number) noexcept {
    std::uint64_t z = seed + (number + 1) * 0x9E3779B97F4A7C15ULL;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
}

}  // namespace palpate::engine
