#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "data/fit/fit_report.hpp"

namespace palpate::data {
namespace {

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
