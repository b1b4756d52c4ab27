#pragma once

struct sqlite3;

namespace palpate::data {

/// The read-only virtual table `sample` on the main database of `db`.
/// @return an SQLite result code
int add_sample_module(sqlite3* db);

/// `sample` and the statistics of functions.hpp. @return an SQLite result code
int add_extension(sqlite3* db);

/// Whether the main database has a table or view of that name: queries would ask it and not the
/// ticks.
bool sample_is_hidden(sqlite3* db);
inline constexpr const char* kSampleIsHidden =
    "the file has a table or view of its own called sample, which hides the ticks: rename it";

}  // namespace palpate::data
