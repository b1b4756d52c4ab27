#pragma once

#include <cstdint>
#include <string>

struct sqlite3;

namespace palpate::data {

class Database;

/// Brings a file of schema `from` to the present one. The caller holds the write lock and commits.
void migrate(Database& database, std::int64_t from);

/// A copy of the database as the last commit left it, FILE.schema4.backup, mode 0600; FILE.schema4.backup.2
/// and so on where there is one already. It is whole and on the disk before this returns.
/// @return its name
/// @throws StoreError if it cannot be made
std::string back_up(const std::string& file, std::int64_t version);

}  // namespace palpate::data
