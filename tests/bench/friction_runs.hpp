#pragma once

#include <string>
#include <vector>

#include "engine/rendering/scene.hpp"

namespace palpate::bench {

/// A law of friction to be measured, on flat ground.
struct RubbedLaw {
    std::string name;
    engine::Friction friction{};
    engine::LawSpec own{};
    bool as_recalled = false;  ///< Hayward & Armstrong with the map z^8 / (z_max (z_s^8 + z^8))
};

/// gos and coulomb first, then all laws of engine/friction/laws, then one that is no law of a
/// scene.
[[nodiscard]] std::vector<RubbedLaw> rubbed_laws();

/// What one law does, in the runs that the benchmark tells of.
struct FrictionRow {
    RubbedLaw law;
    double jump = 0.0;          ///< largest change of force in a tick, N
    double rate = 0.0;          ///< largest difference from 10 kHz at 1 kHz, N
    double held = 0.0;          ///< force after a second at rest, N
    double chatter = 0.0;       ///< rms of the force about its mean, N
    double drift = 0.0;         ///< under a load that moves to and fro, m
    double given = 0.0;         ///< worst balance of an episode in the ledger, J
    double tick = 0.0;          ///< of the whole contact, ns
    double law_alone = -1.0;    ///< of the law, ns; < 0: it has no function of its own
    std::vector<double> x;      ///< of the last stroke to and fro, m
    std::vector<double> force;  ///< N
};
[[nodiscard]] FrictionRow run_of(const RubbedLaw& law);

/// |F| after 1000 ticks at a speed, N, by LuGre's exact step and by explicit Euler.
struct EulerRun {
    double speed = 0.0;  ///< m/s
    double share = 0.0;  ///< sigma_0 |v| T / g: Euler diverges above 2
    double exact = 0.0;
    double euler = 0.0;
};
[[nodiscard]] std::vector<EulerRun> euler_runs();

}  // namespace palpate::bench
