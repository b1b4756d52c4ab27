#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "protocols/file/schema.hpp"

/// Private to protocols/file: rows of keys as JSON Schema.
namespace palpate::protocols {

/// A schema; members stay in their order.
using Json = nlohmann::ordered_json;
using Names = std::vector<std::string_view>;

/// What holds by a condition; all three are schemas.
[[nodiscard]] Json json_when(Json condition, Json then, Json otherwise);
[[nodiscard]] Json json_when(Json condition, Json then);
[[nodiscard]] Json both(Json one, Json other);
/// Of an array of such items. @param max  0: any number
[[nodiscard]] Json json_list(Json item, std::size_t least = 0, std::size_t max = 0);

/// Of a table in which these keys have to be, and those must not be.
[[nodiscard]] Json needs(const Names& needed, const Names& refused = {});
/// Of a table whose key is such, or left out.
[[nodiscard]] Json where_given(std::string_view key, Json is_such);
/// Of a table whose key is one of these words. @param or_none  also if it is left out
[[nodiscard]] Json says(std::string_view key, const Names& words, bool or_none = false);

[[nodiscard]] Names names_of(Keys keys);
/// Those of them that have to be there.
[[nodiscard]] Names required_of(Keys keys);

/// The schema of a table: keys that were not named are refused.
[[nodiscard]] Json table_schema(Keys keys = {});
/// More keys of it. @param complete  required ones must be there
void add(Json& table, Keys keys, bool complete = true);
/// A key or table by its schema; a key that is there already gets it instead of its own.
void put(Json& table, std::string_view name, Json schema, bool required = false);
/// A text that is one of these words: its default and meaning stay.
void among(Json& table, std::string_view name, const Names& words);
/// Another schema that holds for the table as well.
void rule(Json& table, Json schema);

}  // namespace palpate::protocols
