#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "data/export/selection.hpp"

/// The files of one run (an attempt at a trial) of a BIDS dataset.
namespace palpate::data {

/// "sub-001_ses-01_task-shapefriction"
[[nodiscard]] std::string bids_stem(const ChosenSession& session);
/// "0012": the run of attempt 12.
[[nodiscard]] std::string bids_run(std::int64_t number);

/// Writes motion and stim of an attempt into the folders motion and beh (there already) of its
/// session; nothing for an interval without ticks.
void write_bids_run(Database& database,
                    const ChosenSession& session,
                    std::int64_t trial,
                    std::int64_t number,
                    const std::filesystem::path& session_folder);

}  // namespace palpate::data
