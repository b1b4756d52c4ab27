#pragma once

#include <filesystem>

#include "data/export/selection.hpp"

/// Answers as other programs of the field take them, with a README.txt that says how. Kinds of
/// sessions stay apart.
namespace palpate::data {

/// quickpsy.csv for the package of R (D. Linares, J. Lopez-Moliner, R Journal 8:122, 2016):
/// participant, study, kind, condition, x, k, n; k of n answers at x were yes, or the comparison.
/// Main trials that count.
/// @throws std::invalid_argument if there is no answer on a graded stimulus
void export_quickpsy(Database& database,
                     const Selection& selection,
                     const std::filesystem::path& folder);

/// The same counts for psignifit 4: a file without head for each participant and condition, lines
/// of x,k,n, and index.csv: which file is whose. @throws as export_quickpsy
void export_psignifit(Database& database,
                      const Selection& selection,
                      const std::filesystem::path& folder);

/// A file a session with the columns of PsychoPy's wide CSV: a row an answer in the order given,
/// practice and answers that do not count too (column counts). trials.thisN counts the rows from 0,
/// trials.thisIndex is the place in the plan, trials.thisRepN says how often that place was tried
/// before, key_resp.keys what was answered, key_resp.rt in s. No PsychoPy has read them here.
void export_psychopy(Database& database,
                     const Selection& selection,
                     const std::filesystem::path& folder);

}  // namespace palpate::data
