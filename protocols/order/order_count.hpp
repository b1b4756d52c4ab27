#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "protocols/order/natural.hpp"
#include "protocols/protocol/condition.hpp"

namespace palpate::protocols {

/// How often each condition comes.
[[nodiscard]] std::map<Condition, std::size_t> cells_of(std::span<const Condition> trials);
/// The number of orders of the trials as they are, like ones alike.
[[nodiscard]] Natural orders_of(std::span<const Condition> trials);
/// How often each level of a factor comes, from the lowest level that does.
[[nodiscard]] std::vector<std::size_t> counts_of(std::span<const Condition> trials,
                                                 std::size_t Condition::*factor);

/// Whether some order of these trials has more than `limit` in a row. 0: no limit.
[[nodiscard]] bool binds(std::span<const std::size_t> counts, std::size_t limit) noexcept;

/// The exact number of orders of one factor, counts[i] times level i, with at most `limit` in a
/// row.
///
/// By clusters: cut an order into pieces of one level each, neighbours alike or not, and give a
/// piece of z trials the sign + if z = 1, - if z = 0 modulo limit + 1, else nothing. Then every
/// admissible order is summed to 1 and every other to 0 (I. P. Goulden and D. M. Jackson, "An
/// inversion theorem for cluster decompositions of sequences with distinguished subsequences",
/// 1979). n things of a level make j pieces in
///
///     Q(n, j) = sum over a L + b (L + 1) = n - j of (-1)^a C(j, a) C(j - 1 + b, b)
///
/// signed ways, L = limit, and pieces of all levels mix freely. This shares nothing with
/// OrderCounter, and neither trusts the other: the tests compare them. Time grows with the cube of
/// the trials.
///
/// @param limit  >= 1
[[nodiscard]] Natural count_orders(std::span<const std::size_t> counts, std::size_t limit);

/// Beyond, count_orders() takes more than a moment.
inline constexpr std::size_t kMaxCounted = 240;

/// How many bits an acceptance has before its first 1, about: one shuffle in 2^rarity keeps the
/// limit. By count_orders(); beyond kMaxCounted trials by the expected number of runs that are too
/// long.
[[nodiscard]] std::size_t rarity_of(std::span<const std::size_t> counts, std::size_t limit);

}  // namespace palpate::protocols
