#include <algorithm>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "data/store/analysed.hpp"
#include "data/store/reader.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/control_line.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct TraceOptions {
    std::string database;
    std::int64_t trial = 0;
    std::int64_t interval = 1;
};

void declare(CommandWords& words, TraceOptions& options) {
    words.add("FILE", options.database, "A palpate database").required();
    words.add("TRIAL", options.trial, "The id of the trial").required();
    words.add("--interval", options.interval, "Of a trial with two things to feel, which one")
        .within(1, 2);
}

/// @return why it is in no analysis; empty: it counts, or has no answer
std::string why_left_out(data::Database& database, std::int64_t trial) {
    data::Statement row =
        database.prepare("SELECT exclusion FROM analysis_trial WHERE trial_id = ?1", trial);
    return !row.step() || row.null(0) ? "" : row.text(0);
}

/// A line a tick.
std::string rows_text(const std::vector<std::vector<std::int64_t>>& columns) {
    std::string text;
    std::string line;
    for (std::size_t tick = 0; tick < columns.front().size(); ++tick) {
        line.clear();
        for (const auto& column : columns) {
            line += fmt::format("{}{}", line.empty() ? "" : ",", column[tick]);
        }
        text += line + '\n';
    }
    return text;
}

/// The columns that every chunk holds, as data/trace/read_trace.py and read_trace.R print them.
int run(const TraceOptions& options) {
    warn_of_unblinding(options.database);
    data::Database database(options.database, data::Access::read);
    const data::Snapshot now(database);
    const auto intervals = data::intervals_of(database, options.trial);
    refuse_if(!intervals.empty() && std::find(intervals.begin(), intervals.end(),
                                              options.interval) == intervals.end(),
              "{}: trial {} has no interval {}: give {}", options.database, options.trial,
              options.interval, fmt::join(intervals, " or "));
    data::require_shown(database, options.trial);
    const std::string why = why_left_out(database, options.trial);
    data::TraceReader reader(database);
    std::vector<std::vector<std::int64_t>> columns;
    std::string line;
    for (std::size_t i = 0; i < data::kStoredColumns; ++i) {
        columns.push_back(
            reader.column(options.trial, static_cast<data::ColumnId>(i), options.interval));
        line += fmt::format("{}{}", i == 0 ? "" : ",", data::stored_columns()[i].name);
    }
    if (columns.front().empty()) {
        warn("{}: no ticks are kept of trial {} (simulate --no-traces keeps none)",
             options.database, options.trial);
    }
    if (!why.empty()) {
        warn("{}: trial {} is in no analysis: {}", options.database, options.trial, why);
    }
    say_to(stdout, line + '\n' + rows_text(columns));
    return 0;
}

}  // namespace

Command trace_command() {
    return make_command<TraceOptions>(
        "trace", "Print the stored ticks of a trial, whole numbers, as CSV", declare, run);
}

}  // namespace palpate::ui
