#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

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

constexpr int kSteps = 200;

Series shares_of(const FittedCurve& curve, Ink ink) {
    std::map<double, std::pair<double, double>> counts;
    for (const Level& level : curve.answers.levels) {
        counts[level.stimulus].first += static_cast<double>(level.n);
        counts[level.stimulus].second += static_cast<double>(level.k);
    }
    Series shares{
        .name = curve.answers.condition, .ink = ink, .mark = Mark::points, .opacity = 0.7};
    for (const auto& [stimulus, nk] : counts) {
        if (nk.first > 0.0) {
            shares.sizes.push_back(std::min(1.5 + 0.8 * std::sqrt(nk.first), 9.0));
            shares.add(stimulus, nk.second / nk.first);
        }
    }
    return shares;
}

double chance(const CurveSpec& spec, const CurvePoint& at, double stimulus) {
    const double u = std::exp(at[1]) * (on_axis(spec.family, stimulus) - at[0]) +
                     core_quantile(spec.family, 0.5);
    return at[2] + (1.0 - at[2] - at[3]) * core_value(spec.family, u).below;
}

/// The middle 95 % of the bootstrap's curves, at each stimulus by itself.
Band band_of(const CurveSpec& spec, const FittedCurve& curve, double low, double high) {
    constexpr int kPlaces = 40;
    constexpr std::size_t kFewest = 40;  // samples that have an outermost twentieth
    Band band;
    std::vector<double> chances(curve.samples.at.size());
    for (int i = 0; chances.size() >= kFewest && i <= kPlaces; ++i) {
        band.x.push_back(low + (high - low) * i / kPlaces);
        std::ranges::transform(curve.samples.at, chances.begin(), [&](const CurvePoint& at) {
            return chance(spec, at, band.x.back());
        });
        const std::size_t tail = chances.size() / 40;
        for (const std::size_t place : {tail, chances.size() - 1 - tail}) {
            std::ranges::nth_element(chances, chances.begin() + static_cast<std::ptrdiff_t>(place));
            (place == tail ? band.low : band.high).push_back(chances[place]);
        }
    }
    return band;
}

void add_curve(Panel& panel, const CurveSpec& spec, const FittedCurve& curve, Ink ink) {
    Series shares = shares_of(curve, ink);
    const double low = shares.x.front();
    const double high = shares.x.back();
    panel.series.push_back(std::move(shares));
    if (curve.fit.shallow) {
        return;
    }
    Series line{.ink = ink};
    for (int i = 0; i <= kSteps; ++i) {
        const double stimulus = low + (high - low) * i / kSteps;
        line.add(stimulus, chance(spec, curve.fit.at, stimulus));
    }
    if (Band band = band_of(spec, curve, low, high); !band.x.empty()) {
        band.ink = ink;
        panel.bands.push_back(std::move(band));
    }
    panel.series.push_back(std::move(line));
    const FitEstimate& threshold = curve.estimates.front();
    if (threshold.profile && std::isfinite(threshold.profile->low) &&
        std::isfinite(threshold.profile->high)) {
        const double y = chance(
            spec, curve.fit.at,
            std::isnan(threshold.value) ? off_axis(spec.family, curve.fit.at[0]) : threshold.value);
        panel.series.push_back(
            interval_bar(threshold.profile->low, y, threshold.profile->high, y, ink));
    }
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

Figure fit_figure(const FitReport& report) {
    const CurveSpec& spec = report.options.spec;
    const std::string& stimulus = report.options.stimulus;
    Figure figure{.id = "fit",
                  .title = fmt::format("Psychometric functions ({})", word_of(spec.family))};
    std::vector<std::string> people;
    for (const FittedCurve& curve : report.curves) {
        const std::string& person = curve.answers.participant;
        auto found = std::ranges::find(people, person);
        if (found == people.end()) {
            people.push_back(person);
            found = people.end() - 1;
            figure.panels.push_back({.title = person,
                                     .x = {.label = stimulus.empty() ? "stimulus" : stimulus},
                                     .y = {.label = "share of 1", .low = -0.05, .high = 1.05}});
        }
        const auto condition = std::ranges::find(report.conditions, curve.answers.condition) -
                               report.conditions.begin();
        add_curve(figure.panels[static_cast<std::size_t>(found - people.begin())], spec, curve,
                  ink_of(static_cast<std::size_t>(condition)));
    }
    figure.columns = people.size() > 1 ? 2 : 1;
    figure.caption =
        "Dots: shares of the answers, larger for more of them. Bands: the middle 95 % of bootstrap "
        "samples. Bars: 95 % profile intervals of the thresholds.";
    return figure;
}

}  // namespace palpate::data
