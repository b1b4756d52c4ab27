#include "protocols/procedure/grid.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

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

}  // namespace palpate::protocols
