#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "protocols/file/schema.hpp"

/// Private to protocols/file: rows of keys as JSON Schema, in text.
namespace palpate::protocols {

using Names = std::vector<std::string_view>;

/// Words as a JSON array of strings.
[[nodiscard]] std::string json_words(const Names& words);
/// All these are schemas.
[[nodiscard]] std::string json_when(std::string_view condition,
                                    std::string_view then,
                                    std::string_view otherwise = "true");
[[nodiscard]] std::string both(std::string_view one, std::string_view other);
/// Schema of an array of such items. @param max  0: any number
[[nodiscard]] std::string json_list(std::string_view item,
                                    std::size_t least = 0,
                                    std::size_t max = 0);

/// Schema of a table in which these keys have to be, and those must not be.
[[nodiscard]] std::string needs(const Names& needed, const Names& refused = {});
/// Of a table whose key is such, or left out.
[[nodiscard]] std::string where_given(std::string_view key, std::string_view is_such);
/// Of a table whose key is one of these words. @param or_none  also if it is left out
[[nodiscard]] std::string says(std::string_view key, const Names& words, bool or_none = false);

[[nodiscard]] Names names_of(Keys keys);
/// Those of them that have to be there.
[[nodiscard]] Names required_of(Keys keys);

/// The schema of one table.
class TableSchema {
public:
    TableSchema() = default;
    explicit TableSchema(Keys keys) { add(keys); }

    /// @param complete  required ones must be there
    TableSchema& add(Keys keys, bool complete = true);
    /// A key or table by its schema; a key that is there already gets it instead of its own type.
    TableSchema& put(std::string_view name, std::string schema, bool required = false);
    /// A text that is one of these words: its meaning stays.
    TableSchema& among(std::string_view name, const Names& words);
    /// Another schema that holds for the table as well.
    TableSchema& rule(std::string schema);

    /// Keys that were not named are refused. @param first  members before its own
    [[nodiscard]] std::string text(std::string_view first = {}) const;

private:
    struct Property {
        std::string name{};
        std::string type{};   ///< members of its schema: what it may be
        std::string about{};  ///< and what it means
        std::string whole{};  ///< instead: JSON as it stands
    };
    Property& property(std::string_view name);

    std::vector<Property> properties_;
    Names required_;
    std::vector<std::string> rules_;
};

}  // namespace palpate::protocols
