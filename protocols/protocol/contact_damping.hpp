#pragma once

#include <algorithm>
#include <cmath>

#include "protocols/protocol/protocol.hpp"

namespace palpate::protocols {

/// The strongest damper that a contact may render, N s/m: that of the apparatus along the normal,
/// or a friction's along the surface. The device has to give as much on top of what springs need
/// (engine/safety/passivity.hpp).
[[nodiscard]] inline double contact_damping(const Protocol& protocol) noexcept {
    double damping = std::fabs(protocol.apparatus.damping);
    for (const FrictionSpec& friction : protocol.frictions) {
        damping = std::max(damping, friction.own.viscosity + friction.own.bristle_damping);
    }
    return damping;
}

}  // namespace palpate::protocols
