#include "protocols/procedure/quest_plus.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "protocols/procedure/state_bytes.hpp"

namespace palpate::protocols {
QuestPlus::QuestPlus(const QuestPlusSpec& spec)
    : table_(std::make_shared<const LikelihoodTable>(spec.model, spec.stimuli, spec.parameters)),
      posterior_(spec.parameters, spec.prior),
      most_trials_(spec.trials),
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
    return trials_ >= most_trials_ || (entropy_bits_ > 0.0 && entropy() < entropy_bits_);
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
            free.push_back({grid.axis(k).name, means[k], modes[k]});
        }
    }
    return free;
}

std::string QuestPlus::state_hash() const {
    StateBytes bytes("palpate-quest-plus-v1");
    bytes.add(std::uint64_t{trials_});
    bytes.add(posterior_.weights());
    return bytes.hash();
}

}  // namespace palpate::protocols
