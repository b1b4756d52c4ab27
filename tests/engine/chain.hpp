#pragma once

#include "engine/safety/safety_chain.hpp"

namespace palpate::tests {

/// The safety chain from the first tick of a trial on.
struct Chain {
    engine::SafetyLimits limits{};
    engine::SafetyState state{};

    engine::Command operator()(const engine::SafetyInput& input) {
        return engine::make_safe(state, limits, input);
    }
    /// Of the last of so many ticks alike: a trip stays.
    engine::Trip trip(const engine::SafetyInput& input = {}, int ticks = 1) {
        engine::Trip last = engine::Trip::none;
        for (int k = 0; k < ticks; ++k) {
            last = (*this)(input).trip;
        }
        return last;
    }
};

}  // namespace palpate::tests
