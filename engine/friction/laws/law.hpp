#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "engine/friction/friction_law.hpp"

namespace palpate::engine {

/// Laws of friction from the literature, beside the god-object spring law that is the default
/// (engine/friction/friction_law.hpp). Each is a file of this folder.
enum class LawKind : std::uint8_t {
    none,  ///< the god-object spring law, or no friction
    coulomb_sign,
    viscous,
    stiction,
    stribeck,
    karnopp,
    dahl,
    bristle,
    reset_integrator,
    lugre,
    lugre_euler,
    hayward_armstrong,
    friction_cone,
    snags,
};

/// Most bristles of a contact: a tick visits each of them.
inline constexpr int kMaxBristles = 64;

/// Which law, and what it needs beside mu_s and mu_d. A law reads its own numbers alone.
struct LawSpec {
    LawKind kind = LawKind::none;
    double stiffness = 0.0;        ///< N/m, >= 0: of its spring along the surface; 0: the object's
    double viscosity = 0.0;        ///< N s/m, >= 0: viscous, LuGre's sigma_2
    double bristle_damping = 0.0;  ///< N s/m, >= 0: sigma_1 of LuGre and the reset integrator
    double stribeck_speed = 0.01;  ///< v_s, m/s, > 0: stribeck, LuGre
    double smoothing_speed = 0.002;  ///< eps, m/s, > 0: stribeck
    double stick_speed = 0.002;      ///< DV, m/s, > 0: Karnopp
    double exponent = 1.0;           ///< alpha, 0 to 3: Dahl
    double stick_share = 0.7;  ///< z_stick / z_max, 0 to 0.99: Hayward & Armstrong; 0 is Dahl's law
    int bristles = 20;         ///< 1 to kMaxBristles
    double snag_spacing = 0.003;  ///< m, > 0: one snag in each such length
    std::uint64_t seed = 0;       ///< of bristles and snags

    friend bool operator==(const LawSpec&, const LawSpec&) = default;
};

/// What is known of a law before it is felt.
struct LawTraits {
    LawKind kind = LawKind::none;
    std::string_view word;   ///< in files
    std::string_view paper;  ///< who published it
    bool sticks = false;     ///< reads mu_s beside mu_d
    /// Held for a tick it gives no more than its springs' leak of K/2 |dh|^2: the same proof as
    /// that of the god-object spring law, for it only ever lets its spring's anchor go towards HIP.
    /// On an object that is hollow by kappa the leak is that of K + |kappa| d K.
    bool passive = false;
    bool in_cone = false;   ///< |F_T| <= mu_s F_N on every tick
    bool creeps = false;    ///< drifts under an oscillating load that would not break it away
    bool chatters = false;  ///< its force jumps with the encoder's steps at low speed
};

/// Of all laws of this folder, in the order of LawKind, without `none`.
[[nodiscard]] std::span<const LawTraits> law_traits() noexcept;
/// @pre kind is not `none`
[[nodiscard]] const LawTraits& traits_of(LawKind kind) noexcept;
/// The law of a file's word; `none` for a word that is none of theirs.
[[nodiscard]] LawKind law_kind(std::string_view word) noexcept;

/// Speed from which on one explicit Euler step of LuGre's state overshoots further than it was off,
/// m/s: sigma_0 |v| T / g > 2, g = mu_d F_N at speed.
[[nodiscard]] double euler_limit(double stiffness,
                                 double load,
                                 double mu_d,
                                 double period) noexcept;

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

/// The law of one scene, compiled: one function, chosen once. A plain value.
class FrictionLaw {
public:
    FrictionLaw() = default;  ///< no law: step() gives no force
    /// @param stiffness  of the object, N/m, > 0     @param period  T, s, > 0
    /// @throws std::invalid_argument for a number out of range: which one, the value, what to give
    FrictionLaw(const LawSpec& spec, const Friction& friction, double stiffness, double period);

    /// One tick on. No allocation, no lock; finite for finite numbers, the same bits everywhere.
    [[nodiscard]] FrictionForce step(LawState& state, const Rub& rub) const noexcept {
        return step_(task_, state, rub);
    }
    /// The law wants to know where on the outline the contact is.
    [[nodiscard]] bool wants_place() const noexcept { return task_.spec.kind == LawKind::snags; }
    [[nodiscard]] const LawTask& task() const noexcept { return task_; }

private:
    using Step = FrictionForce (*)(const LawTask&, LawState&, const Rub&) noexcept;
    static FrictionForce none(const LawTask& /*task*/,
                              LawState& /*state*/,
                              const Rub& /*rub*/) noexcept {
        return {};
    }
    static Step step_of(LawKind kind) noexcept;

    LawTask task_{};
    Step step_ = &FrictionLaw::none;
};

}  // namespace palpate::engine
