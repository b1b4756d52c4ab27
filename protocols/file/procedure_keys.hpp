#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "protocols/file/table_view.hpp"

/// What a procedure file may say. One row a key; reading, range checks and the reference for people are
/// driven by these rows.
namespace palpate::protocols {

/// What kind of value a key takes.
enum class KeyKind : std::uint8_t {
    number,
    integer,
    flag,
    word,         ///< one of `words`
    name,         ///< letters a-z, digits and _
    text,         ///< up to 200 characters
    numbers,      ///< a list
    one_or_more,  ///< a number or a list
    names,        ///< a list of texts
    axis,         ///< a number, a list, { from, to, count } or { from, to, step }
    prior         ///< a list of weights, or { mean, sd }
};

struct ProcedureKey {
    std::string_view table;
    std::string_view name;
    KeyKind kind = KeyKind::number;
    Range range{};                      ///< of a number, or of every number of a list
    std::optional<double> otherwise{};  ///< if the key is left out
    bool required = false;              ///< else: left out, without a value of its own
    std::span<const std::string_view> words{};
    std::string_view meaning{};
};

[[nodiscard]] std::span<const ProcedureKey> procedure_keys() noexcept;

/// "0 to 1", "above 0", ...
[[nodiscard]] std::string range_words(const Range& range);

inline constexpr std::int64_t kProcedureFormat = 1;

}  // namespace palpate::protocols
