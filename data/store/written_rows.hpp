#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "protocols/design/plan.hpp"
#include "protocols/protocol/protocol.hpp"
#include "protocols/session/recorder.hpp"
#include "data/store/row.hpp"
#include "data/store/stored_progress.hpp"

/// Rows as the program writes them, but for the numbers of other rows (trial_id, session_id) and
/// the clock: the store inserts them, verify makes them again and compares.
namespace palpate::data {

/// What a session begins with, in the order of the tables' keys.
[[nodiscard]] std::vector<Row> plan_rows(const protocols::Protocol& protocol,
                                         const protocols::Plan& plan);
[[nodiscard]] std::vector<Row> picture_rows(const protocols::Protocol& protocol,
                                            const protocols::Plan& plan);
/// Of trials whose stimulus a rule chooses.
[[nodiscard]] std::vector<Row> adaptive_plan_rows(const protocols::Protocol& protocol,
                                                  const protocols::Plan& plan);
/// The same in every file.
[[nodiscard]] std::vector<Row> trace_column_rows();
/// Rows that are there stay.
void keep_trace_columns(Database& database);
/// @param file  how to call it
/// @throws StoreError if it says otherwise than this program how ticks are written
void require_trace_columns(Database& database, std::string_view file);

/// Of trial, what is known as an attempt begins. @param attempt  at this position, from 1
[[nodiscard]] Row attempt_row(std::size_t position,
                              std::int64_t attempt,
                              const TrialDevice& device);

/// Of presentation, what an interval lets one feel. How it was felt is added by set_summary().
[[nodiscard]] Row presentation_row(const protocols::Presentation& felt,
                                   const protocols::SceneConstants& scene);

/// Sets the measures that the row's table has.
/// @param force  the device gives some; else what nobody felt is NULL
void set_summary(Row& row, const protocols::TrialSummary& sum, bool force);

/// Of response.
[[nodiscard]] Row response_row(const protocols::Protocol& protocol,
                               const protocols::Response& response);

/// Of adaptive_step: an answer that the rule took in.
[[nodiscard]] Row step_row(const protocols::AdaptiveStep& step);

/// Of fault_tick.
[[nodiscard]] Row fault_row(const engine::TickRecord& tick);

}  // namespace palpate::data
