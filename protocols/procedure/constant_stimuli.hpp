#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "engine/base/pcg32.hpp"
#include "protocols/procedure/estimate.hpp"

namespace palpate::protocols {

/// Values that are shown equally often, whatever is answered.
struct ConstantStimuliSpec {
    std::vector<double> values;    ///< finite; a value that stands twice is shown twice as often
    std::size_t repetitions = 10;  ///< of the whole list
    bool in_blocks = false;        ///< true: every run through the list is shuffled by itself
    std::size_t outcomes = 2;

    friend bool operator==(const ConstantStimuliSpec&, const ConstantStimuliSpec&) = default;
};

/// The method of constant stimuli: every value equally often in random order, whatever the
/// responses. All orders (with in_blocks: of each block) are equally likely. What was shown is
/// taken to be what the list says; the function is fitted afterwards.
class ConstantStimuli {
public:
    /// @throws std::invalid_argument for an empty list, values that are not finite, no repetition,
    ///         fewer than two outcomes, or more than kMaxConstantTrials
    ConstantStimuli(const ConstantStimuliSpec& spec, Pcg32 random);

    /// The next value; after the end the last one.
    [[nodiscard]] std::vector<double> next() const;
    /// @throws std::invalid_argument for another outcome than 0 ... outcomes() - 1, or after the
    /// end
    void update(std::span<const double> shown, std::size_t outcome);

    /// As Procedure's; there is nothing to estimate.
    [[nodiscard]] bool finished() const noexcept { return trials_ >= order_.size(); }
    [[nodiscard]] std::size_t trials() const noexcept { return trials_; }
    [[nodiscard]] std::size_t outcomes() const noexcept { return outcomes_; }
    [[nodiscard]] std::vector<std::string> stimulus_names() const { return {"stimulus"}; }
    [[nodiscard]] std::vector<Estimate> estimates() const { return {}; }
    [[nodiscard]] std::string state_hash() const;

    /// All values as they will be shown, drawn once at the start.
    [[nodiscard]] std::span<const double> order() const noexcept { return order_; }

private:
    std::vector<double> order_;
    std::size_t outcomes_;
    std::vector<double> history_;  ///< shown, outcome, shown, outcome, ...
    std::size_t trials_ = 0;
};

inline constexpr std::size_t kMaxConstantTrials = 100'000;

}  // namespace palpate::protocols
