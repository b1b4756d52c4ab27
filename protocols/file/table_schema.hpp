#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocols/file/schema.hpp"

/// Private to protocols/file: rows of keys as JSON Schema, in text.
namespace palpate::protocols {

/// Members of a JSON object in their order: names, and values as JSON.
using Members = std::vector<std::pair<std::string, std::string>>;

[[nodiscard]] std::string json_object(const Members& members);
/// Words as a JSON array of strings.
[[nodiscard]] std::string json_words(const std::vector<std::string_view>& words);
/// `then` and `otherwise` are schemas; "" for none.
[[nodiscard]] std::string json_when(const std::string& condition,
                                    const std::string& then,
                                    const std::string& otherwise = {});
/// Schema of an array of such items. @param most  0: any number
[[nodiscard]] std::string json_list(const std::string& item, std::size_t least, std::size_t most);

/// Schemas of a table in which these keys have to be, and must not be.
[[nodiscard]] std::string needs_all(const std::vector<std::string_view>& keys);
[[nodiscard]] std::string has_none(const std::vector<std::string_view>& keys);
[[nodiscard]] std::string needs_and_lacks(const std::vector<std::string_view>& needed,
                                          const std::vector<std::string_view>& refused);
/// Of a table whose key is one of these words. @param or_none  also if it is left out
[[nodiscard]] std::string says(std::string_view key,
                               const std::vector<std::string_view>& words,
                               bool or_none = false);

[[nodiscard]] std::vector<std::string_view> names_of(Keys keys);
/// Those of them that have to be there.
[[nodiscard]] std::vector<std::string_view> required_of(Keys keys);

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
    TableSchema& among(std::string_view name, const std::vector<std::string_view>& words);
    /// Another schema that holds for the table as well.
    TableSchema& rule(std::string schema);

    /// Keys that were not named are refused. @param first  members before its own
    [[nodiscard]] std::string text(const Members& first = {}) const;

private:
    struct Property {
        std::string name{};
        Members schema{};
        std::string whole{};  ///< instead: JSON as it stands
    };
    Property& property(std::string_view name);

    std::vector<Property> properties_;
    std::vector<std::string_view> required_;
    std::vector<std::string> rules_;
};

}  // namespace palpate::protocols
