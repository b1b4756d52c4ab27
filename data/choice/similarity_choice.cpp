#include "data/choice/similarity_choice.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>

#include "engine/base/refuse.hpp"
#include "data/statistics/solve.hpp"

namespace palpate::data {
namespace {

constexpr double kResidual = 1e-10;
constexpr int kMaxRounds = 100000;

using Numbers = std::vector<std::vector<double>>;

struct Margins {
    std::vector<double> rows;
    std::vector<double> columns;

    explicit Margins(std::size_t m) : rows(m), columns(m) {}
    /// @param cell  the number in row i and column j
    template <class Cell>
    void sum(const Cell& cell) {
        std::ranges::fill(rows, 0.0);
        std::ranges::fill(columns, 0.0);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            for (std::size_t j = 0; j < rows.size(); ++j) {
                const double one = cell(i, j);
                rows[i] += one;
                columns[j] += one;
            }
        }
    }
};

/// Factors of the expected table a_i b_j s_ij, s symmetric.
struct Factors {
    std::vector<double> row;
    std::vector<double> column;
    Numbers pair;

    explicit Factors(std::size_t m)
        : row(m, 1.0), column(m, 1.0), pair(m, std::vector<double>(m, 1.0)) {}

    [[nodiscard]] double at(std::size_t i, std::size_t j) const {
        return row[i] * column[j] * pair[i][j];
    }
};

double ratio(double wanted, double is) {
    return is > 0.0 ? wanted / is : 0.0;
}

/// One round of matching. @return the largest difference before it
/// @param now  room for the margins there
double match(Factors& f, const Numbers& counts, const Margins& wanted, Margins& now) {
    const std::size_t m = counts.size();
    const auto cell = [&f](std::size_t i, std::size_t j) {
        return f.at(i, j);
    };
    double worst = 0.0;
    now.sum(cell);
    for (std::size_t i = 0; i < m; ++i) {
        worst = std::max({worst, std::fabs(now.rows[i] - wanted.rows[i]),
                          std::fabs(now.columns[i] - wanted.columns[i])});
        f.row[i] *= ratio(wanted.rows[i], now.rows[i]);
    }
    now.sum(cell);
    for (std::size_t j = 0; j < m; ++j) {
        f.column[j] *= ratio(wanted.columns[j], now.columns[j]);
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

Numbers as_numbers(const CallCounts& counts) {
    Numbers table;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        refuse_if(counts[i].size() != counts.size(),
                  "the similarity choice model needs the same items and responses");
        table.emplace_back(counts[i].begin(), counts[i].end());
        refuse_if(counts[i][i] == 0,
                  "item {} was never called by its name: its similarities are unbounded", i + 1);
    }
    return table;
}

/// The likelihood with one similarity held, by Newton's steps: P(j | i) is a softmax of ln bias_j +
/// ln similarity_ij, concave in both. Pairs that were never confused, but for the one that is held,
/// have a similarity of 0.
class HeldPair {
public:
    HeldPair(const Numbers& counts, std::size_t one, std::size_t other)
        : counts_(counts), place_(counts.size(), std::vector<int>(counts.size(), kNone)) {
        const std::size_t m = counts.size();
        size_ = static_cast<int>(m) - 1;  // ln bias of all but the first
        for (std::size_t i = 0; i < m; ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                const bool held = (i == one && j == other) || (i == other && j == one);
                const bool never = counts[i][j] + counts[j][i] == 0.0;
                place_[i][j] = place_[j][i] = held ? kHeld : never ? kNever : size_;
                size_ += held || never ? 0 : 1;
            }
        }
        at_.assign(width(), 0.0);
    }

    /// The highest log-likelihood. The next one is looked for from where this one was.
    double best(double log_similarity) {
        held_ = log_similarity;
        double value = derivatives(at_);
        for (int step = 0; step < 200; ++step) {
            std::vector<double> move = solve_symmetric(raised(), gradient_);
            const double gain =
                std::inner_product(move.begin(), move.end(), gradient_.begin(), 0.0);
            if (!(gain > 1e-11)) {
                break;
            }
            std::vector<double> next = sum_of(at_, move);
            double there = derivatives(next);
            for (int half = 0; half < 40 && !(there >= value); ++half) {
                for (double& one : move) {
                    one *= 0.5;
                }
                next = sum_of(at_, move);
                there = derivatives(next);
            }
            if (!(there >= value)) {
                static_cast<void>(derivatives(at_));
                break;
            }
            at_ = std::move(next);
            value = there;
        }
        return value;
    }

private:
    static constexpr int kNone = -1;  ///< the diagonal: similarity 1
    static constexpr int kHeld = -2;
    static constexpr int kNever = -3;

    [[nodiscard]] std::size_t width() const { return static_cast<std::size_t>(size_); }

    static std::vector<double> sum_of(std::vector<double> a, const std::vector<double>& b) {
        std::ranges::transform(a, b, a.begin(), std::plus<>());
        return a;
    }

    /// The information with a little on its diagonal: also of what no answer tells it has an
    /// inverse.
    [[nodiscard]] std::vector<double> raised() const {
        const std::size_t n = width();
        double trace = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            trace += information_[i * n + i];
        }
        std::vector<double> all = information_;
        for (std::size_t i = 0; i < n; ++i) {
            all[i * n + i] += 1e-11 * (1.0 + trace);
        }
        return all;
    }

