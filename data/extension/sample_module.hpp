#pragma once

struct sqlite3;

namespace palpate::data {

/// Whether the main database has a table or view of somebody's that is called sample.
bool has_own_sample(sqlite3* db);

/// The read-only virtual table `sample` on the main database of `db`; where the file has something
/// of that name it stands before it, as this connection's own.
/// @return an SQLite result code
int add_sample_module(sqlite3* db);

/// `sample` and the statistics of functions.hpp. @return an SQLite result code
int add_extension(sqlite3* db);

}  // namespace palpate::data
