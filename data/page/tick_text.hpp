#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

/// Numbers of every tick as text of a page, some one and a half bytes each; trial_script.js reads
/// them.
namespace palpate::data {

/// In place of a number that there is not.
inline constexpr std::int64_t kNoNumber = std::numeric_limits<std::int32_t>::min();

/// RFC 4648, with its padding.
[[nodiscard]] std::string base64(std::string_view bytes);

/// base64() of: a byte `order`, then what a straight line through the values before (order 2), the
/// value before (1) or nothing (0) leaves of each value, what is before the first being 0. Each is
/// folded (0, -1, 1, -2 are 0, 1, 2, 3) and stands in groups of 7 bits, the lowest first, all but
/// the last with 128 added; after a 0 comes in the same way how many more follow. The order is the
/// one with the fewest bytes.
/// @param values  |value| < 2^50
[[nodiscard]] std::string tick_text(std::span<const std::int64_t> values);

}  // namespace palpate::data
