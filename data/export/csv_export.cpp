#include "data/export/csv_export.hpp"

#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <zlib.h>

#include "engine/base/files.hpp"
#include "engine/base/text.hpp"
#include "data/csv/csv_text.hpp"
#include "data/store/reader.hpp"
#include "data/trace/columns.hpp"

namespace palpate::data {
namespace {

/// What R makes of plain decimal text: all digits into a long double, then one scaling by a power
/// of ten.
double read_by_r(std::string_view text) {
    long double digits = 0.0L;
    int exponent = 0;
    bool fraction = false;
    std::size_t at = text.starts_with('-') ? 1 : 0;
    for (; at < text.size() && text[at] != 'e'; ++at) {
        if (text[at] == '.') {
            fraction = true;
            continue;
        }
        digits = 10.0L * digits + static_cast<long double>(text[at] - '0');
        exponent -= fraction ? 1 : 0;
    }
    if (at < text.size()) {
        exponent += std::atoi(std::string(text.substr(at + 1)).c_str());
    }
    long double scale = 1.0L;
    long double power = 10.0L;
    for (int left = std::abs(exponent); left > 0; left >>= 1, power *= power) {
        scale *= (left & 1) != 0 ? power : 1.0L;
    }
    const auto size = static_cast<double>(exponent < 0 ? digits / scale : digits * scale);
    return text.starts_with('-') ? -size : size;
}

constexpr std::size_t kPending = std::size_t{1} << 16U;

void describe(const ExportOptions& options, const std::filesystem::path& path) {
    DelimitedFile file(path, TableStyle::csv);
    const auto row = [&file](std::initializer_list<std::string_view> words) {
        for (const std::string_view word : words) {
            word.empty() ? file.add(std::monostate()) : file.add(word);
        }
        file.end_row();
    };
    row({"table", "column", "type", "unit", "meaning", "levels"});
    const auto tell = [&row](std::string_view name, std::string_view meaning,
                             std::span<const ExportColumn> columns) {
        row({name, "", "", "", meaning, ""});
        for (const ExportColumn& one : columns) {
            row({name, one.name, one.type, one.unit, one.meaning, one.levels});
        }
    };
    for (const ExportTable& table : export_tables()) {
        if (!table.detail || options.details) {
            tell(table.name, table.meaning, visible_columns(table, options.details));
        }
    }
    if (options.traces) {
        tell("ticks", "one row a servo tick, in the object's frame", tick_columns());
    }
    if (options.keep_codes) {
        tell("codes", "which of the lab's codes each subject is", code_columns());
    }
    file.close();
}

std::string words(const Selection& selection, const ExportOptions& options) {
    return fmt::format(
        "Exported by palpate: {}, kind {}.\n"
        "One file a table; columns.csv says type, unit (SI) and meaning of every column. The keys "
        "are\n"
        "subject, study_label, session_number, trial_number. Text is UTF-8. In CSV an empty "
        "field is what is not known or not so,\n"
        "numbers read back to the same bits in C, Python and R (pandas: "
        "float_precision='round_trip'), and a text that a\n"
        "spreadsheet would take for a formula has ' in front; in Parquet the first is null, and "
        "every text as it was.\n{}",
        counted(selection.sessions().size(), "session"), options.kind,
        options.details ? "With details: wall clock, operator, notes. Hand it on to nobody who may "
                          "not know them.\n"
                        : "De-identified: codes, operators, wall clock, notes and details of "
                          "participants left out.\n");
}

}  // namespace

std::string number_text(double value) {
    std::string shortest = fmt::format("{}", value);
    if (!std::isfinite(value) || read_by_r(shortest) == value) {
        return shortest;
    }
    return fmt::format("{:.17e}", value);
}

DelimitedFile::DelimitedFile(std::filesystem::path path, TableStyle style)
    : path_(std::move(path)), style_(style) {
    // "T": as it is.
    file_ = gzopen(path_.c_str(), path_.extension() == ".gz" ? "wbe6" : "wbeT");
    if (file_ == nullptr) {
        fail();
    }
}

DelimitedFile::~DelimitedFile() {
    if (file_ != nullptr) {
        gzclose(static_cast<gzFile>(file_));
    }
}

void DelimitedFile::fail() const {
    throw std::runtime_error(fmt::format(
        "cannot write {}: is its folder writable and the disk not full?", path_.string()));
}

void DelimitedFile::raw(std::string_view value) {
    if (!first_) {
        pending_ += style_ == TableStyle::csv ? ',' : '\t';
    }
    first_ = false;
    pending_ += value;
}

void DelimitedFile::put(std::string_view text) {
    raw(style_ == TableStyle::tsv ? tsv_field(text) : csv_field(text));
}
void DelimitedFile::put(std::int64_t value) {
    raw(fmt::format("{}", value));
}
void DelimitedFile::put(double value) {
    std::isnan(value) ? put(std::monostate()) : raw(number_text(value));
}
void DelimitedFile::put(std::span<const std::byte> bytes) {
    put(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}
void DelimitedFile::put(std::monostate /*none*/) {
    raw(style_ == TableStyle::tsv ? "n/a" : "");
}

void DelimitedFile::end_row() {
    pending_ += '\n';
    first_ = true;
    if (pending_.size() >= kPending) {
        flush();
    }
}

void DelimitedFile::head(std::span<const ExportColumn> columns) {
    for (const ExportColumn& column : columns) {
        add(column.name);
    }
    end_row();
}

void DelimitedFile::flush() {
    const auto size = static_cast<unsigned>(pending_.size());
    if (size > 0 && gzwrite(static_cast<gzFile>(file_), pending_.data(), size) <= 0) {
        fail();
    }
    pending_.clear();
}

void DelimitedFile::close() {
    flush();
    if (gzclose(static_cast<gzFile>(std::exchange(file_, nullptr))) != Z_OK) {
        fail();
    }
}

void write_rows(Statement row, DelimitedFile& file) {
    while (row.step()) {
        for (int column = 0; column < row.columns(); ++column) {
            file.add(row.value(column));
        }
        file.end_row();
    }
    file.close();
}

void write_table(Database& database,
                 const ExportTable& table,
                 const ExportOptions& options,
                 const std::filesystem::path& path,
                 const ChosenSession* session) {
    const auto columns = visible_columns(table, options.details);
    DelimitedFile file(path, TableStyle::csv);
    file.head(columns);
    write_rows(session == nullptr
                   ? database.prepare(select_sql(table, columns))
                   : database.prepare(select_sql(table, columns, kOfSession), session->id),
               file);
}

void write_ticks(Database& database,
                 std::int64_t trial,
                 std::int64_t number,
                 const ChosenSession& session,
                 const std::filesystem::path& path) {
    DelimitedFile file(path, TableStyle::csv);
    file.head(tick_columns());
    TraceReader traces(database);
    for (const std::int64_t interval : {1, 2}) {
        for (const engine::TickRecord& tick : traces.stored(trial, interval)) {
            file.add(session.subject, session.label, session.number, number, interval);
            for (const TraceColumn& column : trace_columns()) {
                file.add(column.value(tick));
            }
            file.end_row();
        }
    }
    file.close();
}

void write_codes(Database& database, const std::filesystem::path& path) {
    DelimitedFile file(path, TableStyle::csv);
    file.head(code_columns());
    write_rows(database.prepare("SELECT DISTINCT chosen.subject, participant_code FROM chosen JOIN "
                                "session USING (session_id) JOIN participant USING "
                                "(participant_id) ORDER BY chosen.subject"),
               file);
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
                        folder / "ticks" /
                            fmt::format("{}_{}_ses-{:02}_trial-{:04}.csv.gz", session.subject,
                                        session.label, session.number, number));
        });
    }
}

}  // namespace palpate::data
