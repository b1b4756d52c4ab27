#include "data/export/table_sql.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace palpate::data {

std::vector<std::pair<std::string_view, std::string_view>> levels_of(const ExportColumn& column) {
    std::vector<std::pair<std::string_view, std::string_view>> levels;
    for (std::string_view left(column.levels); !left.empty();) {
        const std::string_view one = left.substr(0, left.find("; "));
        left.remove_prefix(std::min(one.size() + 2, left.size()));
        const std::size_t sign = one.find(" = ");
        levels.emplace_back(one.substr(0, sign), one.substr(sign + 3));
    }
    return levels;
}

std::vector<ExportColumn> visible_columns(const ExportTable& table, bool details) {
    std::vector<ExportColumn> columns;
    for (const ExportColumn& column : table.columns) {
        if (details || !column.detail) {
            columns.push_back(column);
        }
    }
    return columns;
}

std::string select_sql(const ExportTable& table,
                       std::span<const ExportColumn> columns,
                       std::string_view where) {
    std::string names;
    for (const ExportColumn& column : columns) {
        names += fmt::format("{}{} AS {}", names.empty() ? "" : ", ", column.sql, column.name);
    }
    const std::size_t group = std::min(table.from.find(" GROUP BY "), table.from.size());
    return fmt::format("SELECT {} FROM {}{}{}{} ORDER BY {}", names, table.from.substr(0, group),
                       where.empty() ? "" : " WHERE ", where, table.from.substr(group),
                       table.order);
}

}  // namespace palpate::data
