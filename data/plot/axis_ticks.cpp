#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/plot/svg_panel.hpp"
#include "data/plot/svg_text.hpp"

namespace palpate::data {
namespace {

/// A share of a step by which a tick may lie beyond the axis: rounding of low / step.
constexpr double kSlack = 1e-9;

AxisTicks linear_ticks(const AxisRange& range, int wanted) {
    const double raw = (range.high - range.low) / std::max(wanted, 1);
    int power = static_cast<int>(std::floor(std::log10(raw)));
    const double mantissa = raw / std::pow(10.0, power);
    int digit = mantissa < 1.5 ? 1 : mantissa < 3.5 ? 2 : mantissa < 7.5 ? 5 : 10;
    if (digit == 10) {
        digit = 1;
        ++power;
    }
    const double step = digit * std::pow(10.0, power);

    AxisTicks out;
    const double max = std::max(std::fabs(range.low), std::fabs(range.high));
    if (max >= 1e5 || max < 1e-2) {
        out.exponent = 3 * static_cast<int>(std::floor(std::log10(max) / 3.0));
    }
    const int decimals = std::max(0, out.exponent - power);
    const double unit = digit * std::pow(10.0, power - out.exponent);
    const double first = std::ceil(range.low / step - kSlack);
    const double last = std::floor(range.high / step + kSlack);
    for (double k = first; k <= last; k += 1.0) {
        std::string label = fmt::format("{:.{}f}", k == 0.0 ? 0.0 : k * unit, decimals);
        if (label.front() == '-') {
            label.replace(0, 1, "−");
        }
        out.ticks.push_back({k * step, label});
    }
    return out;
}

AxisTicks log_ticks(const AxisRange& range, int wanted) {
    const int first = static_cast<int>(std::floor(std::log10(range.low) - kSlack));
    const int last = static_cast<int>(std::ceil(std::log10(range.high) + kSlack));
    const int every = std::max(1, (last - first) / std::max(wanted, 1));
    const bool plain = first >= -3 && last <= 4;                 // 0.001 to 10000 need no powers
    const bool close = plain && range.high < 100.0 * range.low;  // room to name 2 and 5 too
    AxisTicks out;
    for (int decade = first; decade <= last; ++decade) {
        for (int digit = 1; digit <= 9; ++digit) {
            const double at = digit * std::pow(10.0, decade);
            const bool named =
                (digit == 1 && decade % every == 0) || (close && (digit == 2 || digit == 5));
            if (at < range.low * (1.0 - kSlack) || at > range.high * (1.0 + kSlack) ||
                (digit > 1 && last - first > 8)) {
                continue;
            }
            const std::string label = plain ? fmt::format("{:.{}f}", at, std::max(0, -decade))
                                            : "10" + superscript(decade);
            out.ticks.push_back({at, named ? label : ""});
        }
    }
    return out;
}

}  // namespace

double AxisRange::share(double value) const {
    return log ? std::log10(value / low) / std::log10(high / low) : (value - low) / (high - low);
}

bool AxisRange::holds(double value) const {
    return std::isfinite(value) && (!log || value > 0.0);
}

AxisTicks nice_ticks(const AxisRange& range, int wanted) {
    return range.log && range.high >= 10.0 * range.low ? log_ticks(range, wanted)
                                                       : linear_ticks(range, wanted);
}

}  // namespace palpate::data
