#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

#include "data/csv/number_table.hpp"
#include "data/csv/rereadable_text.hpp"

namespace palpate::data {

/// parse_numbers() row by row, for what is longer than the memory: some 100 KiB of it are held.
class NumberRows {
public:
    /// Reads the head. @throws CsvError as parse_numbers() does, as next() does
    NumberRows(const RereadableText& text, std::span<const std::string_view> wanted);
    ~NumberRows();
    NumberRows(const NumberRows&) = delete;
    NumberRows& operator=(const NumberRows&) = delete;

    /// Reads the next row. @return false at the end
    [[nodiscard]] bool next();
    /// Its value in column `column` of `wanted`. @pre next()
    [[nodiscard]] double at(std::size_t column) const;
    /// Line of the file in which it stands, from 1.
    [[nodiscard]] std::size_t line() const;

private:
    struct Source;
    std::unique_ptr<Source> source_;
};

}  // namespace palpate::data