    double derivatives(const std::vector<double>& at) {
        const std::size_t n = width();
        gradient_.assign(n, 0.0);
        information_.assign(n * n, 0.0);
        const std::size_t m = counts_.size();
        double sum = 0.0;
        std::vector<double> weights(m);
        for (std::size_t i = 0; i < m; ++i) {
            double answers = 0.0;
            double largest = -std::numeric_limits<double>::infinity();
            for (std::size_t j = 0; j < m; ++j) {
                const int pair = place_[i][j];
                weights[j] = (j > 0 ? at[j - 1] : 0.0) +
                             (pair >= 0        ? at[static_cast<std::size_t>(pair)]
                              : pair == kHeld  ? held_
                              : pair == kNever ? -std::numeric_limits<double>::infinity()
                                               : 0.0);
                largest = std::max(largest, weights[j]);
                answers += counts_[i][j];
            }
            double total = 0.0;
            for (double& weight : weights) {
                weight = std::exp(weight - largest);
                total += weight;
            }
            std::vector<double> mean(n);
            for (std::size_t j = 0; j < m; ++j) {
                const double p = weights[j] / total;
                sum += counts_[i][j] > 0.0 ? counts_[i][j] * std::log(p) : 0.0;
                for_each(i, j, [&](std::size_t a) {
                    gradient_[a] += counts_[i][j] - answers * p;
                    mean[a] += p;
                    for_each(i, j, [&](std::size_t b) { information_[a * n + b] += answers * p; });
                });
            }
            for (std::size_t a = 0; a < n; ++a) {
                for (std::size_t b = 0; b < n; ++b) {
                    information_[a * n + b] -= mean[a] * (answers * mean[b]);
                }
            }
        }
        return std::isfinite(sum) ? sum : -std::numeric_limits<double>::infinity();
    }

    /// The parameters of a cell.
    template <class Do>
    void for_each(std::size_t i, std::size_t j, const Do& what) const {
        if (j > 0) {
            what(j - 1);
        }
        if (place_[i][j] >= 0) {
            what(static_cast<std::size_t>(place_[i][j]));
        }
    }

    const Numbers& counts_;
    std::vector<std::vector<int>> place_;
    int size_ = 0;
    double held_ = 0.0;
    std::vector<double> at_{};
    std::vector<double> gradient_{};
    std::vector<double> information_{};  ///< row by row
};

/// Where the loss against `top` is that of 95 %, from `start` towards `end`; nothing if it never
/// is.
std::optional<double> edge(HeldPair& profile, double top, double start, double end) {
    constexpr double kLoss = 1.920729410347062;  // half the 95 % point of chi-square of 1 df
    const double sign = end < start ? -1.0 : 1.0;
    double near = start;
    double far = start;
    for (double way = 0.5; top - profile.best(far) < kLoss; way *= 1.5) {
        if (far == end) {
            return std::nullopt;
        }
        near = far;
        far = sign * std::min(sign * start + way, sign * end);
    }
    while (std::fabs(far - near) > 1e-7) {
        const double middle = 0.5 * (near + far);
        (top - profile.best(middle) < kLoss ? near : far) = middle;
    }
    return 0.5 * (near + far);
}

void add_intervals(SimilarityFit& fit, const Numbers& table) {
    constexpr double kMin = -20.0;  // ln 2e-9
    constexpr double kMax = 14.0;   // ln 1e6
    const std::size_t m = table.size();
    fit.intervals.assign(m, std::vector<Interval>(m, Interval{1.0, 1.0}));
    for (std::size_t i = 0; i < m; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            HeldPair profile(table, i, j);
            const double similarity = fit.similarity[i][j];
            const double start =
                similarity > 0.0 ? std::clamp(std::log(similarity), kMin, kMax) : kMin;
            const auto low = edge(profile, fit.log_likelihood, start, kMin);
            HeldPair upward(table, i, j);
            const auto high = edge(upward, fit.log_likelihood, start, kMax);
            fit.intervals[i][j] = fit.intervals[j][i] = {
                low ? std::exp(*low) : 0.0,
                high ? std::exp(*high) : std::numeric_limits<double>::infinity()};
            if (!low && table[i][j] + table[j][i] > 0.0) {  // matching comes near it for ever
                fit.similarity[i][j] = fit.similarity[j][i] = 0.0;
                fit.one_way.emplace_back(j, i);
            }
        }
    }
}

}  // namespace

SimilarityFit fit_similarity(const CallCounts& counts) {
    const Numbers table = as_numbers(counts);
    const std::size_t m = table.size();
    Margins wanted(m);
    wanted.sum([&table](std::size_t i, std::size_t j) { return table[i][j]; });
    Margins now(m);
    Factors f(m);
    SimilarityFit fit;
    for (int round = 0; round < kMaxRounds; ++round) {
        fit.residual = match(f, table, wanted, now);
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
    add_intervals(fit, table);
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
