#include <iostream>

#include "tests/bench/commands.hpp"
#include "tests/bench/hand.hpp"
#include "tests/bench/own_methods.hpp"
#include "tests/bench/report.hpp"

namespace palpate::bench {
namespace {

constexpr std::array<std::size_t, 9> kCounts{2, 10, 30, 100, 300, 1000, 10000, 30000, 100000};
/// The hand goes along so many of them at most: 20 s at 0.26 m/s are 5.2 m of 10.4 mm each.
constexpr std::size_t kReached = 600;
constexpr double kSecondsPerRow = 2.0;

/// The part of a ring that the hand can reach, and a margin on either side, as an object of its
/// own.
Object reached(const Object& ring) {
    Object part = ring;
    if (part.curves.size() > kReached) {
        part.curves.resize(kReached);
    }
    return part;
}

/// So many ticks that a row takes about kSecondsPerRow, at least 200.
std::size_t affordable(Method<2>& method, const std::vector<Vec2>& path) {
    method.reset(path.front());
    const std::size_t trial = std::min<std::size_t>(200, path.size());
    const auto start = std::chrono::steady_clock::now();
    method.run(std::span<const Vec2>(path).first(trial));
    const double each = seconds_since(start) / static_cast<double>(trial);
    const auto count = static_cast<std::size_t>(0.2 * kSecondsPerRow / std::max(each, 1e-9));
    return std::clamp(count, trial, path.size());
}

}  // namespace

int scaling_command(Words words) {
    const std::string csv_name = words.value("--csv");
    words.finish();
    Output csv(csv_name,
               "machine,curves,method,build_s,ticks,ratio,ratio_low,ratio_high,warm_ns,tick_p50_ns,"
               "tick_p99_ns,tick_p999_ns,distance_error_max_m,miss_share\n");
    pin_to(1);
    Stand stand;
    std::cout << machine() << '\n';
    std::printf("%8s  %-24s %9s %7s %8s %11s %11s %11s %11s %9s %7s\n", "curves", "method",
                "build s", "ticks", "x unit", "ns", "p50", "p99", "p99.9", "e_d max", "miss %");
    for (const std::size_t count : kCounts) {
        const Object ring = ring_of(count);
        const Object part = reached(ring);
        const bool whole = part.curves.size() == ring.curves.size();
        const std::vector<Vec2> path =
            hand_along(part, {.nearest = -1e-3, .farthest = 1e-3, .closed = whole});
        const auto start = std::chrono::steady_clock::now();
        const Methods<2> methods = scaling_methods(ring);
        const double build = seconds_since(start) / static_cast<double>(methods.size());
        for (const auto& method : methods) {
            const std::vector<Vec2> hips(
                path.begin(),
                path.begin() + static_cast<std::ptrdiff_t>(affordable(*method, path)));
            const Timing time =
                time_of<2>(*method, hips, {.warm_seconds = 0.2, .cold_ticks = 0}, stand);
            // The first ticks alone: the oracle looks at every curve that the hand can reach.
            const std::vector<Vec2> few(
                hips.begin(), hips.begin() + std::min<std::ptrdiff_t>(200, std::ssize(hips)));
            const std::vector<Truth<2>> truth = truths(part, few);
            const Errors error = errors_of<2>(*method, few, std::span<const Truth<2>>(truth));
            std::printf("%8zu  %-24s %9.4f %7zu %8.3f %11.1f %11.1f %11.1f %11.1f %9.1e %7.2f\n",
                        count, method->name().c_str(), build, hips.size(), time.ratio.value,
                        time.warm, time.p50, time.p99, time.p999, error.distance_max,
                        100.0 * error.misses);
            csv << printed(
                "\"%s\",%zu,\"%s\",%.6f,%zu,%.4f,%.4f,%.4f,%.2f,%.1f,%.1f,%.1f,%.6g,%.6g\n",
                machine().c_str(), count, method->name().c_str(), build, hips.size(),
                time.ratio.value, time.ratio.low, time.ratio.high, time.warm, time.p50, time.p99,
                time.p999, error.distance_max, error.misses);
        }
    }
    csv.finish();
    return 0;
}

}  // namespace palpate::bench
