#include "engine/friction/friction_law.hpp"

#include <cmath>

namespace palpate::engine {

StribeckDecay stribeck_decay(const Friction& friction, double period) noexcept {
    const auto survive = [period](double tau) {
        return tau > 0.0 ? std::exp(-period / tau) : 0.0;
    };
    return {.slip = survive(friction.tau_slip), .heal = survive(friction.tau_heal)};
}

}  // namespace palpate::engine
