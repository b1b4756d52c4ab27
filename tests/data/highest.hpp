#pragma once

#include "tests/support/std.hpp"

namespace palpate::tests {

/// The highest value near a place, by steps along one number at a time that are halved, from `step`
/// to `finest`, when a round gained no more than `gain`. The numbers are left at that place.
template <class Value>
[[nodiscard]] double highest_by_steps(const Value& value,
                                      const std::vector<double*>& numbers,
                                      double step,
                                      double finest,
                                      double gain) {
    double best = value();
    while (step > finest) {
        const double before = best;
        for (double* one : numbers) {
            for (const double by : {step, -step}) {
                const double kept = *one;
                *one += by;
                const double here = value();
                best = std::max(best, here);
                *one = here < best ? kept : *one;
            }
        }
        step *= best > before + gain ? 1.0 : 0.5;
    }
    return best;
}

}  // namespace palpate::tests
