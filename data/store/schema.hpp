#pragma once

#include <cstdint>
#include <string_view>

namespace palpate::data {

/// "palp" in the file's header: says that a SQLite file is ours.
inline constexpr std::int64_t kApplicationId = 0x70616C70;
inline constexpr std::int64_t kSchemaVersion = 1;

/// The whole schema as SQL: the manual of the file. SQLite keeps a comment only inside a statement, so
/// they stand there, and `sqlite3 FILE .schema` prints them from any database.
[[nodiscard]] std::string_view schema_sql() noexcept;

}  // namespace palpate::data
