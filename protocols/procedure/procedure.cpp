#include "protocols/procedure/procedure.hpp"

namespace palpate::protocols {

Procedure::State Procedure::start(const ProcedureSpec& spec, Pcg32 random) {
    struct Start {
        Pcg32 random;
        State operator()(const ConstantStimuliSpec& s) const { return ConstantStimuli(s, random); }
        State operator()(const std::vector<StaircaseSpec>& s) const {
            return Staircases(s, random);
        }
        State operator()(const QuestSpec& s) const { return Quest(s); }
        State operator()(const PsiSpec& s) const { return QuestPlus(quest_plus_spec(s)); }
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

void Procedure::update(std::span<const double> shown, std::size_t outcome) {
    std::visit([&](auto& s) { s.update(shown, outcome); }, state_);
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

}  // namespace palpate::protocols
