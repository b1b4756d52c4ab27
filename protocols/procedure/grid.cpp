#include "protocols/procedure/grid.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "protocols/psychometric/exact_math.hpp"

namespace palpate::protocols {
namespace {

void check(const Axis& axis) {
    if (axis.values.empty()) {
        throw std::invalid_argument(fmt::format("{} has no values: give at least one", axis.name));
    }
    for (std::size_t i = 0; i < axis.values.size(); ++i) {
        const double value = axis.values[i];
        if (!std::isfinite(value) || (i > 0 && value <= axis.values[i - 1])) {
            throw std::invalid_argument(
                fmt::format("{} has the value {} at place {}: give finite numbers, each above the "
                            "one before it",
                            axis.name, value, i + 1));
        }
    }
}

}  // namespace

Grid::Grid(std::vector<Axis> axes) : axes_(std::move(axes)), strides_(axes_.size()), size_(1) {
    if (axes_.empty()) {
        throw std::invalid_argument("the grid has no axis: give at least one");
    }
    for (std::size_t k = axes_.size(); k-- > 0;) {
        check(axes_[k]);
        const auto same = std::count_if(axes_.begin(), axes_.end(), [this, k](const Axis& other) {
            return other.name == axes_[k].name;
        });
        if (same > 1) {
            throw std::invalid_argument(
                fmt::format("two axes are called {}: give each its own name", axes_[k].name));
        }
        strides_[k] = size_;
        if (axes_[k].values.size() > kMaxCells / size_) {
            throw std::invalid_argument(
                fmt::format("the grid has more than {} cells: give fewer values, above all to {}",
                            kMaxCells, axes_[k].name));
        }
        size_ *= axes_[k].values.size();
    }
}

std::vector<double> Grid::point(std::size_t cell) const {
    std::vector<double> point(axes_.size());
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        point[k] = axes_[k].values[index(cell, k)];
    }
    return point;
}

std::size_t Grid::cell_at(std::span<const double> point) const {
    if (point.size() != axes_.size()) {
        throw std::invalid_argument(
            fmt::format("the stimulus has {} coordinates: give {}", point.size(), axes_.size()));
    }
    std::size_t cell = 0;
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        const std::vector<double>& values = axes_[k].values;
        const double slack = 1e-9 * std::max({values.back() - values.front(),
                                              std::fabs(values.front()), std::fabs(values.back())});
        const auto near = std::lower_bound(values.begin(), values.end(), point[k] - slack);
        if (near == values.end() || !(std::fabs(*near - point[k]) <= slack)) {
            throw std::invalid_argument(
                fmt::format("{} is {}, which is none of its {} values from {} to {}: give one of "
                            "them, or add it to the configuration",
                            axes_[k].name, point[k], values.size(), values.front(), values.back()));
        }
        cell += strides_[k] * static_cast<std::size_t>(near - values.begin());
    }
    return cell;
}

std::vector<double> evenly(double from, double to, std::size_t count) {
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double part =
            static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(count - 1, 1));
        values[i] = from + (to - from) * part;
    }
    if (count > 1) {
        values.back() = to;
    }
    return values;
}

namespace {

/// How far the chances of all outcomes may add up beside 1.
constexpr double kSumSlack = 1e-9;

void check_names(std::string_view what, const Grid& grid, std::span<const std::string> names) {
    bool same = grid.dimensions() == names.size();
    for (std::size_t k = 0; same && k < names.size(); ++k) {
        same = grid.axis(k).name == names[k];
    }
    if (!same) {
        throw std::invalid_argument(fmt::format("the {} have other axes than the model: give {}",
                                                what, fmt::join(names, ", ")));
    }
}

}  // namespace

LikelihoodTable::LikelihoodTable(const OutcomeModel& model, Grid stimuli, Grid parameters)
    : stimuli_(std::move(stimuli)), parameters_(std::move(parameters)), outcomes_(model.outcomes) {
    check_names("stimuli", stimuli_, model.stimulus);
    check_names("parameters", parameters_, model.parameters);
    const std::size_t max = kMaxBytes / sizeof(double) / (outcomes_ + 1);
    if (stimuli_.size() > max / parameters_.size()) {
        throw std::invalid_argument(fmt::format(
            "{} stimuli, {} parameter cells and {} outcomes need {:.0f} MB of tables, more than {} "
            "MB: give fewer values to the longest axis",
            stimuli_.size(), parameters_.size(), outcomes_,
            1e-6 * static_cast<double>(sizeof(double) * (outcomes_ + 1)) *
                static_cast<double>(stimuli_.size()) * static_cast<double>(parameters_.size()),
            kMaxBytes / 1'000'000));
    }
    values_.resize(stimuli_.size() * parameters_.size() * (outcomes_ + 1));
    fill(model);
}

namespace {

[[noreturn]] void no_chances(const std::vector<double>& stimulus,
                             const std::vector<double>& parameters) {
    throw std::invalid_argument(
        fmt::format("the model gives no chances that add up to 1 at stimulus {} and parameters {}: "
                    "give parameters in their ranges",
                    fmt::join(stimulus, ", "), fmt::join(parameters, ", ")));
}

}  // namespace

void LikelihoodTable::fill(const OutcomeModel& model) {
    std::vector<std::vector<double>> points(stimuli_.size());
    for (std::size_t x = 0; x < points.size(); ++x) {
        points[x] = stimuli_.point(x);
    }
    const std::size_t cells = parameters_.size();
    std::vector<double> chances(outcomes_);
    for (std::size_t cell = 0; cell < cells; ++cell) {
        const std::vector<double> s = parameters_.point(cell);
        for (std::size_t x = 0; x < points.size(); ++x) {
            model.chances(points[x], s, chances);
            double* column = &values_[x * (outcomes_ + 1) * cells + cell];
            double sum = 0.0;
            double entropy = 0.0;
            for (std::size_t r = 0; r < outcomes_; ++r) {
                column[r * cells] = chances[r];
                sum += chances[r];
                entropy -= p_log_p(chances[r]);
                if (!(chances[r] >= 0.0)) {
                    sum = -1.0;
                    break;
                }
            }
            if (!(std::fabs(sum - 1.0) <= kSumSlack)) {
                no_chances(points[x], s);
            }
            column[outcomes_ * cells] = entropy;
        }
    }
}

}  // namespace palpate::protocols
