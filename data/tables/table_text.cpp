#include <algorithm>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/csv/csv_text.hpp"
#include "data/tables/table.hpp"

namespace palpate::data {
namespace {

using Lines = std::vector<std::vector<std::string>>;

/// How far the row's first interval reaches; 0: there is none.
double scale_of(const std::vector<Cell>& row) {
    for (const Cell& cell : row) {
        if (const auto* ends = std::get_if<Interval>(&cell)) {
            return ends->high - ends->low;
        }
    }
    return 0.0;
}

std::string significant_text(double value, double scale) {
    int digits = 4;
    if (std::isfinite(value) && value != 0.0 && scale > 0.0 && std::isfinite(scale)) {
        const double more = std::ceil(std::log10(std::fabs(value))) - std::floor(std::log10(scale));
        digits = static_cast<int>(std::clamp(more + 1.0, 4.0, 15.0));
    }
    return fmt::format("{:.{}g}", value == 0.0 ? 0.0 : value, digits);
}

/// From here on decimals are none of a double's digits.
constexpr double kLarge = 1e15;

std::string number_text(double value, const Column& column, double scale) {
    if (column.says == Column::Says::significant) {
        return significant_text(value, scale);
    }
    if (std::fabs(value) >= kLarge) {
        return significant_text(value, 0.0);
    }
    if (column.says == Column::Says::p && value < 0.001) {
        return "<0.001";
    }
    const double least = 0.5 * std::pow(10.0, -column.digits);  // below it -0.00 would stand there
    return fmt::format("{:.{}f}", std::fabs(value) < least ? 0.0 : value, column.digits);
}

/// @param number  of a double
template <class Number>
std::string said(const Cell& cell, const Number& number) {
    return std::visit(
        [&](const auto& value) -> std::string {
            using Kind = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<Kind, Nothing>) {
                return value.why.empty() ? "-" : value.why;
            } else if constexpr (std::is_same_v<Kind, Named>) {
                return value.shown;
            } else if constexpr (std::is_same_v<Kind, Interval>) {
                return number(value.low) + " to " + number(value.high);
            } else if constexpr (std::is_same_v<Kind, double>) {
                return number(value);
            } else if constexpr (std::is_same_v<Kind, bool>) {
                return value ? "yes" : "no";
            } else if constexpr (std::is_same_v<Kind, std::vector<std::string>>) {
                return fmt::format("{}", fmt::join(value, ", "));
            } else {
                return fmt::format("{}", value);
            }
        },
        cell);
}

/// In the fewest digits that read back to the same bits, inf too; empty for what is no number.
std::string all_digits(double value) {
    return std::isnan(value) ? "" : fmt::format("{}", value);
}

std::string field_of(const Cell& cell) {
    return std::holds_alternative<Nothing>(cell) ? std::string() : said(cell, all_digits);
}

bool any_interval(const Table& table, std::size_t column) {
    return std::ranges::any_of(table.rows, [column](const auto& row) {
        return std::holds_alternative<Interval>(row[column]);
    });
}

/// "interval_95" is said as low and high, "wilson_95" as wilson_low and wilson_high.
std::string end_name(const std::string& key, const char* end) {
    const std::string name = key.substr(0, key.find_last_of('_'));
    return name == "interval" ? end : name + "_" + end;
}

/// Whether any row has something to say there.
bool has_value(const Table& table, std::size_t column) {
    return std::ranges::any_of(table.rows, [&](const auto& row) {
        const auto* none = std::get_if<Nothing>(&row[column]);
        return none == nullptr || !none->why.empty();
    });
}

bool is_text(const Table& table, std::size_t column) {
    return std::ranges::any_of(table.rows, [&](const auto& row) {
        return std::holds_alternative<std::string>(row[column]) ||
               std::holds_alternative<Named>(row[column]) ||
               std::holds_alternative<std::vector<std::string>>(row[column]);
    });
}

std::string text_of(const Table& table, std::size_t row, std::size_t column) {
    const Cell& cell = table.rows[row][column];
    const double scale = scale_of(table.rows[row]);
    const auto* none = std::get_if<Nothing>(&cell);
    return none != nullptr && none->why.empty() && table.columns[column].words == " "
             ? std::string()  // a column without a head says nothing of nothing
             : plain(said(cell, [&](double value) {
                   return number_text(value, table.columns[column], scale);
               }));
}

/// Heads first; what names a row and stands in the line above, as all to its left does, is not said
/// again.
Lines lines_of(const Table& table, std::vector<bool>& left) {
    Lines lines(table.rows.size() + 1);
    std::vector<bool> another(table.rows.size(), table.across);
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        if (table.columns[i].words.empty() || !has_value(table, i)) {
            continue;
        }
        left.push_back(is_text(table, i));
        lines[0].push_back(table.columns[i].words);
        std::string above;
        for (std::size_t row = 0; row < table.rows.size(); ++row) {
            std::string text = text_of(table, row, i);
            another[row] = another[row] || i + 1 >= table.index || text != above;
            above = text;
            lines[row + 1].push_back(another[row] ? std::move(text) : std::string());
        }
    }
    return lines;
}

