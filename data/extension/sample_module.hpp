#pragma once

struct sqlite3;
struct sqlite3_value;

namespace palpate::data {

/// Whether the main database has a table or view of somebody's that is called sample.
bool has_own_sample(sqlite3* db);

/// The read-only virtual table `sample` on the main database of `db`; where the file has something
/// of that name it stands before it, as this connection's own.
/// @return an SQLite result code
int add_sample_module(sqlite3* db);

/// Whether one of the arguments of a function is NULL.
[[nodiscard]] bool any_null(int count, sqlite3_value** values);

/// Statistics as SQL functions, deterministic, NULL for NULL; what is out of range is an SQL error
/// with a sentence. Formulas and accuracy: data/statistics.
///
///   wilson_low(k, n [, confidence]), wilson_high        score interval of a share; 0.95
///   clopper_pearson_low(k, n [, confidence]), ..._high  exact interval of a share
///   d_prime(hits, n, alternatives)                      of m-alternative forced choice; n of n
///                                                       counts as n - 1/2, none as 1/2: finite
///   probit(p), normal_cdf(z)                            standard normal; probit(0), (1): -Inf, Inf
///
/// @return an SQLite result code
int add_scalar_functions(sqlite3* db);

/// Aggregates, each a window function too (a frame says to the bit what its rows say as a group,
/// and takes as long); rows with NULL are left out, and nothing of nothing is NULL.
///
///     median(x), quantile(x, p)  linear between order statistics, Hyndman & Fan's type 7 (as in R)
///     geometric_mean(x)          x > 0
///     stddev_samp(x)             n - 1 below, Welford's recurrence; NULL for one row
///     share(x)                   of rows where x is true (not 0)
///     people_share_low(x), _high(x)  95 % interval over people of the mean of their shares;
///     people_mean_low(x), _high(x)   of any number. A row is a person: paired.hpp
///     mutual_information(stimulus, response [, n])             bits, plug-in
///     mutual_information_miller_madow(stimulus, response [, n])  cut to 0 and H(stimulus), as in
///                                                                palpate stats
///
/// @return an SQLite result code
int add_aggregate_functions(sqlite3* db);

/// `sample` and the statistics. @return an SQLite result code
int add_extension(sqlite3* db);

}  // namespace palpate::data
