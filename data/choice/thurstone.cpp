#include "data/choice/thurstone.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/refuse.hpp"
#include "data/statistics/solve.hpp"

namespace palpate::data {
namespace {

using namespace thurstone;

/// A shift beyond this many times the items' range is without end.
constexpr double kFarShift = 20.0;
/// The items' range in least distances, at most.
constexpr double kWidest = 1e100;
/// Half the 95 % point of chi-square of 1 df.
constexpr double kLoss95 = 1.920729410347062;

/// Two optimisers that end closer than this agree.
constexpr double kSame = 1e-6;

void check(const std::vector<CallCounts>& counts, const ThurstoneSpec& spec) {
    refuse_if(!(spec.lapse >= 0.0 && spec.lapse <= 0.25),
              "the lapse rate is {}: give a share from 0 to 0.25", spec.lapse);
    for (std::size_t i = 0; i + 1 < spec.items.size(); ++i) {
        refuse_if(!(spec.items[i] < spec.items[i + 1]),
                  "items have the values {} and {}: give each its own, in order", spec.items[i],
                  spec.items[i + 1]);
    }
    refuse_if(spec.items.size() < 2 || counts.empty(),
              "there are fewer than two items to tell apart");
    const double least = least_distance(spec.items);
    refuse_if(!((spec.items.back() - spec.items.front()) / least <= kWidest),
              "items have values from {} to {}, two of them {} apart: give values that differ less",
              spec.items.front(), spec.items.back(), least);
}

/// What holding one parameter elsewhere costs, walked from the maximum outward.
struct Profile {
    const Model& model;
    const ThurstoneSpec& spec;
    const Maximum& top;
    const std::vector<Parameters>& starts;
    std::size_t parameter;
    Maximum& seen;  ///< the highest
    Parameters near{};
    std::vector<Parameters> ends{};

    struct Edge {
        std::optional<double> at{};  ///< where the loss is that of 95 %; nothing: it never is
        double loss = 0.0;           ///< where the walk ended
    };

    /// On both sides; and where it is asked for the loss at 0. An interval that lacks 0, which is
    /// likely all the same on a hill that no walk found, reaches beyond it.
    struct Edges {
        Edge low{};
        Edge high{};
        double loss_at_none = 0.0;
    };
    Edges edges(double step, const Interval& limits, bool asks_none = true) {
        Edges found{.low = edge(top.at, 0.0, -step, limits.low),
                    .high = edge(top.at, 0.0, step, limits.high)};
        if (asks_none) {
            const double loss = found.loss_at_none = loss_at_none();
            const Parameters none = ends.emplace_back(near);
            if (loss < kLoss95 && found.low.at.value_or(0.0) > 0.0) {
                found.low = edge(none, loss, -step, limits.low);
            } else if (loss < kLoss95 && found.high.at.value_or(0.0) < 0.0) {
                found.high = edge(none, loss, step, limits.high);
            }
        }
        return found;
    }

    /// From a place to `end`, or to where the loss is too large.
    Edge edge(const Parameters& from, double loss_there, double step, double end) {
        near = from;
        const double start = from[parameter];
        double left = start;
        double loss_left = loss_there;
        const double sign = step < 0.0 ? -1.0 : 1.0;
        if (sign * (end - start) <= 0.0) {
            return {};
        }
        int hills = 0;
        for (double way = std::fabs(step);; way *= 1.7) {
            const double right = sign * std::min(sign * (start + sign * way), sign * end);
            const double loss = loss_at(right);
            if (loss >= kLoss95) {
                const double at = crossing([&](double place) { return std::sqrt(loss_at(place)); },
                                           std::sqrt(kLoss95), {left, std::sqrt(loss_left)},
                                           {right, std::sqrt(loss)}, 1e-6);
                const double lower = loss_over_hills();
                ends.push_back(near);
                if (lower >= kLoss95 - kNoLoss || ++hills > 2) {
                    return {at, loss};
                }
                left = at;  // on from the hill that is higher there
                loss_left = lower;
                continue;
            }
            if (right == end) {
                ends.push_back(near);
                return {std::nullopt, loss};
            }
            left = right;
            loss_left = loss;
        }
    }

    /// The loss where the parameter is 0, from all starts and where walks ended.
    double loss_at_none() {
        const Maximum best = from_everywhere(0.0, {});
        near = best.at;
        return std::min(loss_of(best), loss_over_hills());
    }

