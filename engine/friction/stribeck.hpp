#pragma once

#include "engine/friction/friction_law.hpp"

namespace palpate::engine {

/// How much of the Stribeck state theta survives one tick. Needs exp, so it is computed once a
/// scene (stribeck_decay, called when a scene is compiled) and kept with the session: exp differs
/// between machines.
struct StribeckDecay {
    double slip = 0.0;  ///< exp(-T / tau_slip), 0 when tau_slip = 0
    double heal = 0.0;  ///< exp(-T / tau_heal), 0 when tau_heal = 0
};

/// @param period T, s, > 0
[[nodiscard]] StribeckDecay stribeck_decay(const Friction& friction, double period) noexcept;

/// theta after one tick: relaxes to 0 while slipping and to 1 while stuck. Exact for any T.
[[nodiscard]] constexpr double next_theta(double theta,
                                          bool slipped,
                                          const StribeckDecay& decay) noexcept {
    return slipped ? theta * decay.slip : 1.0 + (theta - 1.0) * decay.heal;
}

}  // namespace palpate::engine
