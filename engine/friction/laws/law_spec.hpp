#pragma once

#include <cstdint>

namespace palpate::engine {

/// A law of friction from the literature, beside the god-object spring law that is the default
/// (engine/friction/friction_law.hpp). Each is a file of this folder (law_task.hpp).
struct LawTraits;

/// Most bristles of a contact: a tick visits each of them.
inline constexpr int kMaxBristles = 64;

/// Which law, and what it needs beside mu_s and mu_d. A law reads its own numbers alone.
struct LawSpec {
    const LawTraits* traits = nullptr;  ///< none: the god-object spring law, or no friction
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

}  // namespace palpate::engine
