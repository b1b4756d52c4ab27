#pragma once

#include <span>
#include <string_view>

#include "data/extension/sample_cursor.hpp"

struct sqlite3_index_info;
struct sqlite3_value;

namespace palpate::data {

/// Which constraints of a query on `sample` narrow its scan, in which order its rows come, and what
/// that costs: what xBestIndex answers. Writes the choice as info.idxStr.
///
/// Used are: trial_id and interval with = or IS, ranges of trial_id, tick and time_s. All else
/// SQLite looks at row by row.
void choose_scan(sqlite3_index_info& info);

/// The scan that was chosen, with the values that the constraints have now.
[[nodiscard]] SampleScan chosen_scan(std::string_view plan, std::span<sqlite3_value* const> values);

}  // namespace palpate::data
