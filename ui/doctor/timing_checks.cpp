#include <algorithm>
#include <array>
#include <ctime>

#include <fmt/format.h>

#include "engine/base/clock.hpp"
#include "engine/base/files.hpp"
#include "engine/realtime/tick_loop.hpp"
#include "ui/doctor/checks.hpp"

namespace palpate::ui {
namespace {

constexpr int kRounds = 5;
/// More times slower than cyclictest than this is worth a look.
constexpr double kRatio = 2.0;

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0.0 : values[values.size() / 2];
}

double us(std::int64_t ns) {
    return static_cast<double>(ns) * 1e-3;
}

constexpr int kReads = 200'000;

/// What a reading costs, ns, and how often one was earlier than the one before.
std::pair<double, int> read_clock() {
    int back = 0;
    const std::int64_t start = monotonic_ns();
    std::int64_t last = start;
    for (int i = 0; i < kReads; ++i) {
        const std::int64_t now = monotonic_ns();
        back += now < last ? 1 : 0;
        last = now;
    }
    return {static_cast<double>(last - start) / kReads, back};
}

void judge_lateness(Check& check, const engine::LatenessHistogram& lateness, bool all_rights) {
    const double ticks = std::max(1.0, static_cast<double>(lateness.count()));
    const double late = static_cast<double>(lateness.late()) / ticks;
    const char* rights = all_rights ? "" : ", grant what was refused above";
    if (lateness.count() == 0 || late > 0.01) {
        check.fails(fmt::format(
            "more than 1 % of the ticks are late: close other programs{}, run on the machine "
            "itself instead of a virtual one, or lower the protocol's rate",
            rights));
    } else if (late > 0.0002 || lateness.missed() > 0) {
        check.warns(
            fmt::format("close other programs{}; every late tick is marked in the data", rights));
    }
}

/// ns, and what that is called.
constexpr std::array<std::pair<std::int64_t, const char*>, 10> kBarBounds{{{1'000, "1 us"},
                                                                           {5'000, "5 us"},
                                                                           {10'000, "10 us"},
                                                                           {20'000, "20 us"},
                                                                           {50'000, "50 us"},
                                                                           {100'000, "100 us"},
                                                                           {200'000, "200 us"},
                                                                           {500'000, "500 us"},
                                                                           {1'000'000, "1 ms"},
                                                                           {10'000'000, "10 ms"}}};

}  // namespace

Check check_clock() {
    timespec resolution{};
    clock_getres(CLOCK_MONOTONIC, &resolution);
    const auto [cost, back] = read_clock();
    const std::string source =
        first_line("/sys/devices/system/clocksource/clocksource0/current_clocksource");
    Check check{.name = "clock",
                .detail = fmt::format("CLOCK_MONOTONIC from {}, resolution {} ns, {:.0f} ns to "
                                      "read, {} steps back in {} readings",
                                      source.empty() ? "an unknown source" : source,
                                      resolution.tv_nsec, cost, back, kReads),
                .numbers = {{"resolution_ns", static_cast<double>(resolution.tv_nsec)},
                            {"read_ns", cost},
                            {"steps_back", back}}};
    if (back > 0 || resolution.tv_sec > 0 || resolution.tv_nsec > 1000) {
        check.fails("times of this machine cannot be trusted: use another kernel or machine");
    } else if (cost > 500.0) {
        check.warns("the clock is slow to read: boot with clocksource=tsc if the processor allows");
    }
    return check;
}

std::vector<Check> check_rights(const engine::RealtimeRights& rights) {
    std::vector<Check> checks;
    for (std::size_t i = 0; i < engine::kRights; ++i) {
        const auto right = static_cast<engine::Right>(i);
        const engine::Grant grant = rights.of(right).grant;
        const bool short_of = grant == engine::Grant::refused || grant == engine::Grant::partly;
        checks.push_back({.name = std::string(engine::name_of(right)),
                          .status = short_of ? CheckStatus::warn : CheckStatus::ok,
                          .detail = engine::describe(right, rights),
                          .remedy = engine::remedy(right, rights),
                          .numbers = {{"granted", short_of ? 0.0 : 1.0}}});
    }
    return checks;
}

JitterRun run_jitter(double rate_hz, double seconds) {
    JitterRun run{.rate_hz = rate_hz, .all = {}, .p50_ratios = {}, .p99_ratios = {}};
    run.installed = cyclictest_installed();
    double used = 0.0;
    for (int round = 0; round < kRounds; ++round) {
        const WakeUps ours =
            measure_wake_ups(rate_hz, seconds / kRounds, engine::RealtimeWish::everything());
        run.all.lateness.add(ours.lateness);
        run.all.rights = ours.rights;
        used += ours.processor_share / kRounds;
        if (!run.installed) {
            continue;
        }
        const bool fifo = ours.rights.of(engine::Right::fifo).grant == engine::Grant::given;
        const auto theirs = run_cyclictest(rate_hz, seconds / kRounds, fifo);
        if (theirs && theirs->quantile_us(0.5) > 0.0) {
            run.p50_ratios.push_back(us(ours.lateness.quantile_ns(0.50)) /
                                     theirs->quantile_us(0.50));
            run.p99_ratios.push_back(us(ours.lateness.quantile_ns(0.99)) /
                                     theirs->quantile_us(0.99));
        }
    }
    run.all.processor_share = used;
    return run;
}

Check check_jitter(const JitterRun& run) {
    const engine::LatenessHistogram& lateness = run.all.lateness;
    const std::int64_t p99 = lateness.quantile_ns(0.99);
    Check check{.name = "jitter",
                .detail = fmt::format("{:.0f} Hz: {}; {:.1f} % of a processor", run.rate_hz,
                                      describe(lateness), 100.0 * run.all.processor_share),
                .numbers = {{"rate_hz", run.rate_hz},
                            {"ticks", static_cast<double>(lateness.count())},
                            {"p50_us", us(lateness.quantile_ns(0.5))},
                            {"p99_us", us(p99)},
                            {"p999_us", us(lateness.quantile_ns(0.999))},
                            {"max_us", us(lateness.max_ns())},
                            {"late", static_cast<double>(lateness.late())},
                            {"missed", static_cast<double>(lateness.missed())},
                            {"processor_share", run.all.processor_share}},
                .picture = bars(lateness)};
    judge_lateness(check, lateness, run.all.rights.complete());
    return check;
}

Check check_cyclictest(const JitterRun& run) {
    Check check{.name = "cyclictest"};
    if (!run.installed) {
        check.detail = "not installed: nothing to compare the jitter with";
        check.remedy = "if you want to compare: apt-get install rt-tests";
        return check;
    }
    if (run.p50_ratios.empty()) {
        check.detail =
            "installed, but it gave no result: it wants the right to real-time scheduling";
        check.warns("see scheduling above, or run this as root");
        return check;
    }
    const double p50 = median(run.p50_ratios);
    const double p99 = median(run.p99_ratios);
    check.detail = fmt::format(
        "our lateness as a multiple of its, median of {} rounds in turns: {:.2f} (half of the "
        "ticks), {:.2f} (99 %)",
        run.p50_ratios.size(), p50, p99);
    check.numbers = {{"rounds", static_cast<double>(run.p50_ratios.size())},
                     {"p50_ratio", p50},
                     {"p99_ratio", p99}};
    if (p50 > kRatio || p99 > kRatio) {
        check.warns("run the doctor again with nothing else running and --seconds 30");
    }
    return check;
}

std::vector<std::string> bars(const engine::LatenessHistogram& histogram) {
    constexpr double kLongest = 40.0;
    std::vector<std::string> lines;
    const auto line = [&](const char* sign, const char* name, std::int64_t count) {
        const double share = static_cast<double>(count) /
                             static_cast<double>(std::max<std::int64_t>(1, histogram.count()));
        // At least one mark where there is anything at all.
        const auto marks = static_cast<std::size_t>(share * kLongest + (count > 0 ? 1.0 : 0.0));
        lines.push_back(
            fmt::format("{:<2}{:>7} {:>8}  {}", sign, name, count, std::string(marks, '#')));
    };
    std::int64_t before = 0;
    for (const auto& [ns, name] : kBarBounds) {
        const std::int64_t below = histogram.below(ns);
        if (below > 0 || !lines.empty()) {
            line("<", name, below - before);
        }
        before = below;
        if (before == histogram.count()) {
            break;
        }
    }
    if (before < histogram.count()) {
        line(">=", kBarBounds.back().second, histogram.count() - before);
    }
    return lines;
}

}  // namespace palpate::ui
