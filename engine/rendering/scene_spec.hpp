#pragma once

#include <cstdint>

#include "engine/friction/god_object.hpp"
#include "engine/friction/stribeck.hpp"
#include "engine/rendering/mode.hpp"

namespace palpate::engine {

/// When the closest point is looked for beyond what the force needs.
enum class Look : std::uint8_t {
    needed,    ///< never: in contact with friction it is the last one found
    touching,  ///< on every tick in contact: what a trial records
    always,    ///< out of reach too: for drawing and offline tools
};

/// What is to be felt, as chosen by an experimenter. SI.
struct SceneSpec {
    double stiffness = 1000.0;  ///< K, N/m, > 0: the spring of the virtual coupling
    double damping = 0.0;   ///< B, N s/m, >= 0: its damper; the device must then give b > K T/2 + B
    double period = 0.001;  ///< T, s, > 0
    Friction friction{};
    Slew slew{};
    Look look = Look::touching;
};

/// The same spec, if all values are in range.
/// @throws std::invalid_argument for the first that is not: which one, the value, what to give
const SceneSpec& checked(const SceneSpec& spec);

/// mu counts as relaxed once theta is below this: 1e-3 of mu_s - mu_d is 0.2 mN at 1 N.
inline constexpr double kRelaxed = 1e-3;

/// What a tick in contact did: `slipped`, the GO moved; theta, the Stribeck state before the tick.
template <bool HasFriction>
[[nodiscard]] Mode mode_of(bool slipped, double theta, const Friction& friction) noexcept {
    return !slipped                                                         ? Mode::stuck
         : HasFriction && theta > kRelaxed && friction.mu_s > friction.mu_d ? Mode::transition
                                                                            : Mode::slip;
}

/// Share of the clearance that may be used up before the next look; the rest is for rounding.
inline constexpr double kClearShare = 1.0 - 1e-12;

}  // namespace palpate::engine
