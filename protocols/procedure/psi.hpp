#pragma once

#include <string>
#include <vector>

#include "protocols/procedure/quest_plus.hpp"

namespace palpate::protocols {

/// The psi method (L. L. Kontsevich and C. W. Tyler, "Bayesian adaptive estimation of psychometric
/// slope and threshold", Vision Research 39, 2729-2737, 1999) and its marginal form (N. Prins, "The
/// psi-marginal adaptive method", Journal of Vision 13(7):3, 2013).
struct PsiSpec {
    Family family = Family::normal;
    LapseForm form = LapseForm::upper;
    std::vector<double> stimuli;
    std::vector<double> thresholds;
    std::vector<double> log10_slopes;
    std::vector<double> guesses{0.5};
    std::vector<double> lapses{0.02};
    std::vector<std::vector<double>> prior{};  ///< threshold, log10_slope, guess, lapse
    std::vector<std::string>
        nuisance{};  ///< psi-marginal: e.g. lapse; empty: as Kontsevich & Tyler
    std::size_t trials = 64;
};

/// QUEST+ with one stimulus dimension and two outcomes is the psi method: both show the stimulus of
/// least expected entropy. What psi adds is its grid: the slope by its decadic logarithm, so that
/// the estimate is the posterior mean of log10 slope. Kontsevich & Tyler fix the lapse rate;
/// psi-marginal has it in the grid as a nuisance.
[[nodiscard]] QuestPlusSpec quest_plus_spec(const PsiSpec& psi);

}  // namespace palpate::protocols
