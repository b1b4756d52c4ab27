#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "data/csv/csv_text.hpp"
#include "data/csv/number_table.hpp"
#include "data/fit/fit_report.hpp"

namespace palpate::data {
namespace {

constexpr double kMaxAnswers = 1e6;

}  // namespace

std::vector<Answers> read_answers(const std::filesystem::path& file) {
    constexpr std::array<std::string_view, 3> kWanted{"stimulus", "n", "k"};
    constexpr std::array<std::string_view, 2> kTexts{"participant", "condition"};
    const NumberTable table = read_numbers(file, kWanted, {}, kTexts);
    const auto refuse = [&](std::size_t row, std::size_t column, const std::string& remedy) {
        throw CsvError(fmt::format("{}:{}: {} is {}: {}", file.string(), table.place(row, column),
                                   kWanted.at(column), table.at(row, column), remedy));
    };
    std::vector<Answers> all;
    for (std::size_t row = 0; row < table.rows(); ++row) {
        const double n = table.at(row, 1);
        const double k = table.at(row, 2);
        if (!(n >= 0.0 && n <= kMaxAnswers) || n != std::floor(n)) {
            refuse(row, 1,
                   "give how many answers there are, a whole number from 0 to 1000000 (1 where a "
                   "row is a trial)");
        }
        if (!(k >= 0.0 && k <= n) || k != std::floor(k)) {
            refuse(row, 2,
                   fmt::format("give how many of the n = {} answers were 1 (yes, correct, the "
                               "comparison), a whole number from 0 to {}",
                               n, n));
        }
        const std::string participant{without_mark(table.text(row, "participant").value_or(""))};
        const std::string condition{without_mark(table.text(row, "condition").value_or(""))};
        auto found = std::ranges::find_if(all, [&](const Answers& one) {
            return one.participant == participant && one.condition == condition;
        });
        if (found == all.end()) {
            all.push_back({.participant = participant, .condition = condition});
            found = all.end() - 1;
        }
        found->levels.push_back(
            {table.at(row, 0), static_cast<std::int64_t>(n), static_cast<std::int64_t>(k)});
    }
    if (all.empty()) {
        throw CsvError(
            fmt::format("{}: there is no row below the head: give stimulus,n,k, a row a stimulus",
                        file.string()));
    }
    return all;
}

}  // namespace palpate::data
