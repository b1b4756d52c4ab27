#pragma once

#include "data/csv/csv_text.hpp"
#include "tests/support/std.hpp"

namespace palpate::figures {

/// One column of numbers; its name holds the unit: "time_s", "force_x_n".
struct CsvColumn {
    std::string name{};
    std::vector<double> values{};
};

/// One more row, a number a column.
inline void add_row(std::vector<CsvColumn>& table, std::initializer_list<double> row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
        table.at(i).values.push_back(row.begin()[i]);
    }
}

/// Comma-separated text (RFC 4180, "\n"): a line of names, then a line a row. Each number in the
/// fewest digits that read back to the same bits; NaN is an empty field, infinities are inf and
/// -inf.
/// @throws std::invalid_argument if there is no column or their lengths differ
inline std::string csv(std::span<const CsvColumn> columns) {
    if (columns.empty()) {
        throw std::invalid_argument("a CSV text needs at least one column");
    }
    const std::size_t rows = columns.front().values.size();
    std::string text;
    for (const CsvColumn& column : columns) {
        if (column.values.size() != rows) {
            throw std::invalid_argument(
                fmt::format("column \"{}\" has {} values and \"{}\" has {}: give as many",
                            column.name, column.values.size(), columns.front().name, rows));
        }
        if (&column != columns.data()) {
            text += ',';
        }
        text += data::csv_field(column.name);
    }
    text += '\n';
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t i = 0; i < columns.size(); ++i) {
            if (i > 0) {
                text += ',';
            }
            if (const double value = columns[i].values[row]; !std::isnan(value)) {
                fmt::format_to(std::back_inserter(text), "{}", value);
            }
        }
        text += '\n';
    }
    return text;
}

}  // namespace palpate::figures
