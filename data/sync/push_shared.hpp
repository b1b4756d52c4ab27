#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "data/store/database.hpp"
#include "data/sync/postgres_tables.hpp"

namespace palpate::data {

/// Before rows that several files have: two rigs that add them in other orders would wait for each
/// other.
inline constexpr std::string_view kOneAtATime = "SELECT pg_advisory_xact_lock(1885432945)";

/// A row of a file, behind what the server's table has before it.
[[nodiscard]] PostgresRow with_row(PostgresRow before, const Statement& row);

/// Adds what is of no session: studies that are what their text says (of another no session is
/// whole), and trace_column.
/// @param sql  of each table
/// @param conflicts  gets what the server has otherwise @return rows that were added
[[nodiscard]] std::int64_t push_shared(Database& database,
                                       Postgres& server,
                                       const std::map<std::string, PostgresRows>& sql,
                                       std::vector<std::string>& conflicts);

}  // namespace palpate::data
