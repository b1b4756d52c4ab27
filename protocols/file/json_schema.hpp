#pragma once

#include <array>
#include <string>
#include <string_view>

/// What files may say as JSON Schema (draft 2020-12), for editors that complete, explain and check
/// each key of a TOML file by it, and for validators.
namespace palpate::protocols {

/// The kinds of files that have one.
inline constexpr std::array<std::string_view, 5> kSchemaKinds{"protocol", "procedure", "scene",
                                                              "calibration", "observer"};

/// Printed from the rows that read the file: keys, types, ranges, words, defaults, meanings, which
/// keys and tables belong together. It refuses nothing that the program takes. The program refuses
/// more: what two values say of each other, whole floats where an integer is asked for, NaN, and
/// texts by their bytes where the schema counts characters.
/// @param kind  one of kSchemaKinds
/// @throws std::invalid_argument for another
[[nodiscard]] std::string json_schema(std::string_view kind);

}  // namespace palpate::protocols
