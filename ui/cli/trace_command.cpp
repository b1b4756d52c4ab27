#include <fmt/format.h>

#include "data/store/reader.hpp"
#include "data/store/stored_chunks.hpp"
#include "ui/cli/commands.hpp"

namespace palpate::ui {

/// The columns that every chunk holds, as data/trace/read_trace.py and read_trace.R print them.
int trace_command(const TraceOptions& options) {
    data::Database database(options.database, data::Access::read);
    const data::Snapshot now(database);
    static_cast<void>(data::trial_context(database, options.trial));  // it is there
    data::TraceReader reader(database);
    std::vector<std::vector<std::int64_t>> columns;
    std::string line;
    for (std::size_t i = 0; i < data::kStoredColumns; ++i) {
        columns.push_back(
            reader.column(options.trial, static_cast<data::Stored>(i), options.interval));
        line += fmt::format("{}{}", i == 0 ? "" : ",", data::stored_columns()[i].name);
    }
    fmt::print("{}\n", line);
    for (std::size_t tick = 0; tick < columns.front().size(); ++tick) {
        line.clear();
        for (const auto& column : columns) {
            line += fmt::format("{}{}", line.empty() ? "" : ",", column[tick]);
        }
        fmt::print("{}\n", line);
    }
    return 0;
}

}  // namespace palpate::ui
