#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/file/document.hpp"
#include "protocols/protocol/protocol.hpp"

/// Protocol files: TOML text <-> Protocol. What a file may say, key by key:
/// protocols/file/keys.hpp.
namespace palpate::protocols {

/// Reads a protocol. Past this door every value has the right type, is finite and in its range, and
/// the values fit together: names are unique, curves and start pose possible, run limits feasible.
///
/// Problems are found in three stages: TOML syntax (stops at the first), then keys, types and
/// ranges (all of them), then what holds across keys (all of them). A stage is reached without a
/// problem in the one before it.
///
/// @param file_name  for messages only
/// @throws ProtocolError
[[nodiscard]] Protocol parse_protocol(std::string_view text, std::string_view file_name);

/// parse_protocol() of a text that a database keeps.
[[nodiscard]] Protocol stored_protocol(std::string_view text);

/// The canonical text: every key, in the order of the key table, numbers as short as they can be
/// without changing the value. Sets of objects are written out.
///
/// parse_protocol(to_toml(p)) == p for every p that was read from a file. Lengths and times are in
/// mm and ms there: of the doubles in metres, about one in 40 is no quotient of a double by 1000,
/// and is written as its nearest neighbour.
[[nodiscard]] std::string to_toml(const Protocol& protocol);

/// SHA-256 of the canonical text: comments, spelling of numbers and order of keys do not matter.
[[nodiscard]] std::string protocol_hash(const Protocol& protocol);

/// What differs between two canonical texts (to_toml()), key by key: "friction.rough mu_d 0.4
/// there, 0.1 here". Tables of a list are known by their name, or by their number. In the order of
/// `there`, then what only `here` has.
[[nodiscard]] std::vector<std::string> differences(std::string_view there, std::string_view here);
/// The first six in one line, and how many more there are.
[[nodiscard]] std::string differences_text(std::string_view there, std::string_view here);

// -------------------------------------------------------------------------------------------------
// What files may say as JSON Schema (draft 2020-12), for editors that complete, explain and check
// each key of a TOML file by it, and for validators.

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
