#include "data/choice/similarity_choice.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace palpate::data {
namespace {

constexpr double kResidual = 1e-10;
constexpr int kMostRounds = 100000;

using Table = std::vector<std::vector<double>>;

struct Margins {
    std::vector<double> rows;
    std::vector<double> columns;
};

Margins margins_of(const Table& table) {
    Margins sums{std::vector<double>(table.size()), std::vector<double>(table.size())};
    for (std::size_t i = 0; i < table.size(); ++i) {
        for (std::size_t j = 0; j < table.size(); ++j) {
            sums.rows[i] += table[i][j];
            sums.columns[j] += table[i][j];
        }
    }
    return sums;
}

/// Factors of the expected table a_i b_j s_ij, s symmetric.
struct Factors {
    std::vector<double> row;
    std::vector<double> column;
    Table pair;

    explicit Factors(std::size_t m)
        : row(m, 1.0), column(m, 1.0), pair(m, std::vector<double>(m, 1.0)) {}

    [[nodiscard]] double at(std::size_t i, std::size_t j) const {
        return row[i] * column[j] * pair[i][j];
    }
    [[nodiscard]] Table table() const {
        Table all(row.size(), std::vector<double>(row.size()));
        for (std::size_t i = 0; i < row.size(); ++i) {
            for (std::size_t j = 0; j < row.size(); ++j) {
                all[i][j] = at(i, j);
            }
        }
        return all;
    }
};

double ratio(double wanted, double is) {
    return is > 0.0 ? wanted / is : 0.0;
}

/// One round of matching. @return the largest difference before it
double match(Factors& f, const Table& counts, const Margins& wanted) {
    const std::size_t m = counts.size();
    double worst = 0.0;
    const Margins now = margins_of(f.table());
    for (std::size_t i = 0; i < m; ++i) {
        worst = std::max({worst, std::fabs(now.rows[i] - wanted.rows[i]),
                          std::fabs(now.columns[i] - wanted.columns[i])});
        f.row[i] *= ratio(wanted.rows[i], now.rows[i]);
    }
    const Margins next = margins_of(f.table());
    for (std::size_t j = 0; j < m; ++j) {
        f.column[j] *= ratio(wanted.columns[j], next.columns[j]);
    }
    for (std::size_t i = 0; i < m; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            const double both = counts[i][j] + counts[j][i];
            const double is = f.at(i, j) + f.at(j, i);
            f.pair[i][j] *= ratio(both, is);
            f.pair[j][i] = f.pair[i][j];
        }
    }
    return worst;
}

Table as_numbers(const CallCounts& counts) {
    Table table;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (counts[i].size() != counts.size()) {
            throw std::invalid_argument(
                "the similarity choice model needs the same items and responses");
        }
        table.emplace_back(counts[i].begin(), counts[i].end());
        if (counts[i][i] == 0) {
            throw std::invalid_argument(fmt::format(
                "item {} was never called by its name: the similarity choice model has no maximum "
                "there",
                i + 1));
        }
    }
    return table;
}

}  // namespace

SimilarityFit fit_similarity(const CallCounts& counts) {
    const Table table = as_numbers(counts);
    const std::size_t m = table.size();
    const Margins wanted = margins_of(table);
    Factors f(m);
    SimilarityFit fit;
    for (int round = 0; round < kMostRounds; ++round) {
        fit.residual = match(f, table, wanted);
        if (fit.residual < kResidual) {
            break;
        }
    }
    fit.similarity.assign(m, std::vector<double>(m, 1.0));
    double total = 0.0;
    for (std::size_t j = 0; j < m; ++j) {
        fit.bias.push_back(f.column[j] * std::sqrt(f.pair[j][j]));
        total += fit.bias.back();
    }
    double saturated = 0.0;
    for (std::size_t i = 0; i < m; ++i) {
        fit.bias[i] /= total;
        for (std::size_t j = 0; j < m; ++j) {
            fit.similarity[i][j] = f.pair[i][j] / std::sqrt(f.pair[i][i] * f.pair[j][j]);
            if (table[i][j] > 0.0) {
                fit.log_likelihood += table[i][j] * std::log(f.at(i, j) / wanted.rows[i]);
                saturated += table[i][j] * std::log(table[i][j] / wanted.rows[i]);
            }
        }
    }
    fit.deviance = std::max(2.0 * (saturated - fit.log_likelihood), 0.0);
    fit.df = static_cast<std::int64_t>((m - 1) * (m - 2) / 2);
    return fit;
}

double mean_similarity(const SimilarityFit& fit) {
    double sum = 0.0;
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < fit.similarity.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j, ++pairs) {
            sum += fit.similarity[i][j];
        }
    }
    return pairs > 0 ? sum / static_cast<double>(pairs) : 0.0;
}

}  // namespace palpate::data
