#include "protocols/procedure/procedure.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"

namespace palpate::protocols {

ConstantStimuli::ConstantStimuli(const ConstantStimuliSpec& spec, Pcg32 random)
    : outcomes_(spec.outcomes) {
    for (const double value : spec.values) {
        refuse_if(!std::isfinite(value), "stimuli holds {}: give finite numbers", value);
    }
    refuse_if(spec.values.empty() || spec.repetitions == 0 || spec.outcomes < 2,
              "there are {} stimuli, {} repetitions and {} outcomes: give at least 1, 1 and 2",
              spec.values.size(), spec.repetitions, spec.outcomes);
    refuse_if(spec.repetitions > kMaxConstantTrials / spec.values.size(),
              "repetitions is {}, of {} stimuli, which is more than {} trials: give fewer",
              spec.repetitions, spec.values.size(), kMaxConstantTrials);
    for (std::size_t i = 0; i < spec.repetitions; ++i) {
        order_.insert(order_.end(), spec.values.begin(), spec.values.end());
    }
    const std::size_t block = spec.in_blocks ? spec.values.size() : order_.size();
    for (std::size_t i = 0; i < order_.size(); i += block) {
        shuffle(std::span(order_).subspan(i, block), random);
    }
    left_.assign(order_.rbegin(), order_.rend());
}

std::vector<double> ConstantStimuli::next() const {
    return {finished() ? order_.back() : left_.back()};
}

void ConstantStimuli::update(std::span<const double> shown, std::size_t outcome) {
    refuse_if(shown.size() != 1 || !std::isfinite(shown[0]),
              "a constant stimulus is one finite number: give that");
    refuse_if(outcome >= outcomes_, "the response is {}: give 0 to {}", outcome, outcomes_ - 1);
    refuse_if(finished(), "every stimulus was shown: give no more responses");
    history_.push_back(shown[0]);
    history_.push_back(static_cast<double>(outcome));
    const auto done = std::find(left_.rbegin(), left_.rend(), shown[0]);
    left_.erase(std::prev((done == left_.rend() ? left_.rbegin() : done).base()));
    ++trials_;
}

std::string ConstantStimuli::state_hash() const {
    StateBytes bytes("palpate-constant-v1");
    bytes.add(std::span<const double>(order_));
    bytes.add(std::span<const double>(history_));
    return bytes.hash();
}

Procedure::State Procedure::start(const ProcedureSpec& spec, Pcg32 random) {
    struct Start {
        Pcg32 random;
        State operator()(const ConstantStimuliSpec& s) const { return ConstantStimuli(s, random); }
        State operator()(const std::vector<StaircaseSpec>& s) const {
            return Staircases(s, random);
        }
        State operator()(const QuestSpec& s) const { return Quest(s); }
        State operator()(const QuestPlusSpec& s) const { return QuestPlus(s); }
    };
    return std::visit(Start{random}, spec);
}

Procedure::Procedure(const ProcedureSpec& spec, Pcg32 random) : state_(start(spec, random)) {}

// Here, since a variant's copies cost every file that includes it a tenth of a second.
Procedure::Procedure(const Procedure& other) = default;
Procedure::Procedure(Procedure&& other) noexcept = default;
Procedure& Procedure::operator=(const Procedure& other) = default;
Procedure& Procedure::operator=(Procedure&& other) noexcept = default;
Procedure::~Procedure() = default;

std::vector<double> Procedure::next() const {
    return std::visit([](const auto& s) { return s.next(); }, state_);
}

void Procedure::update(std::span<const double> shown, std::size_t outcome, std::string_view track) {
    if (auto* const staircases = std::get_if<Staircases>(&state_)) {
        staircases->update(shown, outcome, track);
    } else {
        std::visit([&](auto& s) { s.update(shown, outcome); }, state_);
    }
}

bool Procedure::finished() const {
    return std::visit([](const auto& s) { return s.finished(); }, state_);
}

std::size_t Procedure::trials() const {
    return std::visit([](const auto& s) { return s.trials(); }, state_);
}

std::size_t Procedure::outcomes() const {
    return std::visit([](const auto& s) { return s.outcomes(); }, state_);
}

std::vector<std::string> Procedure::stimulus_names() const {
    return std::visit([](const auto& s) { return s.stimulus_names(); }, state_);
}

std::string_view Procedure::track() const {
    const auto* staircases = std::get_if<Staircases>(&state_);
    return staircases != nullptr && staircases->tracks().size() > 1
             ? std::string_view(staircases->tracks()[staircases->track()].spec().name)
             : std::string_view{};
}

std::vector<Estimate> Procedure::estimates() const {
    return std::visit([](const auto& s) { return s.estimates(); }, state_);
}

std::optional<Estimate> Procedure::jnd() const {
    const auto* quest_plus = std::get_if<QuestPlus>(&state_);
    return quest_plus != nullptr ? quest_plus->jnd() : std::nullopt;
}

std::optional<double> Procedure::entropy() const {
    if (const auto* quest = std::get_if<Quest>(&state_)) {
        return quest->entropy();
    }
    if (const auto* quest_plus = std::get_if<QuestPlus>(&state_)) {
        return quest_plus->entropy();
    }
    return std::nullopt;
}

std::string Procedure::state_hash() const {
    return std::visit([](const auto& s) { return s.state_hash(); }, state_);
}

namespace {

RuleFacts facts(const ConstantStimuliSpec& spec) {
    const auto [least, max] = std::ranges::minmax_element(spec.values);
    return {.trials = spec.values.size() * spec.repetitions,
            .lowest = *least,
            .highest = *max,
            .outcomes = spec.outcomes,
            .lowest_key = "constant.stimuli",
            .highest_key = "constant.stimuli"};
}

RuleFacts facts(const std::vector<StaircaseSpec>& specs) {
    constexpr double kChance = 0.5 + 1e-6;  // of a guess between two
    RuleFacts all;
    for (std::size_t i = 0; i < specs.size(); ++i) {
        const StaircaseSpec& spec = specs[i];
        refuse_if(spec.trials == 0 || spec.reversals != 0,
                  "staircase {} ends {}: a session's plan is complete before its first trial; "
                  "give trials and no reversals",
                  spec.name, spec.reversals != 0 ? "by reversals" : "never");
        all.trials += spec.trials;
        if (i == 0 || spec.lowest < all.lowest) {
            all.lowest = spec.lowest;
            all.lowest_key = fmt::format("staircase.{}.lowest", i + 1);
        }
        if (i == 0 || spec.highest > all.highest) {
            all.highest = spec.highest;
            all.highest_key = fmt::format("staircase.{}.highest", i + 1);
        }
        all.one_sided = all.one_sided || spec.down > spec.up || target(spec) > kChance;
    }
    return all;
}

RuleFacts facts(const QuestSpec& spec) {
    return {.trials = spec.trials,
            .lowest = spec.lowest,
            .highest = spec.highest,
            .outcomes = 2,
            .lowest_key = "quest.lowest",
            .highest_key = "quest.highest",
            .one_sided = spec.gamma > 0.0};
}

RuleFacts facts(const QuestPlusSpec& spec) {
    refuse_if(spec.entropy_bits != 0.0,
              "entropy_bits is {}: a session's plan is complete before its first trial; leave it "
              "out and give trials",
              spec.entropy_bits);
    refuse_if(
        spec.stimuli.dimensions() != 1,
        "the rule chooses {} numbers a trial: a session varies one; give a model with one stimulus",
        spec.stimuli.dimensions());
    const std::vector<double>& values = spec.stimuli.axis(0).values;
    return {.trials = spec.trials,
            .lowest = values.front(),
            .highest = values.back(),
            .outcomes = spec.model.outcomes,
            .lowest_key = "stimuli.stimulus",
            .highest_key = "stimuli.stimulus"};
}

}  // namespace

RuleFacts facts_of(const ProcedureSpec& spec) {
    return std::visit([](const auto& s) { return facts(s); }, spec);
}

}  // namespace palpate::protocols
