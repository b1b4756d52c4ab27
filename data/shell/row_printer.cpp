#include <algorithm>
#include <cmath>
#include <ranges>
#include <set>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <unistd.h>

#include "engine/base/text.hpp"
#include "data/csv/csv_text.hpp"
#include "data/csv/json_text.hpp"
#include "data/shell/sql_shell.hpp"

namespace palpate::data {
namespace {

/// Rows of a table that decide how wide its columns are.
constexpr std::size_t kLookedAt = 1000;
constexpr std::size_t kHeldBytes = 16'000'000;  ///< or so much of rows
constexpr std::size_t kWidestCell = 1000;       ///< characters of a table's cell

std::string hexadecimal(std::span<const std::byte> bytes) {
    const auto* first = reinterpret_cast<const unsigned char*>(bytes.data());
    return fmt::format("{:02X}", fmt::join(first, first + bytes.size(), ""));
}

std::string bare(const ColumnValue& cell) {
    struct Visitor {
        std::string operator()(std::monostate) const { return {}; }
        std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
        std::string operator()(double value) const { return fmt::format("{}", value); }
        std::string operator()(const std::string& text) const { return text; }
        std::string operator()(std::span<const std::byte> bytes) const {
            return hexadecimal(bytes);
        }
    };
    return std::visit(Visitor{}, cell);
}

bool is_number(const ColumnValue& cell) {
    return std::holds_alternative<std::int64_t>(cell) || std::holds_alternative<double>(cell);
}

/// Characters, not bytes.
std::size_t width_of(std::string_view text) {
    return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
        return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
    }));
}

/// A text or blob of a table as its beginning and an ellipsis. @return bytes
std::size_t cut(ColumnValue& cell) {
    if (const auto* blob = std::get_if<std::span<const std::byte>>(&cell)) {
        const bool longer = 2 * blob->size() > kWidestCell;
        std::string text = hexadecimal(blob->first(std::min(blob->size(), kWidestCell / 2)));
        cell = longer ? text + "…" : std::move(text);
    } else if (auto* text = std::get_if<std::string>(&cell);
               text != nullptr && text->size() > kWidestCell) {
        std::size_t end = 0;
        for (std::size_t i = 0; i < kWidestCell && end < text->size(); ++i) {
            end += std::max<std::size_t>(utf8_length(std::string_view(*text).substr(end)), 1);
        }
        cell = end < text->size() ? text->substr(0, end) + "…" : *text;
    }
    const auto* text = std::get_if<std::string>(&cell);
    return sizeof cell + (text == nullptr ? 0 : text->size());
}

std::string csv_of(const ColumnValue& cell) {
    const auto* text = std::get_if<std::string>(&cell);
    return text == nullptr ? bare(cell) : csv_field(*text);
}

std::string json_value(const ColumnValue& cell) {
    if (const auto* real = std::get_if<double>(&cell)) {
        return std::isnan(*real) ? "null"
             : std::isinf(*real) ? (*real > 0.0 ? "1e999" : "-1e999")
                                 : fmt::format("{}", *real);
    }
    if (std::holds_alternative<std::monostate>(cell)) {
        return "null";
    }
    return is_number(cell) ? bare(cell) : json_string(bare(cell));
}

/// An object's keys differ: of columns of one name the second is NAME_2.
std::vector<std::string> keys_of(std::vector<std::string> names) {
    const std::set<std::string> asked(names.begin(), names.end());
    std::set<std::string> given;
    for (std::string& name : names) {
        const std::string stem = name;
        for (int number = 2; given.contains(name) || (name != stem && asked.contains(name));
             ++number) {
            name = fmt::format("{}_{}", stem, number);
        }
        given.insert(name);
    }
    return names;
}

}  // namespace

RowPrinter::RowPrinter(std::FILE* out, RowFormat format, std::vector<std::string> names)
    : out_(out),
      format_(format),
      names_(format == RowFormat::json ? keys_of(std::move(names)) : std::move(names)) {
    if (format_ == RowFormat::csv) {
        fmt::print(out_, "{}\n", fmt::join(std::views::transform(names_, csv_field), ","));
    }
}

void RowPrinter::row(std::vector<ColumnValue> cells) {
    ++rows_;
    if (format_ == RowFormat::csv) {
        const auto line = fmt::format("{}", fmt::join(std::views::transform(cells, csv_of), ","));
        const bool looked_at =
            isatty(fileno(out_)) != 0;  // a program gets every byte, a person none that acts
        fmt::print(out_, "{}\n", looked_at ? plain(line, Lines::kept) : line);
    } else if (format_ == RowFormat::json) {
        print_json_row(cells);
    } else {
        table_row(std::move(cells));
    }
}

void RowPrinter::table_row(std::vector<ColumnValue> cells) {
    for (ColumnValue& cell : cells) {
        held_ += cut(cell);
    }
    if (head_printed_) {
        print_table_row(cells);
    } else {
        waiting_.push_back(std::move(cells));
        if (waiting_.size() == kLookedAt || held_ > kHeldBytes) {
            print_table_rows();
        }
    }
}

void RowPrinter::end() {
    if (format_ == RowFormat::json) {
        fmt::print(out_, "{}]\n", rows_ == 0 ? "[" : "");
    } else if (format_ == RowFormat::table && !head_printed_) {
        print_table_rows();
    }
}

void RowPrinter::print_table_rows() {
    head_printed_ = true;
    widths_.resize(names_.size());
    for (std::size_t i = 0; i < names_.size(); ++i) {
        widths_[i] = width_of(plain(names_[i]));
        for (const auto& cells : waiting_) {
            widths_[i] = std::max(widths_[i], width_of(plain(bare(cells[i]))));
        }
    }
    std::vector<ColumnValue> head(names_.begin(), names_.end());
    std::vector<ColumnValue> line;
    for (const std::size_t width : widths_) {
        line.emplace_back(std::string(width, '-'));
    }
    print_table_row(head);
    print_table_row(line);
    for (const auto& cells : std::exchange(waiting_, {})) {
        print_table_row(cells);
    }
}

void RowPrinter::print_table_row(const std::vector<ColumnValue>& cells) const {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const std::string text = plain(bare(cells[i]));
        const std::size_t width = width_of(text);
        const std::string space(widths_[i] > width ? widths_[i] - width : 0, ' ');
        line += i > 0 ? "  " : "";
        line += is_number(cells[i]) ? space + text : text + space;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    fmt::print(out_, "{}\n", line);
}

void RowPrinter::print_json_row(const std::vector<ColumnValue>& cells) {
    std::string text = rows_ == 1 ? "[{" : ",\n{";
    for (std::size_t i = 0; i < cells.size(); ++i) {
        text += fmt::format("{}{}: {}", i > 0 ? ", " : "", json_string(names_[i]),
                            json_value(cells[i]));
    }
    fmt::print(out_, "{}}}", text);
}

}  // namespace palpate::data
