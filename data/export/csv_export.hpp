#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "data/export/selection.hpp"
#include "data/export/tables.hpp"
#include "data/sql/statement.hpp"

namespace palpate::data {

/// A number in the fewest digits from which C, Python and R all read back the same bits; 18 digits
/// where R would miss the fewest that C needs: it reads in extended precision and rounds twice
/// (arithmetic.c, R_strtod), which is wrong for about one number in 4,000. inf and -inf are written
/// so, NaN as "nan".
[[nodiscard]] std::string number_text(double value);

/// How a table is written: texts as csv_field() or tsv_field() has them, lines end in "\n". csv:
/// nothing for what is not there; tsv: n/a.
enum class TableStyle : std::uint8_t { csv, tsv };

/// A table of text, row by row. A name that ends in .gz is compressed, the same bytes for the same
/// rows. Numbers as number_text() has them; NaN is not there. Every call throws std::runtime_error
/// if the file cannot be written.
class DelimitedFile {
public:
    /// Begins the file anew: what stood there is gone.
    DelimitedFile(std::filesystem::path path, TableStyle style);
    DelimitedFile(const DelimitedFile&) = delete;
    DelimitedFile& operator=(const DelimitedFile&) = delete;
    ~DelimitedFile();

    /// The next fields of the row: texts, whole numbers, reals, bytes, which are texts, or any of
    /// these in a variant. std::monostate leaves its field empty (csv) or says n/a (tsv).
    template <class... Values>
    void add(const Values&... values) {
        (put(values), ...);
    }
    void end_row();
    /// These, and the row ends.
    template <class... Values>
    void row(const Values&... values) {
        add(values...);
        end_row();
    }
    /// The head: the columns' names.
    void head(std::span<const ExportColumn> columns);
    /// What was not closed is not whole.
    void close();

private:
    void put(std::string_view text);
    void put(std::int64_t value);
    void put(double value);
    void put(std::span<const std::byte> bytes);
    void put(std::monostate none);
    template <class... T>
    void put(const std::variant<T...>& value) {
        std::visit([this](const auto& one) { put(one); }, value);
    }
    void raw(std::string_view value);
    void flush();
    [[noreturn]] void fail() const;

    std::filesystem::path path_;
    TableStyle style_;
    std::string pending_;
    void* file_ = nullptr;  ///< zlib's
    bool first_ = true;     ///< of its row
};

/// The rows of a query, with which the file ends.
void write_rows(Statement row, DelimitedFile& file);

/// One file a table (participants, sessions, plan, pictures, trials, responses, events; with
/// details also participant_details and provenance), columns.csv with type, unit and meaning of
/// every column, README.txt; with codes codes.csv; with traces
/// ticks/SUBJECT_STUDY_ses-NN_trial-NNNN.csv.gz.
void export_csv(const Exporting& to);

/// A table of the export as CSV with a head line: of all sessions, or of one.
void write_table(Database& database,
                 const ExportTable& table,
                 const ExportOptions& options,
                 const std::filesystem::path& file,
                 const ChosenSession* session = nullptr);

/// All ticks of a trial, lost ones left out. @param number  of the trial in its session
void write_ticks(Database& database,
                 std::int64_t trial,
                 std::int64_t number,
                 const ChosenSession& session,
                 const std::filesystem::path& file);

/// Which code of the lab each subject is.
void write_codes(Database& database, const std::filesystem::path& file);

/// For every trial of the session with ticks: its id and its number. @param visit  (id, number)
template <class Visit>
void each_traced_trial(Database& database, const ChosenSession& session, const Visit& visit) {
    Statement row = database.prepare(
        "SELECT trial.trial_id, trial_number FROM trial JOIN numbered USING (trial_id) WHERE "
        "trial.session_id = ?1 AND EXISTS (SELECT 1 FROM trace_chunk WHERE trace_chunk.trial_id = "
        "trial.trial_id) ORDER BY trial.trial_id",
        session.id);
    while (row.step()) {
        visit(row.integer(0), row.integer(1));
    }
}

}  // namespace palpate::data
