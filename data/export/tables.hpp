#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate::data {

/// One column of an exported table: what it is called there, and the SQL that gives it.
struct ExportColumn {
    std::string_view name;
    std::string_view type;  ///< integer, real, text
    std::string_view unit;  ///< SI; "1" for counts and shares, "" for words
    std::string_view meaning;
    std::string_view sql;
    bool detail = false;  ///< only with details: it can tell who somebody is, when and where
    std::string_view levels =
        {};  ///< of a fixed set of words: "real = a session of the study; ..."
};

struct ExportTable {
    std::string_view name;
    std::string_view meaning;
    std::string_view from;  ///< FROM and all that follows but ORDER BY
    std::string_view order;
    std::span<const ExportColumn> columns;
    bool detail = false;  ///< the whole table only with details
};

/// What is exported, whatever the format. The SQL reads the tables of a Selection beside the file's own.
[[nodiscard]] std::span<const ExportTable> export_tables() noexcept;
[[nodiscard]] const ExportTable& export_table(std::string_view name);

/// What a row of ticks begins with: whose they are. The sql is not used.
[[nodiscard]] std::span<const ExportColumn> tick_keys() noexcept;

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
