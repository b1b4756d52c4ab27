#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "data/page/sections.hpp"

namespace palpate::data {

std::vector<std::string> frictions_of(const Study& study) {
    std::vector<protocols::FrictionSpec> all = study.protocol().frictions;
    std::ranges::stable_sort(all, {}, &protocols::FrictionSpec::mu_s);
    std::vector<std::string> names;
    for (const auto& one : all) {
        names.push_back(one.name);
    }
    return names;
}

Ink ink_of(std::size_t friction) {
    constexpr Ink kInks[] = {Ink::blue,   Ink::vermillion, Ink::green,
                             Ink::purple, Ink::orange,     Ink::sky};
    return kInks[friction % std::size(kInks)];
}

const Measure* find_measure(const StatsPart& part, std::string_view key) {
    const auto found = std::ranges::find(part.measures, key, &Measure::key);
    return found == part.measures.end() ? nullptr : &*found;
}

PeopleMean as_exp(const PeopleMean& mean) {
    PeopleMean out = mean;
    out.mean = std::exp(mean.mean);
    if (out.interval) {
        out.interval = Interval{std::exp(mean.interval->low), std::exp(mean.interval->high)};
    }
    return out;
}

PairedPanel pairs_of(const Rows& rows,
                     std::string_view column,
                     const std::vector<std::string>& frictions,
                     Scale scale,
                     std::string_view felt) {
    std::map<std::string, std::vector<double>> people;
    std::map<std::string, std::vector<double>> left_out;
    for (std::size_t row = 0; row < rows.cells.size(); ++row) {
        const auto found = std::ranges::find(frictions, rows.text(row, "friction"));
        if (found != frictions.end() && (felt.empty() || rows.text(row, "felt") == felt)) {
            auto& mine =
                (rows.number(row, "left_out") == 0.0 ? people : left_out)[rows.text(row, "person")];
            mine.resize(frictions.size(), std::nan(""));
            mine[static_cast<std::size_t>(found - frictions.begin())] = rows.number(row, column);
        }
    }
    PairedPanel all{.frictions = frictions};
    for (const auto& [person, mine] : people) {
        all.people.push_back(mine);
    }
    for (const auto& [person, mine] : left_out) {
        all.left_out.push_back(mine);
    }
    for (std::size_t f = 0; f < frictions.size(); ++f) {
        std::vector<double> values;
        for (const auto& mine : all.people) {
            if (std::isfinite(mine[f])) {
                values.push_back(scale == Scale::logarithms ? std::log(mine[f]) : mine[f]);
            }
        }
        all.means.push_back(values.empty() ? std::nullopt
                                           : std::optional(mean_over_people(values)));
        if (all.means.back() && scale == Scale::logarithms) {
            all.means.back() = as_exp(*all.means.back());
        }
    }
    return all;
}

Panel paired_panel(const PairedPanel& what) {
    const double width = static_cast<double>(what.frictions.size());
    Panel panel{.title = what.title,
                .x = {.label = "friction", .low = -0.5, .high = width - 0.5},
                .y = {.label = what.label, .unit = what.unit},
                .height = what.height};
    for (std::size_t f = 0; f < what.frictions.size(); ++f) {
        panel.x.names.emplace_back(static_cast<double>(f), what.frictions[f]);
    }
    const auto lines = [&](const std::vector<std::vector<double>>& people, Stroke stroke,
                           const char* name) {
        for (const auto& values : people) {
            Series one{
                .name = name, .ink = Ink::grey, .stroke = stroke, .mark = Mark::both, .width = 1.0};
            for (std::size_t f = 0; f < values.size(); ++f) {
                one.x.push_back(static_cast<double>(f));
                one.y.push_back(values[f]);
            }
            one.sizes.assign(values.size(), 2.5);
            one.opacity = 0.7;
            panel.series.push_back(std::move(one));
        }
    };
    lines(what.left_out, Stroke::dashed, "");
    lines(what.people, Stroke::solid, "");
    for (std::size_t f = 0; f < what.means.size(); ++f) {
        if (const auto& mean = what.means[f]) {
            const double x =
                static_cast<double>(f) + (2 * f + 1 > what.means.size() ? 0.16 : -0.16);
            panel.series.push_back(
                {.x = {x}, .y = {mean->mean}, .ink = ink_of(f), .mark = Mark::points});
            panel.series.back().sizes = {4.5};
            if (mean->interval) {
                panel.series.push_back({.x = {x, x},
                                        .y = {mean->interval->low, mean->interval->high},
                                        .ink = ink_of(f),
                                        .width = 3.0});
            }
        }
    }
    return panel;
}

}  // namespace palpate::data
