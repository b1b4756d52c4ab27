#pragma once

#include <filesystem>
#include <string>
#include <string_view>

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

/// parse_protocol() of a text that a database keeps: what was let in when its session began stays
/// readable, so that rules of taste which came later (a rule that may choose the standard itself)
/// do not apply.
[[nodiscard]] Protocol stored_protocol(std::string_view text);

/// parse_protocol of a file's text. @throws ProtocolError also if the file cannot be read
[[nodiscard]] Protocol load_protocol(const std::filesystem::path& file);

/// The canonical text: every key, in the order of the key table, numbers as short as they can be
/// without changing the value. Sets of objects are written out.
///
/// parse_protocol(to_toml(p)) == p for every p that was read from a file. Lengths and times are in
/// mm and ms there: of the doubles in metres, about one in 40 is no quotient of a double by 1000,
/// and is written as its nearest neighbour.
[[nodiscard]] std::string to_toml(const Protocol& protocol);

/// SHA-256 of the canonical text: comments, spelling of numbers and order of keys do not matter.
[[nodiscard]] std::string protocol_hash(const Protocol& protocol);

}  // namespace palpate::protocols