void turn(Lines& lines, std::vector<bool>& left) {
    Lines turned(lines.front().size());
    for (const auto& line : lines) {
        for (std::size_t i = 0; i < line.size(); ++i) {
            turned[i].push_back(line[i]);
        }
    }
    lines = std::move(turned);
    left.assign(lines.front().size(), false);
    left.front() = true;
}

std::size_t characters(const std::string& text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char byte) { return (byte & 0xC0) != 0x80; }));
}

std::string aligned(const Lines& lines, const std::vector<bool>& left) {
    std::vector<std::size_t> wide(left.size(), 0);
    for (const auto& line : lines) {
        for (std::size_t i = 0; i < line.size(); ++i) {
            wide[i] = std::max(wide[i], characters(line[i]));
        }
    }
    std::string text;
    for (const auto& line : lines) {
        std::string one;
        for (std::size_t i = 0; i < line.size(); ++i) {
            one += left[i] ? fmt::format("  {:<{}}", line[i], wide[i])
                           : fmt::format("  {:>{}}", line[i], wide[i]);
        }
        text += one.substr(0, one.find_last_not_of(' ') + 1) + '\n';
    }
    return text;
}

}  // namespace

std::string table_text(const Table& table) {
    std::vector<bool> left;
    Lines lines = lines_of(table, left);
    if (left.empty() && (!table.rows.empty() || table.notes.empty())) {
        return {};
    }
    if (table.across && !left.empty()) {
        turn(lines, left);
    }
    std::string text = '\n' + table.title + (table.title.empty() ? "" : "\n");
    text += left.empty() ? std::string() : aligned(lines, left);
    for (const std::string& note : table.notes) {
        text += fmt::format("  {}\n", note);
    }
    return text;
}

Fields fields_of(const Table& table) {
    Fields fields{.names = {}, .rows = {table.rows.size(), std::vector<std::string>()}};
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        const Column& column = table.columns[i];
        if (!column.on_page || column.key.empty()) {
            continue;
        }
        const bool ends = any_interval(table, i);
        if (ends) {
            fields.names.push_back(end_name(column.key, "low"));
            fields.names.push_back(end_name(column.key, "high"));
        } else {
            fields.names.push_back(column.key.substr(column.key.find('/') + 1));
        }
        for (std::size_t row = 0; row < table.rows.size(); ++row) {
            const Cell& cell = table.rows[row][i];
            if (ends) {
                const auto* both = std::get_if<Interval>(&cell);
                fields.rows[row].push_back(both != nullptr ? all_digits(both->low) : "");
                fields.rows[row].push_back(both != nullptr ? all_digits(both->high) : "");
            } else {
                fields.rows[row].push_back(field_of(cell));
            }
        }
    }
    return fields;
}

std::string table_csv(const Fields& fields) {
    std::string csv = fmt::format("{}\n", fmt::join(fields.names, ","));
    for (const auto& row : fields.rows) {
        for (const std::string& field : row) {
            csv += &field == &row.front() ? "" : ",";
            csv += field.empty() ? field : csv_field(field);
        }
        csv += '\n';
    }
    return csv;
}

}  // namespace palpate::data
