#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpate::data {

struct ColumnManual {
    std::string name;
    std::string unit;     ///< by the end of its name; "-": a text, a count, a share, a code
    std::string meaning;  ///< the comment beside it
};

struct TableManual {
    std::string name;
    std::string meaning;  ///< the comment above its columns
    std::vector<ColumnManual> columns;
};

/// The manual of a schema, from the comments in its CREATE TABLE and CREATE VIEW statements: a comment at
/// the end of a line belongs to the column that ends or goes on there, one above the first column to the
/// table. Text that is no such statement is passed over.
[[nodiscard]] std::vector<TableManual> schema_manual(std::string_view sql);

/// SI unit by the end of a column's name: "m/s" for vx_m_per_s. "-" without one.
[[nodiscard]] std::string_view unit_of(std::string_view column) noexcept;

}  // namespace palpate::data
