#include "tests/bench/timing.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#if defined(__x86_64__)
#include <x86intrin.h>
#endif

namespace palpate::bench {
namespace {

constexpr std::size_t kChunk = 100;
constexpr std::size_t kLitter = 16U << 20U;
constexpr std::size_t kLine = 64;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Puts other things into every cache.
void touch(std::vector<std::uint8_t>& litter) {
    for (std::size_t i = 0; i < litter.size(); i += kLine) {
        litter[i] = static_cast<std::uint8_t>(litter[i] + 1U);
    }
    keep(litter.front());
}

template <int D>
double warm(Method<D>& method, std::span<const Vec<D>> path, double seconds, const Clock& clock) {
    std::vector<double> chunks;
    const auto start = std::chrono::steady_clock::now();
    do {
        method.reset(path.front());
        for (std::size_t i = 0; i < path.size(); i += kChunk) {
            const auto part = path.subspan(i, std::min(kChunk, path.size() - i));
            const std::uint64_t from = Clock::now();
            method.run(part);
            const std::uint64_t to = Clock::now();
            chunks.push_back(clock.between(from, to) / static_cast<double>(part.size()));
        }
    } while (seconds_since(start) < seconds);
    return percentile(std::move(chunks), 0.5);
}

/// Times every `stride`th tick; before it `prepare` runs.
template <int D, class Prepare>
std::vector<double> single(Method<D>& method,
                           std::span<const Vec<D>> path,
                           std::size_t stride,
                           const Clock& clock,
                           Prepare prepare) {
    std::vector<double> ticks;
    method.reset(path.front());
    for (std::size_t i = 0; i < path.size(); ++i) {
        if (i % stride != stride - 1) {
            keep(method.answer(path[i]));
            continue;
        }
        prepare();
        const std::uint64_t from = Clock::now();
        keep(method.answer(path[i]));
        const std::uint64_t to = Clock::now();
        ticks.push_back(clock.between(from, to));
    }
    return ticks;
}

}  // namespace

Clock::Clock() {
    const auto start = std::chrono::steady_clock::now();
    const std::uint64_t from = now();
    while (seconds_since(start) < 0.05) {
    }
    const std::uint64_t to = now();
    ns_ = 1e9 * seconds_since(start) / static_cast<double>(to - from);
    std::vector<double> costs;
    for (int i = 0; i < 2001; ++i) {
        const std::uint64_t a = now();
        const std::uint64_t b = now();
        costs.push_back(static_cast<double>(b - a));
    }
    cost_ = percentile(std::move(costs), 0.5);
}

std::uint64_t Clock::now() noexcept {
#if defined(__x86_64__)
    _mm_lfence();
    const std::uint64_t count = __rdtsc();
    _mm_lfence();
    return count;
#else
    return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
#endif
}

double Clock::between(std::uint64_t from, std::uint64_t to) const noexcept {
    return std::max(0.0, static_cast<double>(to - from) - cost_) * ns_;
}

double percentile(std::vector<double> values, double share) {
    if (values.empty()) {
        return 0.0;
    }
    const auto last = static_cast<double>(values.size() - 1);
    const auto at = static_cast<std::ptrdiff_t>(std::lround(share * last));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
}

template <int D>
Timing time_of(Method<D>& method,
               std::span<const Vec<D>> path,
               const TimingPlan& plan,
               const Clock& clock) {
    Timing timing;
    timing.warm = warm(method, path, plan.warm_seconds, clock);
    const std::vector<double> ticks = single(method, path, 1, clock, [] {});
    timing.p50 = percentile(ticks, 0.5);
    timing.p99 = percentile(ticks, 0.99);
    timing.p999 = percentile(ticks, 0.999);
    if (plan.cold_ticks > 0) {
        std::vector<std::uint8_t> litter(kLitter);
        const std::size_t stride =
            std::max<std::size_t>(1, path.size() / static_cast<std::size_t>(plan.cold_ticks));
        const std::vector<double> cold =
            single(method, path, stride, clock, [&litter] { touch(litter); });
        timing.cold_p50 = percentile(cold, 0.5);
        timing.cold_p99 = percentile(cold, 0.99);
    }
    return timing;
}

template Timing time_of<2>(Method<2>&, std::span<const Vec2>, const TimingPlan&, const Clock&);
template Timing time_of<3>(Method<3>&, std::span<const Vec3>, const TimingPlan&, const Clock&);

}  // namespace palpate::bench
