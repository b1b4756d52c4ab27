#include "protocols/procedure/likelihood_table.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "protocols/psychometric/exact_math.hpp"

namespace palpate::protocols {
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
