#include "tests/bench/errors.hpp"

#include "tests/bench/timing.hpp"
#include "tests/support/foot_oracle.hpp"

namespace palpate::bench {

std::vector<Truth<2>> truths(const Object& object, std::span<const Vec2> path) {
    std::vector<tests::FootOracle> oracles;
    for (const auto& curve : object.curves) {
        oracles.emplace_back(curve);
    }
    std::vector<Truth<2>> all;
    for (const Vec2& hip : path) {
        tests::OracleFoot best = oracles.front().closest(hip);
        for (std::size_t i = 1; i < oracles.size(); ++i) {
            const tests::OracleFoot foot = oracles[i].closest(hip);
            best = foot.distance < best.distance ? foot : best;
        }
        all.push_back({best.distance, best.foot()});
    }
    return all;
}

template <int D>
Errors errors_of(Method<D>& method, std::span<const Vec<D>> path, std::span<const Truth<D>> truth) {
    std::vector<double> distance;
    std::vector<double> foot;
    std::size_t missed = 0;
    method.reset(path.front());
    for (std::size_t i = 0; i < path.size(); ++i) {
        const Answer<D> answer = method.answer(path[i]);
        const auto error = static_cast<double>(std::fabs(answer.distance - truth[i].distance));
        distance.push_back(error);
        foot.push_back(glm::length(answer.foot - truth[i].foot));
        missed += error <= kMiss ? 0U : 1U;
    }
    return {.distance_p50 = percentile(distance, 0.5),
            .distance_p99 = percentile(distance, 0.99),
            .distance_max = percentile(distance, 1.0),
            .foot_p99 = percentile(foot, 0.99),
            .misses = static_cast<double>(missed) / static_cast<double>(path.size())};
}

template Errors errors_of<2>(Method<2>&, std::span<const Vec2>, std::span<const Truth<2>>);
template Errors errors_of<3>(Method<3>&, std::span<const Vec3>, std::span<const Truth<3>>);

}  // namespace palpate::bench
