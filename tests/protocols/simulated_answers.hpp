#pragma once

#include "protocols/procedure/grid.hpp"
#include "tests/support/random.hpp"

namespace palpate::tests {

struct Spread {
    double mean = 0.0;
    double sd = 0.0;
};

inline Spread spread_of(const std::vector<double>& values) {
    const double n = static_cast<double>(values.size());
    Spread spread{std::accumulate(values.begin(), values.end(), 0.0) / n, 0.0};
    for (const double v : values) {
        spread.sd += (v - spread.mean) * (v - spread.mean) / (n - 1.0);
    }
    spread.sd = std::sqrt(spread.sd);
    return spread;
}

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
