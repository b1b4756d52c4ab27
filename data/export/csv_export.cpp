#include "data/export/csv_export.hpp"

#include <utility>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "engine/base/text.hpp"
#include "data/store/reader.hpp"
#include "data/trace/columns.hpp"

namespace palpate::data {
namespace {

void describe(const ExportOptions& options, const std::filesystem::path& path) {
    DelimitedFile file(path, TableStyle::csv);
    const auto row = [&file](std::initializer_list<std::string_view> words) {
        for (const std::string_view word : words) {
            word.empty() ? file.none() : file.text(word);
        }
        file.end_row();
    };
    row({"table", "column", "type", "unit", "meaning", "levels"});
    for (const ExportTable& table : export_tables()) {
        if (table.detail && !options.details) {
            continue;
        }
        row({table.name, "", "", "", table.meaning, ""});
        for (const ExportColumn& column : visible_columns(table, options.details)) {
            row({table.name, column.name, column.type, column.unit, column.meaning, column.levels});
        }
    }
    if (options.traces) {
        row({"ticks", "", "", "", "one row a servo tick, in the object's frame", ""});
        for (const ExportColumn& key : tick_keys()) {
            row({"ticks", key.name, key.type, key.unit, key.meaning, key.levels});
        }
        for (const TraceColumn& column : trace_columns()) {
            row({"ticks", column.name, column.type, column.unit, column.meaning, ""});
        }
    }
    file.close();
}

std::string words(const Selection& selection, const ExportOptions& options) {
    return fmt::format(
        "Exported by palpate: {}, kind {}.\n"
        "One file a table; columns.csv says type, unit (SI) and meaning of every column. The keys "
        "are\n"
        "subject, study_label, session_number, trial_number. Text is UTF-8; an empty field: not "
        "known or not so. Numbers read\n"
        "back to the same bits in C, Python and R (pandas: float_precision='round_trip'). A text "
        "that a spreadsheet would take for a formula has\n"
        "' in front.\n{}",
        counted(selection.sessions().size(), "session"), options.kind,
        options.details ? "With details: wall clock, operator, notes. Hand it on to nobody who may "
                          "not know them.\n"
                        : "De-identified: codes, operators, wall clock, notes and details of "
                          "participants left out.\n");
}

void write_rows(Statement row,
                const std::vector<ExportColumn>& columns,
                const std::filesystem::path& path) {
    DelimitedFile file(path, TableStyle::csv);
    for (const ExportColumn& column : columns) {
        file.text(column.name);
    }
    file.end_row();
    write_rows(std::move(row), file);
}

}  // namespace

std::string trial_name(const ChosenSession& session, std::int64_t trial) {
    return fmt::format("{}_{}_ses-{:02}_trial-{:04}", session.subject, session.label,
                       session.number, trial);
}

void write_table(Database& database,
                 const ExportTable& table,
                 const ExportOptions& options,
                 const std::filesystem::path& path) {
    const auto columns = visible_columns(table, options.details);
    write_rows(database.prepare(select_sql(table, columns)), columns, path);
}

void write_session_table(Database& database,
                         const ExportTable& table,
                         const ExportOptions& options,
                         const ChosenSession& session,
                         const std::filesystem::path& path) {
    const auto columns = visible_columns(table, options.details);
    Statement row =
        database.prepare(select_sql(table, columns, "chosen.session_id = ?1"), session.id);
    write_rows(std::move(row), columns, path);
}

void write_ticks(Database& database,
                 std::int64_t trial,
                 std::int64_t number,
                 const ChosenSession& session,
                 const std::filesystem::path& path) {
    DelimitedFile file(path, TableStyle::csv);
    for (const ExportColumn& key : tick_keys()) {
        file.text(key.name);
    }
    for (const TraceColumn& column : trace_columns()) {
        file.text(column.name);
    }
    file.end_row();
    TraceReader traces(database);
    for (const std::int64_t interval : {1, 2}) {
        for (const engine::TickRecord& tick : traces.stored(trial, interval)) {
            file.text(session.subject);
            file.text(session.label);
            file.integer(session.number);
            file.integer(number);
            file.integer(interval);
            for (const TraceColumn& column : trace_columns()) {
                file.value(column.value(tick));
            }
            file.end_row();
        }
    }
    file.close();
}

void write_codes(Database& database, const std::filesystem::path& path) {
    DelimitedFile file(path, TableStyle::csv);
    file.text("subject");
    file.text("participant_code");
    file.end_row();
    for (const Statement& row : database.prepare(
             "SELECT DISTINCT chosen.subject, participant_code FROM chosen JOIN session USING "
             "(session_id) JOIN participant USING (participant_id) ORDER BY chosen.subject")) {
        file.text(row.text(0));
        file.text(row.text(1));
        file.end_row();
    }
    file.close();
}

void export_csv(const Exporting& to) {
    const auto& [database, selection, options, folder] = to;
    for (const ExportTable& table : export_tables()) {
        if (!table.detail || options.details) {
            write_table(database, table, options, folder / (std::string(table.name) + ".csv"));
        }
    }
    describe(options, folder / "columns.csv");
    write_whole(folder / "README.txt", words(selection, options));
    if (options.keep_codes) {
        write_codes(database, folder / "codes.csv");
    }
    if (!options.traces) {
        return;
    }
    std::filesystem::create_directory(folder / "ticks");
    for (const ChosenSession& session : selection.sessions()) {
        each_traced_trial(database, session, [&](std::int64_t trial, std::int64_t number) {
            write_ticks(database, trial, number, session,
                        folder / "ticks" / (trial_name(session, number) + ".csv.gz"));
        });
    }
}

}  // namespace palpate::data
