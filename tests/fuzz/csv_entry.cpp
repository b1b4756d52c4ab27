#include <array>
#include <cmath>
#include <string_view>

#include "data/csv/number_table.hpp"
#include "tests/fuzz/entries.hpp"
#include "tests/fuzz/law.hpp"

namespace palpate::fuzz {

void read_csv(Bytes bytes) {
    constexpr std::array<std::string_view, 3> kWanted{"time_s", "hip_x_m", "hip_y_m"};
    constexpr std::array<std::string_view, 1> kOptional{"hip_z_m"};
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    try {
        const data::NumberTable table = data::parse_numbers(text, "fuzz.csv", kWanted, kOptional);
        demand(table.values.size() == table.rows() * table.columns.size(), "rows are whole");
        for (const double value : table.values) {
            demand(std::isfinite(value), "a table holds finite numbers");
        }
    } catch (const data::CsvError& refusal) {
        demand(*refusal.what() != '\0', "a refusal says why");
    }
}

}  // namespace palpate::fuzz
