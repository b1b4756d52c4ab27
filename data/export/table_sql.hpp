#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "data/export/tables.hpp"

/// How the tables of an export are asked for, and what is said of their columns.
namespace palpate::data {

/// The words that may stand in a column, and what each means; none where any text or number may.
[[nodiscard]] std::vector<std::pair<std::string_view, std::string_view>> levels_of(
    const ExportColumn& column);

/// The columns of a table that a reader may see.
[[nodiscard]] std::vector<ExportColumn> visible_columns(const ExportTable& table, bool details);

/// SELECT of these columns. @param where  of one session, e.g. "chosen.session = ?1"; empty: all
[[nodiscard]] std::string select_sql(const ExportTable& table,
                                     std::span<const ExportColumn> columns,
                                     std::string_view where = {});

}  // namespace palpate::data
