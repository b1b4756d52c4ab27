#pragma once

#include "tests/bench/method.hpp"
#include "tests/bench/objects.hpp"

namespace palpate::bench {

/// The oracle's answer to one tick.
template <int D>
struct Truth {
    long double distance = 0.0L;  ///< m
    Vec<D> foot{};
};

/// How far answers are from the global closest point.
struct Errors {
    double distance_p50 = 0.0;  ///< |d - d_oracle|, m
    double distance_p99 = 0.0;
    double distance_max = 0.0;
    double foot_p99 = 0.0;  ///< |foot - foot_oracle|, m; at a tie either foot is right
    double misses = 0.0;    ///< share of ticks with a distance more than kMiss off
};

inline constexpr double kMiss = 1e-6;  ///< m: 1 mN at 1000 N/m

[[nodiscard]] std::vector<Truth<2>> truths(const Object& object, std::span<const Vec2> path);

template <int D>
[[nodiscard]] Errors errors_of(Method<D>& method,
                               std::span<const Vec<D>> path,
                               std::span<const Truth<D>> truth);

}  // namespace palpate::bench
