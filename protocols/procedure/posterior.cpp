#include "protocols/procedure/posterior.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "protocols/procedure/estimate.hpp"
#include "protocols/psychometric/exact_math.hpp"

namespace palpate::protocols {
namespace {

constexpr double kSame = 1e-12;

std::vector<double> normalised(std::span<const double> weights, const Axis& axis) {
    if (weights.empty()) {
        return std::vector<double>(axis.values.size(),
                                   1.0 / static_cast<double>(axis.values.size()));
    }
    double sum = 0.0;
    for (const double w : weights) {
        if (!std::isfinite(w) || w < 0.0) {
            throw std::invalid_argument(fmt::format(
                "the prior of {} has the weight {}: give finite numbers from 0 up", axis.name, w));
        }
        sum += w;
    }
    if (weights.size() != axis.values.size() || !(sum > 0.0) || !std::isfinite(sum)) {
        throw std::invalid_argument(fmt::format(
            "the prior of {} has {} weights with the sum {}: give {}, one for each value, "
            "not all of them 0",
            axis.name, weights.size(), sum, axis.values.size()));
    }
    std::vector<double> shares(weights.begin(), weights.end());
    for (double& w : shares) {
        w /= sum;
    }
    return shares;
}

}  // namespace

Posterior::Posterior(const Grid& grid)
    : weights_(grid.size(), 1.0 / static_cast<double>(grid.size())) {}

Posterior::Posterior(const Grid& grid, std::span<const std::vector<double>> axis_weights)
    : weights_(grid.size(), 1.0) {
    if (axis_weights.size() > grid.dimensions()) {
        throw std::invalid_argument(fmt::format("there are priors for {} parameters: give {}",
                                                axis_weights.size(), grid.dimensions()));
    }
    for (std::size_t k = 0; k < grid.dimensions(); ++k) {
        const std::vector<double> shares =
            normalised(k < axis_weights.size() ? std::span<const double>(axis_weights[k])
                                               : std::span<const double>{},
                       grid.axis(k));
        for (std::size_t cell = 0; cell < weights_.size(); ++cell) {
            weights_[cell] *= shares[grid.index(cell, k)];
        }
    }
}

void Posterior::update(std::span<const double> likelihood) {
    double sum = 0.0;
    for (std::size_t cell = 0; cell < weights_.size(); ++cell) {
        sum += weights_[cell] * likelihood[cell];
    }
    if (!(sum > 0.0)) {
        throw std::invalid_argument(
            "the response is impossible under every parameter of the grid: give lapse or guess "
            "rates above 0, or check the response");
    }
    for (std::size_t cell = 0; cell < weights_.size(); ++cell) {
        weights_[cell] = weights_[cell] * likelihood[cell] / sum;
    }
}

double Posterior::entropy() const noexcept {
    return entropy_of(weights_);
}

std::vector<double> Posterior::marginal(const Grid& grid, std::size_t k) const {
    std::vector<double> shares(grid.axis(k).values.size());
    for (std::size_t cell = 0; cell < weights_.size(); ++cell) {
        shares[grid.index(cell, k)] += weights_[cell];
    }
    return shares;
}

std::vector<double> Posterior::mean(const Grid& grid) const {
    std::vector<double> means(grid.dimensions());
    for (std::size_t k = 0; k < means.size(); ++k) {
        const std::vector<double> shares = marginal(grid, k);
        const std::vector<double>& values = grid.axis(k).values;
        // From the first value on, so that a parameter of a single value keeps it to the bit.
        for (std::size_t i = 1; i < values.size(); ++i) {
            means[k] += shares[i] * (values[i] - values[0]);
        }
        means[k] += values[0];
    }
    return means;
}

std::vector<double> Posterior::mode(const Grid& grid) const {
    const double max = *std::max_element(weights_.begin(), weights_.end());
    const auto first = std::find_if(weights_.begin(), weights_.end(),
                                    [max](double w) { return w >= max * (1.0 - kSame); });
    return grid.point(static_cast<std::size_t>(first - weights_.begin()));
}

Estimate belief(std::string name, std::span<const Weighed> values) {
    constexpr double kTail = 0.025;
    Estimate made{.name = std::move(name), .mean = 0.0, .mode = std::nullopt};
    double below = 0.0;
    for (const auto& [value, share] : values) {
        *made.mean += share * value;
        below += share;
        if (!made.low && below >= kTail) {
            made.low = value;
        }
        if (!made.high && below >= 1.0 - kTail) {
            made.high = value;
        }
    }
    double square = 0.0;
    for (const auto& [value, share] : values) {
        square += share * (value - *made.mean) * (value - *made.mean);
    }
    made.sd = std::sqrt(square);
    made.high = made.high.value_or(values.back().first);
    made.cut = made.low == values.front().first || made.high == values.back().first;
    return made;
}

}  // namespace palpate::protocols
