#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

}  // namespace palpate::data
