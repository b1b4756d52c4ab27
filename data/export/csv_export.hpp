#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "data/export/selection.hpp"
#include "data/sql/statement.hpp"

namespace palpate::data {

/// One column of an exported table: what it is called there, and the SQL that gives it.
struct ExportColumn {
    std::string name;
    std::string type;  ///< integer, real, text
    std::string unit;  ///< SI; "1" for counts and shares, "" for words
    std::string meaning;
    std::string sql;
    bool detail = false;   ///< only with details: it can tell who somebody is, when and where
    std::string levels{};  ///< of a fixed set of words: "real = a session of the study; ..."
};

/// A table of an export, column by column, as a query of the file.
struct ExportTable {
    std::string name;
    std::string meaning;
    std::string from;  ///< FROM and all that follows but ORDER BY
    std::string order;
    std::vector<ExportColumn> columns;
    bool detail = false;  ///< the whole table only with details
};

/// left, right or both: as run tells the clear from the unclear.
inline constexpr const char* kHandednessSql =
    "CASE WHEN participant.handedness <= -40 THEN 'left' WHEN participant.handedness >= 40 THEN"
    " 'right' WHEN participant.handedness IS NOT NULL THEN 'both' END";

/// What is exported, whatever the format: the catalogue's columns that may leave the file, and what
/// is computed of them. The SQL reads the tables of a Selection beside the file's own.
[[nodiscard]] const std::vector<ExportTable>& export_tables();
[[nodiscard]] const ExportTable& export_table(std::string_view name);

/// Of a row of ticks: whose they are, then the trace's columns. They have no sql.
[[nodiscard]] const std::vector<ExportColumn>& tick_columns();
/// Of codes.csv, which no select_sql() writes.
[[nodiscard]] const std::vector<ExportColumn>& code_columns();

/// The words that may stand in a column, and what each means; none where any text or number may.
[[nodiscard]] std::vector<std::pair<std::string_view, std::string_view>> levels_of(
    const ExportColumn& column);

/// The columns of a table that a reader may see.
[[nodiscard]] std::vector<ExportColumn> visible_columns(const ExportTable& table, bool details);

inline constexpr const char* kOfSession = "chosen.session_id = ?1";

/// SELECT of these columns. @param where  kOfSession; empty: all
[[nodiscard]] std::string select_sql(const ExportTable& table,
                                     std::span<const ExportColumn> columns,
                                     std::string_view where = {});

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
