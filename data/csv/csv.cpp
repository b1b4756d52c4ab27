#include "data/csv/csv.hpp"

#include <cmath>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "data/csv/csv_text.hpp"

namespace palpate::data {
std::string csv(std::span<const CsvColumn> columns) {
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
        text += csv_field(column.name);
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

void write_csv(const std::filesystem::path& path, std::span<const CsvColumn> columns) {
    write_whole(path, csv(columns));
}

}  // namespace palpate::data
