#include "protocols/procedure/quest_plus.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "protocols/procedure/expected_entropy.hpp"
#include "protocols/procedure/state_bytes.hpp"
#include "protocols/psychometric/psychometric_function.hpp"

namespace palpate::protocols {

QuestPlus::QuestPlus(const QuestPlusSpec& spec)
    : table_(std::make_shared<const LikelihoodTable>(spec.model, spec.stimuli, spec.parameters)),
      shape_(spec.model.shape),
      posterior_(spec.parameters, spec.prior),
      max_trials_(spec.trials),
      entropy_bits_(spec.entropy_bits) {
    if (!spec.nuisance.empty()) {
        groups_ = std::make_shared<const CellGroups>(groups_of(spec.parameters, spec.nuisance));
    }
    if (spec.trials == 0) {
        throw std::invalid_argument("there are 0 trials: give at least 1");
    }
}

std::vector<double> QuestPlus::expected() const {
    return groups_ == nullptr
             ? expected_entropies(*table_, posterior_.weights())
             : expected_marginal_entropies(*table_, posterior_.weights(), *groups_);
}

std::vector<double> QuestPlus::next() const {
    return table_->stimuli().point(first_of_least(expected()));
}

void QuestPlus::update(std::span<const double> shown, std::size_t outcome) {
    if (outcome >= outcomes()) {
        throw std::invalid_argument(
            fmt::format("the response is {}: give 0 to {}", outcome, outcomes() - 1));
    }
    posterior_.update(table_->chances(table_->stimuli().cell_at(shown), outcome));
    ++trials_;
}

bool QuestPlus::finished() const noexcept {
    return trials_ >= max_trials_ || (entropy_bits_ > 0.0 && entropy() < entropy_bits_);
}

std::vector<std::string> QuestPlus::stimulus_names() const {
    std::vector<std::string> names;
    for (const Axis& axis : table_->stimuli().axes()) {
        names.push_back(axis.name);
    }
    return names;
}

std::vector<Estimate> QuestPlus::estimates() const {
    const Grid& grid = table_->parameters();
    const std::vector<double> means = posterior_.mean(grid);
    const std::vector<double> modes = posterior_.mode(grid);
    std::vector<Estimate> free;
    for (std::size_t k = 0; k < grid.dimensions(); ++k) {
        if (grid.axis(k).values.size() > 1 || grid.size() == 1) {
            const std::vector<double> shares = posterior_.marginal(grid, k);
            std::vector<Weighed> values;
            for (std::size_t i = 0; i < shares.size(); ++i) {
                values.emplace_back(grid.axis(k).values[i], shares[i]);
            }
            free.push_back(belief(grid.axis(k).name, values));
            free.back().mean = means[k];
            free.back().mode = modes[k];
        }
    }
    return free;
}

std::optional<Estimate> QuestPlus::jnd() const {
    const Grid& grid = table_->parameters();
    if (!shape_ || grid.axis(0).values.size() * grid.axis(1).values.size() == 1) {
        return std::nullopt;
    }
    const std::vector<double>& slopes = grid.axis(1).values;
    std::vector<Weighed> values(grid.axis(0).values.size() * slopes.size());
    for (std::size_t cell = 0; cell < values.size(); ++cell) {
        const double threshold = grid.axis(0).values[cell / slopes.size()];
        const double slope = slope_of(shape_->slope_as, slopes[cell % slopes.size()]);
        values[cell].first = 0.5 * (core_inverse(shape_->family, 0.75, threshold, slope) -
                                    core_inverse(shape_->family, 0.25, threshold, slope));
    }
    for (std::size_t cell = 0; cell < grid.size(); ++cell) {
        values[grid.index(cell, 0) * slopes.size() + grid.index(cell, 1)].second +=
            posterior_.weights()[cell];
    }
    std::ranges::sort(values);
    return belief("JND", values);
}

std::string QuestPlus::state_hash() const {
    StateBytes bytes("palpate-quest-plus-v1");
    bytes.add(std::uint64_t{trials_});
    bytes.add(posterior_.weights());
    return bytes.hash();
}

QuestPlusSpec quest_plus_spec(const PsiSpec& psi) {
    std::vector<Axis> parameters{{"threshold", psi.thresholds}, {"log10_slope", psi.log10_slopes}};
    if (psi.form != LapseForm::two_sided) {
        parameters.push_back({"guess", psi.guesses});
    }
    parameters.push_back({"lapse", psi.lapses});
    return {.model = psychometric_model(psi.family, psi.form, SlopeAs::log10_slope),
            .stimuli = Grid({{"stimulus", psi.stimuli}}),
            .parameters = Grid(std::move(parameters)),
            .prior = psi.prior,
            .nuisance = psi.nuisance,
            .trials = psi.trials};
}

}  // namespace palpate::protocols
