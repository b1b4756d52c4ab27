#pragma once

#include <cstdint>
#include <string>

#include "data/store/database.hpp"

/// One trial as one page of HTML that stands alone: no file beside it, nothing asked of a network.
/// Its one script draws every tick; without scripts and on paper drawings stand there instead.
namespace palpate::data {

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
