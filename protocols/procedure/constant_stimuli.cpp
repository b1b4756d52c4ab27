#include "protocols/procedure/constant_stimuli.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "protocols/procedure/state_bytes.hpp"

namespace palpate::protocols {

ConstantStimuli::ConstantStimuli(const ConstantStimuliSpec& spec, Pcg32 random)
    : outcomes_(spec.outcomes) {
    for (const double value : spec.values) {
        if (!std::isfinite(value)) {
            throw std::invalid_argument(
                fmt::format("stimuli holds {}: give finite numbers", value));
        }
    }
    if (spec.values.empty() || spec.repetitions == 0 || spec.outcomes < 2) {
        throw std::invalid_argument(fmt::format(
            "there are {} stimuli, {} repetitions and {} outcomes: give at least 1, 1 and 2",
            spec.values.size(), spec.repetitions, spec.outcomes));
    }
    if (spec.repetitions > kMaxConstantTrials / spec.values.size()) {
        throw std::invalid_argument(fmt::format(
            "repetitions is {}, of {} stimuli, which is more than {} trials: give fewer",
            spec.repetitions, spec.values.size(), kMaxConstantTrials));
    }
    for (std::size_t i = 0; i < spec.repetitions; ++i) {
        order_.insert(order_.end(), spec.values.begin(), spec.values.end());
    }
    const std::size_t block = spec.in_blocks ? spec.values.size() : order_.size();
    for (std::size_t i = 0; i < order_.size(); i += block) {
        shuffle(std::span(order_).subspan(i, block), random);
    }
}

std::vector<double> ConstantStimuli::next() const {
    return {finished() ? order_.back() : order_[trials_]};
}

void ConstantStimuli::update(std::span<const double> shown, std::size_t outcome) {
    if (shown.size() != 1 || !std::isfinite(shown[0])) {
        throw std::invalid_argument("a constant stimulus is one finite number: give that");
    }
    if (outcome >= outcomes_) {
        throw std::invalid_argument(
            fmt::format("the response is {}: give 0 to {}", outcome, outcomes_ - 1));
    }
    if (finished()) {
        throw std::invalid_argument("every stimulus was shown: give no more responses");
    }
    history_.push_back(shown[0]);
    history_.push_back(static_cast<double>(outcome));
    ++trials_;
}

std::string ConstantStimuli::state_hash() const {
    StateBytes bytes("palpate-constant-v1");
    bytes.add(std::span<const double>(order_));
    bytes.add(std::span<const double>(history_));
    return bytes.hash();
}

}  // namespace palpate::protocols
