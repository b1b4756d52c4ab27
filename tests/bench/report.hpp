#pragma once

#include <iosfwd>

#include "tests/bench/errors.hpp"
#include "tests/bench/timing.hpp"

namespace palpate::bench {

/// One method on one path.
struct Row {
    std::string machine;  ///< machine()
    std::string object;   ///< "A"
    std::string path;     ///< "-3..+3 mm"
    std::string method;
    Kind kind = Kind::floor;
    Timing time{};
    Errors error{};  ///< none for Kind::floor
};

/// What printf makes of it, up to 511 letters.
[[nodiscard, gnu::format(printf, 1, 2)]] std::string printed(const char* format, ...);
/// Processor, number of its cores, compiler: a time means nothing without.
[[nodiscard]] std::string machine();
[[nodiscard]] const char* name_of(Kind kind);

/// Columns that people read: one table an object and path.
void print_table(std::ostream& out, const std::vector<Row>& rows);
/// One line a row, SI units and ns in the names of the columns.
void write_csv(std::ostream& out, std::vector<Row> rows);
/// What write_csv wrote. @throws std::runtime_error for a line that it would not write
[[nodiscard]] std::vector<Row> read_csv(std::istream& in);
/// Run time against error of every row, log-log, one panel an object and path, as SVG.
[[nodiscard]] std::string picture(std::span<const Row> rows);

}  // namespace palpate::bench