    double loss_at(double place) {
        near[parameter] = place;
        Maximum found = climb(model, near, parameter);
        if (top.value - found.value >= kLoss95) {
            found = from_everywhere(place, std::move(found));
        }
        near = found.at;
        return loss_of(found);
    }

    /// A climb may end on a lower hill: the highest of all. Where a sigma is next to nothing,
    /// criteria have to go along with a shift.
    Maximum from_everywhere(double place, Maximum best) const {
        const auto try_from = [&](Parameters start) {
            start[parameter] = place;
            take_higher(best, climb(model, std::move(start), parameter));
        };
        std::ranges::for_each(starts, try_from);
        for (Parameters end : ends) {
            try_from(end);
            const double by = place - end[parameter];
            for (std::size_t i = 0; i < model.layout().criteria(); ++i) {
                end[i] += by;
            }
            try_from(std::move(end));
        }
        return best;
    }

    /// Where the walk is.
    double loss_over_hills() {
        const Maximum found = over_hills(model, spec, {near, model.value(near)}, parameter);
        near = found.at;
        return loss_of(found);
    }

    double loss_of(const Maximum& found) {
        take_higher(seen, found);
        return std::max(top.value - found.value, 0.0);
    }
};

/// Gives back the highest that was seen: above `top` where that was a lower hill.
Maximum add_intervals(ThurstoneFit& fit,
                      const Model& model,
                      const Maximum& top,
                      const ThurstoneSpec& spec) {
    Maximum seen = top;
    const Layout& layout = model.layout();
    const double range = spec.items.back() - spec.items.front();
    std::vector<Parameters> starts = starts_of(layout, spec);
    starts.push_back(top.at);
    for (std::size_t f = 0; f < layout.conditions; ++f) {
        ThurstonePart& part = fit.parts[f];
        const bool relative = spec.relative && f > 0;
        const Interval limits = sigma_limits(spec, relative);
        Profile sigma{model, spec, top, starts, layout.sigma(f), seen};
        const auto [low, high, ratio_loss] = sigma.edges(0.4, limits, relative);
        const double at = top.at[layout.sigma(f)];
        const bool sharp = !low.at && (low.loss < kNoLoss || at < limits.low);
        const bool blunt = !high.at && (high.loss < kNoLoss || at > limits.high);
        part.end = !answered(model.counts(f)) || (sharp && blunt) ? SigmaEnd::unknown
                 : sharp                                          ? SigmaEnd::sharp
                 : blunt                                          ? SigmaEnd::blunt
                                                                  : SigmaEnd::both;
        part.sigma_interval =
            Interval{low.at ? std::exp(*low.at) : 0.0, high.at ? std::exp(*high.at) : kInfinite};
        part.ratio_loss = ratio_loss;
        if (layout.shifts(f)) {
            Profile shift{model, spec, top, starts, layout.shift(f), seen};
            const Interval far{-kFarShift * range, kFarShift * range};
            const auto [down, up, loss] = shift.edges(0.1 * range, far);
            part.shift_loss = loss;
            part.shift_interval = Interval{down.at.value_or(-kInfinite), up.at.value_or(kInfinite)};
        }
    }
    return seen;
}

/// Of shares that are free, and how many of them are.
void add_deviance(ThurstoneFit& fit, const std::vector<CallCounts>& counts, const Layout& layout) {
    double saturated = 0.0;
    for (const CallCounts& one : counts) {
        for (const auto& row : one) {
            double total = 0.0;
            for (const std::int64_t n : row) {
                total += static_cast<double>(n);
            }
            for (const std::int64_t n : row) {
                const auto k = static_cast<double>(n);
                saturated += n > 0 ? k * std::log(k / total) : 0.0;
            }
            fit.df += total > 0.0 ? static_cast<std::int64_t>(row.size()) - 1 : 0;
        }
    }
    fit.df -= static_cast<std::int64_t>(layout.size());
    fit.deviance = 2.0 * (saturated - fit.log_likelihood);
}

/// Of ratios also from the maximum of the sigmas themselves, to which other ways lead.
Maximum highest_of(const Model& model,
                   const std::vector<CallCounts>& counts,
                   const ThurstoneSpec& spec) {
    Maximum top = highest(model, spec);
    if (spec.relative) {
        ThurstoneSpec plain = spec;
        plain.relative = false;
        Maximum other = highest(Model(counts, plain), plain);
        if (other.value > top.value + kNoLoss) {
            for (std::size_t f = 1; f < counts.size(); ++f) {
                other.at[model.layout().sigma(f)] -= other.at[model.layout().sigma(0)];
            }
            top = climb(model, std::move(other.at));
        }
    }
    return top;
}

/// The second optimiser from the first start; where that ends lower, from where the climb began.
void check_by_simplex(ThurstoneFit& fit,
                      const Model& model,
                      const ThurstoneSpec& spec,
                      Maximum& top) {
    const Layout& layout = model.layout();
    const double spacing = least_distance(spec.items);
    std::vector<double> edge(layout.size(), 0.3 * spacing);
    for (std::size_t f = 0; f < layout.conditions; ++f) {
        edge[layout.sigma(f)] = 0.3;
    }
    const auto place_of = [&](std::span<const double> at) {
        Parameters place(at.begin(), at.end());
        model.keep_within(place);
        return place;
    };
    const auto from = [&](const Parameters& start) {
        const SimplexMaximum found = simplex_maximum(
            [&](std::span<const double> at) { return model.value(place_of(at)); }, start, edge);
        return Maximum{place_of(found.at), found.value};
    };
    Maximum second = from(start_at(layout, spec, spacing));
    if (second.value < top.value - kSame) {
        take_higher(second, from(top.from));
    }
    fit.second = second.value;
    fit.agree = std::fabs(fit.second - top.value) < kSame;
    if (second.value > top.value) {
        Maximum again = climb(model, second.at);
        top = std::move(again.value > second.value ? again : second);
    }
}

/// @param spec  items whose least distance is about 1
ThurstoneFit fit_spaced(const std::vector<CallCounts>& counts, const ThurstoneSpec& spec) {
    const Model model(counts, spec);
    const Layout& layout = model.layout();
    refuse_if(layout.used.size() < 2,
              "every answer is the same response: nothing is distinguished");
    ThurstoneFit fit{.second = std::nan("")};
    fit.parts.resize(layout.conditions);
    Maximum top = highest_of(model, counts, spec);
    while (true) {
        fit.first = top.value;
        if (spec.checked) {
            check_by_simplex(fit, model, spec, top);
        }
        Maximum seen = spec.intervals ? add_intervals(fit, model, top, spec) : top;
        if (seen.value <= top.value + kNoLoss) {
            break;
        }
        top = climb(model, std::move(seen.at));
    }
    fit.log_likelihood = top.value;
    std::size_t given = 0;  // of the responses up to j
    for (std::size_t j = 0; j + 1 < counts.front().front().size(); ++j) {
        if (given < layout.used.size() && layout.used[given] == j) {
            ++given;
        }
        fit.criteria.push_back(given == 0                    ? -kInfinite
                               : given == layout.used.size() ? kInfinite
                                                             : top.at[given - 1]);
    }
    for (std::size_t f = 0; f < layout.conditions; ++f) {
        fit.parts[f].sigma = model.sigma(top.at, f);
        fit.parts[f].shift = layout.shifts(f) ? top.at[layout.shift(f)] : 0.0;
    }
    add_deviance(fit, counts, layout);
    return fit;
}

void scale_interval(std::optional<Interval>& interval, double unit) {
    if (interval) {
        interval = Interval{interval->low * unit, interval->high * unit};
    }
}

}  // namespace

ThurstoneFit fit_thurstone(const std::vector<CallCounts>& counts, const ThurstoneSpec& spec) {
    check(counts, spec);
    ThurstoneSpec spaced = spec;  // a climb between hills takes another way in another unit
    const double unit = least_distance(spec.items);
    for (double& item : spaced.items) {
        item /= unit;
    }
    ThurstoneFit fit = fit_spaced(counts, spaced);
    for (double& criterion : fit.criteria) {
        criterion *= unit;
    }
    for (std::size_t f = 0; f < fit.parts.size(); ++f) {
        fit.parts[f].sigma *= unit;
        fit.parts[f].shift *= unit;
        scale_interval(fit.parts[f].shift_interval, unit);
        if (f == 0 || !spec.relative) {
            scale_interval(fit.parts[f].sigma_interval, unit);
        }
    }
    return fit;
}

}  // namespace palpate::data
