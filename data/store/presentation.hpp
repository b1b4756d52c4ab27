#pragma once

#include <cstdint>
#include <string_view>
#include <variant>
#include <vector>

#include "protocols/session/recorder.hpp"
#include "data/store/row.hpp"

/// What each interval of a trial let one feel, and how it was felt: the table presentation.
namespace palpate::data {

/// A column that is added up from ticks, and what it is.
struct SummaryValue {
    std::string_view column;
    std::variant<std::monostate, std::int64_t, double> value;
};

/// All of them. The table trial has each, presentation some.
/// @param force  the device gives some; else what nobody felt is NULL
[[nodiscard]] std::vector<SummaryValue> summary_values(const protocols::TrialSummary& sum,
                                                       bool force);

/// Sets those that the row's table has.
void set_summary(Row& row, const protocols::TrialSummary& sum, bool force);

/// Inserts what was felt in one interval of a trial. In the caller's transaction.
void write_presentation(Database& database,
                        std::int64_t trial,
                        const protocols::Presentation& felt,
                        const protocols::SceneConstants& scene);

/// The numbers of an interval when its trial has ended.
void write_interval_result(Database& database,
                           std::int64_t trial,
                           std::int64_t interval,
                           const protocols::IntervalResult& result,
                           bool force);

/// Inserts the answer of a trial. In the caller's transaction.
void write_response(Database& database,
                    std::int64_t trial,
                    const protocols::Protocol& protocol,
                    const protocols::Response& response);

}  // namespace palpate::data
