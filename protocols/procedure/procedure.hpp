#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/base/pcg32.hpp"
#include "protocols/procedure/procedure_state.hpp"
#include "protocols/procedure/quest.hpp"
#include "protocols/procedure/quest_plus.hpp"
#include "protocols/procedure/staircase.hpp"
#include "protocols/protocol/protocol.hpp"

namespace palpate::protocols {

/// Values that are shown equally often, whatever is answered.
struct ConstantStimuliSpec {
    std::vector<double> values;    ///< finite; a value that stands twice is shown twice as often
    std::size_t repetitions = 10;  ///< of the whole list
    bool in_blocks = false;        ///< true: every run through the list is shuffled by itself
    std::size_t outcomes = 2;
};

/// The method of constant stimuli: every value equally often in random order, whatever the
/// responses. All orders (with in_blocks: of each block) are equally likely. What was shown is done
/// where it stands first in what is left of the list, so that a value whose answer does not count
/// comes again; the function is fitted afterwards.
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
    std::vector<double> left_;  ///< of the order, the next one last
    std::size_t outcomes_;
    std::vector<double> history_;  ///< shown, outcome, shown, outcome, ...
    std::size_t trials_ = 0;
};

inline constexpr std::size_t kMaxConstantTrials = 100'000;

/// What may choose stimuli, before it starts.
struct ProcedureSpec
    : std::variant<ConstantStimuliSpec, std::vector<StaircaseSpec>, QuestSpec, QuestPlusSpec> {
    using variant::variant;
};

/// What chooses the stimuli of a run of trials. A value: copying one copies its state.
///
///     while (!procedure.finished()) {
///         const std::vector<double> x = procedure.next();
///         procedure.update(x, answer_to(x));
///     }
///
/// The state follows from the spec, the stream, and what was shown and answered, to the bit on
/// every IEEE-754 machine. So a run that broke off is rebuilt by calling update() for each recorded
/// trial, and state_hash() tells whether the rebuilt state is the one that was recorded.
class Procedure {
public:
    /// @param random  draws the orders and the interleaving; QUEST and QUEST+ draw nothing
    /// @throws std::invalid_argument with the value and the remedy
    Procedure(const ProcedureSpec& spec, Pcg32 random);
    Procedure(const Procedure& other);
    Procedure(Procedure&& other) noexcept;
    Procedure& operator=(const Procedure& other);
    Procedure& operator=(Procedure&& other) noexcept;
    ~Procedure();

    /// The stimulus to show next, one number a dimension.
    [[nodiscard]] std::vector<double> next() const;
    /// @param shown    what was shown, recommended or not
    /// @param outcome  0 ... outcomes() - 1; of two, 1 is correct or yes
    /// @param track    what track() said when it was shown, where answers before it may have been
    ///                 left out since; empty: what it says now
    /// @throws std::invalid_argument with the value and the remedy; the state is then as it was
    void update(std::span<const double> shown, std::size_t outcome, std::string_view track = {});

    /// The rule asks for no more trials; next() goes on naming a stimulus.
    [[nodiscard]] bool finished() const;
    [[nodiscard]] std::size_t trials() const;  ///< updates so far
    /// How many outcomes update() tells apart.
    [[nodiscard]] std::size_t outcomes() const;
    /// Names of the dimensions; the first is "stimulus".
    [[nodiscard]] std::vector<std::string> stimulus_names() const;
    /// Which of several interleaved staircases the next trial belongs to; else empty.
    [[nodiscard]] std::string_view track() const;
    /// None for constant stimuli.
    [[nodiscard]] std::vector<Estimate> estimates() const;
    /// QuestPlus::jnd(); none of other rules: they assume a slope, or none.
    [[nodiscard]] std::optional<Estimate> jnd() const;
    /// Of the posterior, bits; none for constant stimuli and staircases.
    [[nodiscard]] std::optional<double> entropy() const;
    /// SHA-256 of all that the next choice and the estimates depend on beside the spec: 64
    /// hexadecimal digits.
    [[nodiscard]] std::string state_hash() const;

private:
    using State = std::variant<ConstantStimuli, Staircases, Quest, QuestPlus>;

    static State start(const ProcedureSpec& spec, Pcg32 random);

    State state_;
};

/// What is known of a rule before it starts.
/// @throws std::invalid_argument with the remedy if its number of trials depends on the answers, or
///         if it chooses more than one number
[[nodiscard]] RuleFacts facts_of(const ProcedureSpec& spec);

}  // namespace palpate::protocols
