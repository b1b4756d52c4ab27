#pragma once

#include "protocols/procedure/grid.hpp"
#include "tests/support/random.hpp"

namespace palpate::tests {

/// An answer of an observer who is the model itself with the parameters `truth`.
inline std::size_t answer_of(const protocols::OutcomeModel& model,
                             std::span<const double> stimulus,
                             std::span<const double> truth,
                             Random& random) {
    std::vector<double> chances(model.outcomes);
    model.chances(stimulus, truth, chances);
    double left = random.in(0.0, 1.0);
    for (std::size_t r = 0; r + 1 < chances.size(); ++r) {
        left -= chances[r];
        if (left < 0.0) {
            return r;
        }
    }
    return chances.size() - 1;
}

}  // namespace palpate::tests
