#pragma once

#include <span>
#include <string_view>

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

/// left, right or both: as run tells the clear from the unclear.
inline constexpr std::string_view kHandednessSql =
    "CASE WHEN participant.handedness <= -40 THEN 'left' WHEN participant.handedness >= 40 THEN"
    " 'right' WHEN participant.handedness IS NOT NULL THEN 'both' END";

/// What is exported, whatever the format. The SQL reads the tables of a Selection beside the file's own.
[[nodiscard]] std::span<const ExportTable> export_tables() noexcept;
[[nodiscard]] const ExportTable& export_table(std::string_view name);

/// What a row of ticks begins with: whose they are. The sql is not used.
[[nodiscard]] std::span<const ExportColumn> tick_keys() noexcept;

}  // namespace palpate::data
