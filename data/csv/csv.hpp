#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace palpate::data {

/// One column of numbers; its name holds the unit: "time_s", "force_x_n".
struct CsvColumn {
    std::string name{};
    std::vector<double> values{};
};

/// Comma-separated text (RFC 4180, "\n"): a line of names, then a line a row. Each number in the
/// fewest digits that read back to the same bits; NaN is an empty field, infinities are inf and
/// -inf.
/// @throws std::invalid_argument if there is no column or their lengths differ
[[nodiscard]] std::string csv(std::span<const CsvColumn> columns);

/// csv() into a file. @throws std::runtime_error if it cannot be written
void write_csv(const std::filesystem::path& path, std::span<const CsvColumn> columns);

}  // namespace palpate::data
