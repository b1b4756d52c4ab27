#pragma once

#include <string>

#include "data/page/study.hpp"
#include "data/store/database.hpp"

/// Pages of HTML that stand alone: no file beside them, nothing asked of a network. A study's has
/// no script; a trial's has one, which draws every tick, and without scripts and on paper drawings
/// stand there instead.
namespace palpate::data {

/// Flow and exclusions, confusions, the effect of friction within person, ratings, psychometric
/// functions and their tracks, times, confidence, learning, exploration, the audit, health of the
/// rig, seals, methods; beside every figure its table, CSV and SQL. Numbers are those of
/// stats_of(), audit_of() and fit_all(). People are numbered from 1 in the order of their numbers
/// in exports, which follows from the file's secret. No day is named. The same file gives the same
/// bytes.
/// @throws std::invalid_argument if there is no such session, or several studies: which there are
[[nodiscard]] std::string study_page(Database& database, const PageOptions& options);

/// Which trial, and how its person is called.
struct TrialPageOptions {
    std::int64_t trial = 0;  ///< trial.trial_id
    bool codes =
        false;  ///< the person by the lab's code, not by the number that study_page() gives
    std::string version{};  ///< of the program that makes the page
};

/// Who and what, of each interval what the hand did (all columns of the view `exploration`), its
/// path on the object, and every tick: place, rendered force, speed, mode and lateness, in uPlot,
/// to zoom into. Beside every figure its table, CSV and SQL. No day is named. The same file gives
/// the same bytes.
/// @throws std::invalid_argument if there is no such trial, or its person does not consent
/// @throws TraceError if a chunk is damaged or the replay gives other numbers than the servo had
[[nodiscard]] std::string trial_page(Database& database, const TrialPageOptions& options);

}  // namespace palpate::data
