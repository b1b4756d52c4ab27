#include "protocols/procedure/psi.hpp"

namespace palpate::protocols {

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
