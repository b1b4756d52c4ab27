#include "tests/bench/timing.hpp"

#include "tests/bench/own_methods.hpp"

#if defined(__x86_64__)
#include <x86intrin.h>
#endif

namespace palpate::bench {
namespace {

constexpr std::size_t kUnits = 1000;
constexpr double kRound = 50e3;     ///< ns
constexpr double kLook = 5e6;       ///< ns between two looks for stolen time
constexpr std::size_t kFewest = 6;  ///< of each round, kept: so many have an interval
constexpr double kPatience = 8.0;
constexpr double kShared = 1.05;
constexpr std::size_t kApart = 20;  ///< ticks between two cold ones, at least
constexpr std::size_t kLitter = 16U << 20U;
constexpr std::size_t kLine = 64;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Puts other things into every cache.
void touch(std::vector<std::uint8_t>& litter) {
    for (std::size_t i = 0; i < litter.size(); i += kLine) {
        litter[i] = static_cast<std::uint8_t>(litter[i] + 1U);
    }
    keep(litter.front());
}

std::size_t not_numbers(const std::vector<double>& values) {
    return static_cast<std::size_t>(
        std::ranges::count_if(values, [](double v) { return std::isnan(v); }));
}

/// Six chains of additions that do not wait for one another: they fill a core, and so feel who
/// shares it. About 2 us.
double fill_the_core(const Clock& clock) {
    std::uint64_t a = 0;
    std::uint64_t b = 0;
    std::uint64_t c = 0;
    std::uint64_t d = 0;
    std::uint64_t e = 0;
    std::uint64_t f = 0;
    const std::uint64_t from = Clock::now();
    for (int i = 0; i < 3000; ++i) {
        a += 7;
        b += 7;
        c += 7;
        d += 7;
        e += 7;
        f += 7;
        asm volatile("" : "+r"(a), "+r"(b), "+r"(c), "+r"(d), "+r"(e), "+r"(f));
    }
    return clock.between(from, Clock::now());
}

/// Each tick by itself, but those of rounds in which another had the core: pass after pass, until
/// half a path's are there.
template <int D>
std::vector<double> single(Method<D>& method, std::span<const Vec<D>> path, Stand& stand) {
    constexpr std::size_t kTogether = 20;
    std::vector<double> ticks;
    for (int pass = 0; pass < 5 && 2 * ticks.size() < path.size(); ++pass) {
        method.reset(path.front());
        for (std::size_t first = 0; first < path.size(); first += kTogether) {
            const std::size_t before = ticks.size();
            stand.watch.begin();
            for (const Vec<D>& hip :
                 path.subspan(first, std::min(kTogether, path.size() - first))) {
                const std::uint64_t from = Clock::now();
                keep(method.answer(hip));
                ticks.push_back(stand.clock.between(from, Clock::now()));
            }
            if (!stand.watch.ours()) {
                ticks.resize(before);
            }
        }
    }
    return ticks;
}

template <int D>
std::vector<double> cold(Method<D>& method, std::span<const Vec<D>> path, int count, Stand& stand) {
    std::vector<std::uint8_t> litter(kLitter);
    const std::size_t stride =
        std::max<std::size_t>(kApart, path.size() / static_cast<std::size_t>(count));
    std::vector<double> ticks;
    method.reset(path.front());
    for (std::size_t i = 0; i < path.size(); ++i) {
        if (i % stride != stride - 1) {
            keep(method.answer(path[i]));
            continue;
        }
        touch(litter);
        stand.watch.begin();
        const std::uint64_t from = Clock::now();
        keep(method.answer(path[i]));
        const std::uint64_t to = Clock::now();
        if (stand.watch.ours()) {
            ticks.push_back(stand.clock.between(from, to));
        }
    }
    return ticks;
}

}  // namespace

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Median median(std::vector<double> values) {
    if (values.empty()) {
        return {kNone, kNone, kNone};
    }
    std::ranges::sort(values);
    const std::size_t n = values.size();
    // Fewer than k of n values lie below the median with the chance of fewer than k heads.
    std::size_t k = 0;
    double term = std::pow(0.5, static_cast<double>(n));
    for (double below = term; below <= 0.025; below += term) {
        ++k;
        term *= static_cast<double>(n - k + 1) / static_cast<double>(k);
    }
    const std::size_t first = k > 0 ? k - 1 : 0;
    return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values[first], values[n - 1 - first]};
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

std::size_t Passes::rounds() const {
    return ns.empty() ? 0 : ns.size() * ns.front().size();
}

std::size_t Passes::thrown() const {
    return std::transform_reduce(ns.begin(), ns.end(), std::size_t{0}, std::plus<>(), not_numbers);
}

Stand::Stand() : unit(newton_update()) {
    const auto start = std::chrono::steady_clock::now();
    while (seconds_since(start) < 0.3) {
        static_cast<void>(shared());
    }
}

bool Stand::shared() {
    const double filled = fill_the_core(clock);
    fastest_ = std::min(fastest_, filled);
    return filled > kShared * fastest_;
}

template <int D>
std::size_t rounds_of(Method<D>& method, std::span<const Vec<D>> path, const Clock& clock) {
    method.reset(path.front());
    const std::uint64_t from = Clock::now();
    method.run(path);
    const double rounds = clock.between(from, Clock::now()) / kRound;
    return std::clamp<std::size_t>(static_cast<std::size_t>(rounds), 1, (path.size() + 9) / 10);
}

template <int D>
void pass(Passes& passes,
          Method<D>& method,
          std::span<const Vec<D>> path,
          std::size_t rounds,
          Stand& stand) {
    static const std::vector<Vec2> units(kUnits);
    // Never quiet so far: then rounds beside a neighbour count as well, and the interval says so.
    const bool noisy =
        passes.ns.size() >= 8 && 20 * (passes.rounds() - passes.thrown()) < passes.rounds();
    std::vector<double>& ratio = passes.ratio.emplace_back();
    std::vector<double>& ns = passes.ns.emplace_back();
    std::size_t looked = 0;
    double since = 0.0;
    static_cast<void>(stand.watch.stolen());
    method.reset(path.front());
    bool shared = stand.shared();
    for (std::size_t i = 0; i < rounds; ++i) {
        const std::size_t first = i * path.size() / rounds;
        const auto part = path.subspan(first, (i + 1) * path.size() / rounds - first);
        const bool before = shared;
        stand.watch.begin();
        const std::uint64_t from = Clock::now();
        stand.unit->run(units);
        const std::uint64_t middle = Clock::now();
        method.run(part);
        const std::uint64_t to = Clock::now();
        const bool ours = stand.watch.ours();
        shared = stand.shared();
        const bool kept = ours && (noisy || (!before && !shared));
        const double each = stand.clock.between(middle, to) / static_cast<double>(part.size());
        const double unit = stand.clock.between(from, middle) / static_cast<double>(kUnits);
        ns.push_back(kept ? each : kNone);
        ratio.push_back(kept ? each / unit : kNone);
        since += stand.clock.between(from, to);
        if (since > kLook || i + 1 == rounds) {
            if (stand.watch.stolen()) {
                std::fill(ns.begin() + static_cast<std::ptrdiff_t>(looked), ns.end(), kNone);
                std::fill(ratio.begin() + static_cast<std::ptrdiff_t>(looked), ratio.end(), kNone);
            }
            looked = ns.size();
            since = 0.0;
        }
    }
}

Median along(const std::vector<std::vector<double>>& passes, const std::vector<double>& weights) {
    Median sum;
    double weight = 0.0;
    for (std::size_t i = 0; !passes.empty() && i < passes.front().size(); ++i) {
        const Median here = median(round_of(passes, i));
        const double w = weights.empty() ? 1.0 : weights[i];
        if (!std::isnan(here.value * w)) {
            sum.value += w * here.value;
            sum.low += w * here.low;
            sum.high += w * here.high;
            weight += w;
        }
    }
    return {sum.value / weight, sum.low / weight, sum.high / weight};
}

std::vector<double> round_of(const std::vector<std::vector<double>>& passes, std::size_t i) {
    std::vector<double> kept;
    for (const std::vector<double>& one : passes) {
        if (!std::isnan(one[i])) {
            kept.push_back(one[i]);
        }
    }
    return kept;
}

bool Passes::enough() const {
    for (std::size_t i = 0; !ns.empty() && i < ns.front().size(); ++i) {
        if (round_of(ns, i).size() < kFewest) {
            return false;
        }
    }
    return !ns.empty();
}

template <int D>
Timing time_of(Method<D>& method,
               std::span<const Vec<D>> path,
               const TimingPlan& plan,
               Stand& stand) {
    Passes passes;
    const auto start = std::chrono::steady_clock::now();
    const std::size_t rounds = rounds_of(method, path, stand.clock);
    do {
        pass(passes, method, path, rounds, stand);
    } while (seconds_since(start) < plan.warm_seconds ||
             (!passes.enough() && seconds_since(start) < kPatience * plan.warm_seconds));
    Timing timing{.ratio = along(passes.ratio),
                  .warm = along(passes.ns).value,
                  .rounds = static_cast<double>(passes.rounds()),
                  .thrown = static_cast<double>(passes.thrown())};
    const std::vector<double> ticks = single(method, path, stand);
    timing.p50 = percentile(ticks, 0.5);
    timing.p99 = percentile(ticks, 0.99);
    timing.p999 = percentile(ticks, 0.999);
    if (plan.cold_ticks > 0) {
        const std::vector<double> few = cold(method, path, plan.cold_ticks, stand);
        timing.cold_p50 = percentile(few, 0.5);
        timing.cold_p99 = percentile(few, 0.99);
    }
    return timing;
}

template std::size_t rounds_of<2>(Method<2>&, std::span<const Vec2>, const Clock&);
template std::size_t rounds_of<3>(Method<3>&, std::span<const Vec3>, const Clock&);
template void pass<2>(Passes&, Method<2>&, std::span<const Vec2>, std::size_t, Stand&);
template void pass<3>(Passes&, Method<3>&, std::span<const Vec3>, std::size_t, Stand&);
template Timing time_of<2>(Method<2>&, std::span<const Vec2>, const TimingPlan&, Stand&);
template Timing time_of<3>(Method<3>&, std::span<const Vec3>, const TimingPlan&, Stand&);

}  // namespace palpate::bench
