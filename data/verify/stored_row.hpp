#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "data/store/database.hpp"

namespace palpate::data {

/// A value as SQLite gave it. No value: NULL, or a column that the file does not have.
using Value = std::variant<std::monostate, std::int64_t, double, std::string>;

/// Whatever columns the file's schema has, by name.
class StoredRow {
public:
    /// A later value replaces an earlier one.
    void set(std::string_view column, Value value) {
        values_.insert_or_assign(std::string(column), std::move(value));
    }
    /// No value for a column that the file does not have: as for NULL.
    [[nodiscard]] const Value& at(std::string_view column) const;
    [[nodiscard]] bool null(std::string_view column) const;
    /// 0 or "" for a value of another type: SQLite's own types are checked by STRICT.
    [[nodiscard]] std::int64_t integer(std::string_view column) const;
    [[nodiscard]] double real(std::string_view column) const;
    [[nodiscard]] std::string text(std::string_view column) const;

private:
    std::map<std::string, Value, std::less<>> values_;
};

/// @param sql  with ?1 for `id`
[[nodiscard]] std::vector<StoredRow> rows_of(Database& database,
                                             std::string_view sql,
                                             std::optional<std::int64_t> id = std::nullopt);

/// "NULL", the number as short as it can be, or the text in quotes.
[[nodiscard]] std::string to_text(const Value& value);

/// As SQLite keeps them: a NaN is NULL, -0.0 is 0.
[[nodiscard]] bool same(const Value& stored, const Value& recomputed) noexcept;

}  // namespace palpate::data
