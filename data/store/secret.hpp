#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "data/store/database.hpp"

/// The secrets of a file (table secret), and what else is drawn with them.
namespace palpate::data {

/// The secret of every demo, which anybody may know: nobody real is in it. The last of all by its digits, so
/// that a session of people in the same file takes the file's own.
inline constexpr std::string_view kDemoSecret = "ffffffffffffffffffffffffffffffff";

/// What new sessions are drawn with: the first by its digits, so that merged files agree.
/// @throws StoreError if there is none: somebody removed it
[[nodiscard]] std::string own_secret(Database& database);

/// @throws std::invalid_argument unless it is 32 of the digits 0 to 9 and a to f
void check_secret(std::string_view hex);

/// Makes it the secret of a file without a session or a participant; nothing if the file has it already.
/// @pre check_secret(). @throws std::invalid_argument if the file has another
void set_secret(Database& database, std::string_view hex);

/// A number for exports, 1 to 9999999999, by the first 60 bits of a hash: none is more likely by 1e-8.
/// @param draw  0, 1, ...: another one where the one before is taken
[[nodiscard]] std::int64_t subject_of(std::string_view code, std::string_view secret, int draw);

/// The participant's row; one that is new gets a number for exports: drawn from secret and code, so that it says
/// nothing of who came when, and rigs that share a secret agree; never one that is taken.
/// @return participant.id
std::int64_t participant_row(Database& database, std::string_view code, std::string_view secret);

}  // namespace palpate::data
