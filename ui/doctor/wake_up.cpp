#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <ctime>
#include <numeric>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "engine/base/shell.hpp"
#include "engine/device/device.hpp"
#include "engine/realtime/thread_servo.hpp"
#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "ui/doctor/checks.hpp"

namespace palpate::ui {
namespace {

constexpr std::size_t kBins = 5000;  ///< us; beyond, cyclictest counts overflows

std::optional<std::int64_t> number_in(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
    std::int64_t value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && value >= 0 ? std::optional(value) : std::nullopt;
}

/// What follows `label` at the start of `line`.
std::optional<std::int64_t> labelled(std::string_view line, std::string_view label) {
    return line.starts_with(label) ? number_in(line.substr(label.size())) : std::nullopt;
}

class NoDevice : public engine::Device {
public:
    engine::Reading read() noexcept override { return {.hip = {0.0, 0.06, 0.0}}; }
    engine::AppliedForce write(const engine::Vec3& /*force*/) noexcept override { return {}; }
    [[nodiscard]] std::string name() const override { return "none"; }
};

double processor_s() {
    timespec used{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return static_cast<double>(used.tv_sec) + static_cast<double>(used.tv_nsec) * 1e-9;
}

}  // namespace

std::int64_t Cyclictest::total() const {
    return std::accumulate(counts.begin(), counts.end(), overflows);
}

double Cyclictest::quantile_us(double share) const {
    const double wanted = std::clamp(share, 0.0, 1.0) * static_cast<double>(total());
    double seen = 0.0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        const auto here = static_cast<double>(counts[i]);
        if (here > 0.0 && seen + here >= wanted) {
            return static_cast<double>(i) + std::max(0.0, wanted - seen) / here;
        }
        seen += here;
    }
    return max_us;
}

std::optional<Cyclictest> parse_cyclictest(std::string_view output) {
    Cyclictest result;
    while (!output.empty()) {
        const std::size_t end = output.find('\n');
        const std::string_view line = output.substr(0, end);
        output.remove_prefix(end == std::string_view::npos ? output.size() : end + 1);
        if (const auto max = labelled(line, "# Max Latencies:")) {
            result.max_us = static_cast<double>(*max);
        } else if (const auto over = labelled(line, "# Histogram Overflows:")) {
            result.overflows = *over;
        } else if (!line.empty() && line.front() >= '0' && line.front() <= '9') {
            const auto bin = number_in(line);
            const auto count = number_in(line.substr(std::min(line.find(' '), line.size())));
            if (bin && count && *bin < 1'000'000) {
                const auto at = static_cast<std::size_t>(*bin);
                result.counts.resize(std::max(result.counts.size(), at + 1));
                result.counts[at] = *count;
            }
        }
    }
    return result.total() > 0 ? std::optional(result) : std::nullopt;
}

bool cyclictest_installed() {
    return output_of("command -v cyclictest 2>/dev/null").second == 0;
}

std::optional<Cyclictest> run_cyclictest(double rate_hz, double seconds, bool realtime) {
    const auto interval = std::lround(1e6 / rate_hz);
    const auto loops = std::max(1L, std::lround(seconds * rate_hz));
    return parse_cyclictest(
        output_of(fmt::format("cyclictest -q -t1 -i{} -l{} -h{}{} 2>/dev/null", interval, loops,
                              kBins, realtime ? " -m -p80" : ""))
            .first);
}

WakeUps measure_wake_ups(double rate_hz,
                         double seconds,
                         const engine::RealtimeWish& wish,
                         double spin_share) {
    NoDevice device;
    const engine::Scene scene(stimuli::make_outline(stimuli::TwoCurve{}), {});
    engine::ThreadServo servo(device, {.rate_hz = rate_hz,
                                       .limits = {.ramp_step = 1.0},
                                       .realtime = wish,
                                       .spin_share = spin_share});
    servo.begin(scene);
    const double before = processor_s();
    while (servo.elapsed_s() < seconds) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    const double used = processor_s() - before;
    const double elapsed = servo.elapsed_s();
    servo.end();
    return {
        .lateness = servo.lateness(), .rights = servo.rights(), .processor_share = used / elapsed};
}

}  // namespace palpate::ui
