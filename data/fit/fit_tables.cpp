
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "protocols/psychometric/exact_math.hpp"
#include "data/fit/curve_fit.hpp"
#include "data/fit/fit_report.hpp"

namespace palpate::data {
namespace {

std::string_view key_of(Quantity quantity) {
    constexpr std::array<std::string_view, 7> kWords{
        "threshold", "jnd", "weber_fraction", "slope", "guess", "lapse", "stimulus_at"};
    return kWords[static_cast<std::size_t>(quantity)];
}

std::string quantity_text(const FitOptions& options, Quantity quantity) {
    return quantity == Quantity::at_share ? fmt::format("x of P = {:g}", options.at.value_or(0.5))
                                          : std::string(word_of(quantity));
}

using protocols::exponential;
using protocols::Family;

bool logarithmic(Family family) {
    return family == Family::weibull_log10 || family == Family::weibull_db;
}

/// The u of F = 1/4, 1/2 and 3/4, asked for with every sample.
const std::array<double, 3>& quartiles(Family family) {
    static const auto kAll = [] {
        std::array<std::array<double, 3>, protocols::kFamilyWords.size()> all{};
        for (std::size_t i = 0; i < all.size(); ++i) {
            for (std::size_t q = 0; q < 3; ++q) {
                all.at(i).at(q) =
                    core_quantile(static_cast<Family>(i), 0.25 * static_cast<double>(q + 1));
            }
        }
        return all;
    }();
    return kAll.at(static_cast<std::size_t>(family));
}

double jnd_in_slopes(Family family) {
    return 0.5 * (quartiles(family)[2] - quartiles(family)[0]);
}

}  // namespace

Table estimates_table(const FitReport& report, const FittedCurve& curve) {
    const FitOptions& options = report.options;
    Table table{.place = "*",
                .columns = heads({"quantity| ", "estimate|estimate|s", "given||-", "|  ", "se|se|s",
                                  "profile_95|profile|so", "bootstrap_95|bootstrap|so",
                                  "corrected|corrected|s"})};
    for (const FitEstimate& one : curve.estimates) {
        const bool as_lapse = options.spec.two_sided && one.quantity == Quantity::guess;
        table.rows.push_back(
            {Named{std::string(key_of(one.quantity)), quantity_text(options, one.quantity)},
             one.why.empty() ? cell_of(one.value) : Cell(Nothing{one.why}), one.fixed,
             std::string(!one.fixed ? ""
                         : as_lapse ? "as lapse"
                                    : "given"),
             cell_of(one.se), cell_of(one.profile), cell_of(one.bootstrap),
             cell_of(one.corrected)});
    }
    return table;
}

Table differences_table(const FitReport& report) {
    Table table{.place = "differences/-",
                .title =
                    "  Within person (interval: bootstrap; p: likelihood ratio, chi-square of "
                    "1 df)",
                .columns = heads({"participant|person", "comparison", "quantity",
                                  "difference|difference|s", "bootstrap_95|interval|so", "p|p|p"}),
                .index = 3};
    for (const Difference& one : report.differences) {
        table.rows.push_back(
            {one.participant, fmt::format("{} - {}", one.condition, report.conditions.front()),
             Named{std::string(key_of(one.quantity)), std::string(word_of(one.quantity))},
             cell_of(one.value, one.determined ? "unbounded: that of a condition is"
                                               : "not determined: that of a condition is not"),
             cell_of(one.interval), cell_of(one.p)});
    }
    return table;
}

double quantity_of(const CurveSpec& spec,
                   const CurvePoint& point,
                   Quantity quantity,
                   double share) {
    const Family family = spec.family;
    const double b = exponential(point[1]);
    const auto& [lower, half, upper] = quartiles(family);
    const auto place = [&, half = half](double u) {
        return off_axis(family, point[0] + (u - half) / b);
    };
    switch (quantity) {
        case Quantity::threshold:
            return off_axis(family, point[0]);
        case Quantity::jnd:
            return family == Family::weibull ? 0.5 * (place(upper) - place(lower))
                                             : jnd_in_slopes(family) / b;
        case Quantity::weber: {
            if (logarithmic(family) || (family != Family::weibull && !(point[0] > 0.0))) {
                return std::numeric_limits<double>::quiet_NaN();
            }
            const double up = (upper - half) / b;
            const double down = (lower - half) / b;
            return family == Family::weibull ? 0.5 * (exponential(up) - exponential(down))
                                             : jnd_in_slopes(family) / b / point[0];
        }
        case Quantity::slope:
            return b / slope_factor(family);
        case Quantity::guess:
            return spec.two_sided ? point[3] : point[2];
        case Quantity::lapse:
            return point[3];
        case Quantity::at_share: {
            const double bottom = spec.two_sided ? point[3] : point[2];
            const double core = (share - bottom) / (1.0 - bottom - point[3]);
            return core > 0.0 && core < 1.0 ? place(core_quantile(family, core))
                                            : std::numeric_limits<double>::quiet_NaN();
        }
    }
    return std::numeric_limits<double>::quiet_NaN();
}

std::optional<double> standard_error(const CurveSpec& spec,
                                     const CurveFit& fit,
                                     Quantity quantity,
                                     double share) {
    CurvePoint slope{};
    CurvePoint at = fit.at;
    if (spec.family != Family::weibull &&
        (quantity == Quantity::threshold || quantity == Quantity::at_share)) {
        at[0] = 0.0;  // a place moves with the location: far from 0 differences lose their digits
    }
    for (std::size_t i = 0; i < kCurveParameters; ++i) {
        const double se = std::sqrt(fit.covariance[i][i]);
        if (!(se > 0.0) || !std::isfinite(se)) {
            continue;
        }
        const double step = 1e-4 * se;
        CurvePoint up = at;
        CurvePoint down = at;
        up[i] += step;
        down[i] -= step;
        slope[i] =
            (quantity_of(spec, up, quantity, share) - quantity_of(spec, down, quantity, share)) /
            (2.0 * step);
    }
    double variance = 0.0;
    for (std::size_t r = 0; r < kCurveParameters; ++r) {
        for (std::size_t c = 0; c < kCurveParameters; ++c) {
            variance += slope[r] * slope[c] * fit.covariance[r][c];
        }
    }
    return variance > 0.0 && std::isfinite(variance) && !fit.steep && !fit.shallow
             ? std::optional(std::sqrt(variance))
             : std::nullopt;
}

}  // namespace palpate::data
