#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "data/store/database.hpp"

namespace palpate::data {

/// A row of a table of the catalogue, value by value with the name of its column: what is not set
/// is the column's default, or stays as it is. Every call throws std::logic_error for a column that
/// the catalogue does not have, StoreError where SQLite refuses.
class Row {
public:
    /// @param table  outlives this
    explicit Row(std::string_view table) : table_(table) {}
    /// With all columns of a query's row, by their names there; bytes are valid until its next step.
    Row(std::string_view table, const Statement& row);

    /// A later value replaces an earlier one: an integer, a real (NaN is NULL), a text, bytes that
    /// outlive the row, or nothing: NULL.
    template <class T>
    Row& set(std::string_view column, const T& value) {
        if constexpr (std::integral<T>) {
            return add(column, static_cast<std::int64_t>(value));
        } else if constexpr (std::floating_point<T>) {
            return add(column, static_cast<double>(value));
        } else if constexpr (std::same_as<T, std::monostate>) {
            return add(column, value);
        } else if constexpr (std::convertible_to<T, std::string_view>) {
            return add(column, std::string(std::string_view(value)));
        } else {
            return add(column, std::span<const std::byte>(value));
        }
    }
    template <class T>
    Row& set(std::string_view column, const std::optional<T>& value) {
        return value ? set(column, *value) : add(column, std::monostate());
    }
    template <class... T>
    Row& set(std::string_view column, const std::variant<T...>& value) {
        std::visit([&](const auto& one) { set(column, one); }, value);
        return *this;
    }

    /// Whether the table has such a column.
    [[nodiscard]] bool has(std::string_view column) const;
    /// @param conflict  e.g. "ON CONFLICT DO NOTHING"
    /// @return the number of the row
    std::int64_t insert(Database& database, std::string_view conflict = {}) const;
    /// Changes the row whose columns `keys` are as set here. @return how many rows there were
    std::int64_t update(Database& database, std::initializer_list<std::string_view> keys) const;

    [[nodiscard]] const std::string& table() const noexcept { return table_; }
    /// Columns and what was set, in that order: what verify holds a stored row against.
    [[nodiscard]] const std::vector<std::pair<std::string, ColumnValue>>& values() const noexcept {
        return values_;
    }

private:
    Row& add(std::string_view column, ColumnValue value);
    void bind(Statement& statement) const;

    std::string table_;
    std::vector<std::pair<std::string, ColumnValue>> values_;
};

}  // namespace palpate::data
