#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "data/schema/manual.hpp"

namespace palpate::data {

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

/// Tables of the catalogue that have this column: whatever else a file has is somebody's own.
[[nodiscard]] std::vector<std::string> tables_with(std::string_view column);

/// @param name  "table.column"
/// @return nothing if the catalogue does not have it
[[nodiscard]] const ColumnManual* find_column(std::string_view name);

/// The views of the catalogue: part of schema_sql().
[[nodiscard]] std::string_view views_sql();

}  // namespace palpate::data
