#pragma once

struct sqlite3;

namespace palpate::data {

/// The read-only virtual table `sample` on the main database of `db`.
/// @return an SQLite result code
int add_sample_module(sqlite3* db);

/// `sample` and the statistics of functions.hpp. @return an SQLite result code
int add_extension(sqlite3* db);

}  // namespace palpate::data
