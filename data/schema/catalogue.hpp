#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::data {

/// Who may see a column.
enum class Visibility : std::uint8_t {
    everybody,  ///< in every export
    details,    ///< [details]: it can tell who somebody is, when and where; exported on request
    file,       ///< [file]: a key or a check of this file alone; never exported
};

/// A column of the catalogue.
struct ColumnManual {
    std::string name;
    std::string type;     ///< INTEGER, REAL, TEXT, BLOB; of a view's computed column: ""
    std::string unit;     ///< by the end of its name; "-": a text, a count, a share, a code
    std::string meaning;  ///< the comment beside it
    std::string levels;   ///< of a fixed set of words: "real = a session of the study; pilot = ..."
    bool nullable = true;
    Visibility seen = Visibility::everybody;
    std::string source;  ///< of a view: "table.column" that it repeats, else ""
};

/// What the catalogue says of a table or view.
struct TableManual {
    std::string name;
    std::string meaning;  ///< the comment above its columns
    bool view = false;
    Visibility seen = Visibility::everybody;
    std::vector<ColumnManual> columns;

    /// @return nothing if it has none of that name
    [[nodiscard]] const ColumnManual* find(std::string_view column) const;
};

/// What a schema says of itself, from the comments in its CREATE TABLE and CREATE VIEW statements:
/// a comment at the end of a line belongs to the column that ends or goes on there, one above the
/// first column to the table. Text that is no such statement is passed over. A comment may begin
/// with [details] or [file] (Seen) and end with the column's words in braces, {real = a session of
/// the study; pilot = ...}. A view's column that is another's, `trial.outcome AS outcome`, has its
/// meaning without a comment.
[[nodiscard]] std::vector<TableManual> schema_manual(std::string_view sql);

/// SI unit by the end of a column's name: "m/s" for vx_m_per_s. "-" without one.
[[nodiscard]] std::string_view unit_of(std::string_view column) noexcept;

/// "palp" in the file's header: says that a SQLite file is ours.
inline constexpr std::int64_t kApplicationId = 0x70616C70;
inline constexpr std::int64_t kSchemaVersion = 1;

/// The catalogue: every table and view as SQL, each column once, its meaning beside it. SQLite
/// keeps a comment only inside a statement, so they stand there, and `sqlite3 FILE .schema` prints
/// them from any database. Files are made from this text, and `verify` compares with it; manuals,
/// exports and their descriptions read it by catalogue(). A new column is written here and where
/// its value is computed.
[[nodiscard]] std::string_view schema_sql();

/// The catalogue of this program, read from schema_sql().
[[nodiscard]] const std::vector<TableManual>& catalogue();

/// @return nothing if there is none of that name
[[nodiscard]] const TableManual* find_table(std::string_view name,
                                            const std::vector<TableManual>& among = catalogue());

/// Tables of the catalogue that have this column: whatever else a file has is somebody's own.
[[nodiscard]] std::vector<std::string> tables_with(std::string_view column);

/// @param name  "table.column"
/// @return nothing if the catalogue does not have it
[[nodiscard]] const ColumnManual* find_column(std::string_view name,
                                              const std::vector<TableManual>& among = catalogue());

/// The views of the catalogue: part of schema_sql().
[[nodiscard]] std::string_view views_sql();

}  // namespace palpate::data
