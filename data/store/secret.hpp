#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "data/store/database.hpp"

/// The secrets of a file (table secret), and what else is drawn with them.
namespace palpate::data {

/// The secret of every demo, which anybody may know: nobody real is in it, and nobody real is drawn
/// with it while the file has another.
inline constexpr std::string_view kDemoSecret = "ffffffffffffffffffffffffffffffff";

/// The file has a session or a participant: something may be drawn with its secret.
[[nodiscard]] bool anybody_in(Database& database);

/// Secrets beside others with which nothing was drawn, no session's order and nobody's number:
/// palpate leaves none (merges bring those that were used), so somebody put them there, to know
/// whose the next orders are.
[[nodiscard]] std::vector<std::string> strange_secrets(Database& database);

/// What new sessions are drawn with: that of the first one. Whoever
/// adds a secret, with rows that were drawn with it, knows nobody's order but those rows'.
/// @throws StoreError if there is none, as somebody removed or changed it, or a strange one
[[nodiscard]] std::string own_secret(Database& database);

/// @throws std::invalid_argument unless it is 32 of the digits 0 to 9 and a to f
void check_secret(std::string_view hex);

/// Makes it the secret of a file without a session or a participant; nothing if the file has it
/// already.
/// @pre check_secret(). @throws std::invalid_argument if the file has another
void set_secret(Database& database, std::string_view hex);

/// Keeps what something is about to be drawn with: instead of a file's own while nothing is drawn
/// with that, unless everybody knows it (the demo's). In the caller's transaction.
void keep_secret(Database& database, std::string_view hex);

/// Leaves those with which something was drawn, or a single one. In the caller's transaction.
void drop_unused_secrets(Database& database);

/// The number of this person was drawn with this secret.
[[nodiscard]] bool drawn_with(std::string_view secret, std::string_view code, std::int64_t subject);

/// A number for exports, 1 to 9999999999, by the first 60 bits of a hash: none is more likely by
/// 1e-8.
/// @param draw  0, 1, ...: another one where the one before is taken
[[nodiscard]] std::int64_t subject_of(std::string_view code, std::string_view secret, int draw);

/// The participant's row; one that is new gets a number for exports: drawn from secret and code, so
/// that it says nothing of who came when, and rigs that share a secret agree; never one that is
/// taken.
/// @return participant.id
std::int64_t participant_row(Database& database, std::string_view code, std::string_view secret);

}  // namespace palpate::data
