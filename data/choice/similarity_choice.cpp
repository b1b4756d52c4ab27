#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>

#include "engine/base/refuse.hpp"
#include "data/choice/identification.hpp"
#include "data/statistics/solve.hpp"

namespace palpate::data {
namespace {

using Numbers = std::vector<std::vector<double>>;

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

/// The likelihood by Newton's steps: P(j | i) is a softmax of ln bias_j + ln similarity_ij, concave
/// in both. Pairs that were never confused, but for one that is held, have a similarity of 0.
class ChoiceModel {
public:
    /// @param one  with `other` the pair that is held; the number of items: none
    ChoiceModel(const Numbers& counts, std::size_t one, std::size_t other)
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
    /// @param log_similarity  of the pair that is held
    double best(double log_similarity = 0.0) {
        held_ = log_similarity;
        double value = derivatives();
        for (int step = 0; step < 200; ++step) {
            std::vector<double> move = solve_symmetric(raised(), gradient_);
            const double gain =
                std::inner_product(move.begin(), move.end(), gradient_.begin(), 0.0);
            if (!(gain >= 0.0)) {
                break;
            }
            const std::vector<double> before = at_;
            at_ = sum_of(before, move);
            double there = derivatives();
            if (gain < 1e-11) {  // the last one, by rounding alone
                return std::max(value, there);
            }
            for (int half = 0; half < 40 && !(there >= value); ++half) {
                for (double& one : move) {
                    one *= 0.5;
                }
                at_ = sum_of(before, move);
                there = derivatives();
            }
            if (!(there >= value)) {
                at_ = before;
                static_cast<void>(derivatives());
                break;
            }
            value = there;
        }
        return value;
    }

    /// Where best() was, but for the factor that all biases share.
    [[nodiscard]] double bias(std::size_t j) const { return j > 0 ? std::exp(at_[j - 1]) : 1.0; }
    [[nodiscard]] double similarity(std::size_t i, std::size_t j) const {
        return std::exp(log_similarity(i, j));
    }
    [[nodiscard]] double largest_slope() const {
        return std::fabs(*std::ranges::max_element(gradient_, {},
                                                   [](double slope) { return std::fabs(slope); }));
    }

private:
    static constexpr int kNone = -1;  ///< the diagonal: similarity 1
    static constexpr int kHeld = -2;
    static constexpr int kNever = -3;

    [[nodiscard]] std::size_t width() const { return static_cast<std::size_t>(size_); }

    [[nodiscard]] double log_similarity(std::size_t i, std::size_t j) const {
        const int pair = place_[i][j];
        return pair >= 0      ? at_[static_cast<std::size_t>(pair)]
             : pair == kHeld  ? held_
             : pair == kNever ? -std::numeric_limits<double>::infinity()
                              : 0.0;
    }

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

    double derivatives() {
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
                weights[j] = (j > 0 ? at_[j - 1] : 0.0) + log_similarity(i, j);
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
std::optional<double> edge(ChoiceModel& profile, double top, double start, double end) {
    constexpr double kLoss = 1.920729410347062;  // half the 95 % point of chi-square of 1 df
    const double wanted = std::sqrt(kLoss);
    const auto root = [&](double place) {
        return std::sqrt(std::max(0.0, top - profile.best(place)));
    };
    const double sign = end < start ? -1.0 : 1.0;
    Reading near{start, root(start)};
    Reading far = near;
    for (double way = 0.5; far.value < wanted; way *= 1.5) {
        if (far.at == end) {
            return std::nullopt;
        }
        near = far;
        far.at = sign * std::min(sign * start + way, sign * end);
        far.value = root(far.at);
    }
    return near.at == far.at ? start : crossing(root, wanted, near, far, 1e-8);
}

void add_intervals(SimilarityFit& fit, const Numbers& table) {
    constexpr double kMin = -20.0;  // ln 2e-9
    constexpr double kMax = 14.0;   // ln 1e6
    const std::size_t m = table.size();
    fit.intervals.assign(m, std::vector<Interval>(m, Interval{1.0, 1.0}));
    for (std::size_t i = 0; i < m; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            ChoiceModel profile(table, i, j);
            const double similarity = fit.similarity[i][j];
            const double start =
                similarity > 0.0 ? std::clamp(std::log(similarity), kMin, kMax) : kMin;
            const auto low = edge(profile, fit.log_likelihood, start, kMin);
            ChoiceModel upward(table, i, j);
            const auto high = edge(upward, fit.log_likelihood, start, kMax);
            fit.intervals[i][j] = fit.intervals[j][i] = {
                low ? std::exp(*low) : 0.0,
                high ? std::exp(*high) : std::numeric_limits<double>::infinity()};
            if (!low && table[i][j] + table[j][i] > 0.0) {  // steps come near it for ever
                fit.similarity[i][j] = fit.similarity[j][i] = 0.0;
                fit.one_way.emplace_back(j, i);
            }
        }
    }
}

std::vector<std::vector<std::size_t>> groups_of(const Numbers& similarity) {
    const std::size_t m = similarity.size();
    std::vector<std::vector<std::size_t>> groups(m);
    std::vector<std::size_t> of(m);
    for (std::size_t i = 0; i < m; ++i) {
        of[i] = i;
        for (std::size_t j = 0; j < i; ++j) {
            if (similarity[i][j] > 0.0) {
                std::ranges::replace(of, std::size_t{of[i]}, std::size_t{of[j]});
            }
        }
    }
    for (std::size_t i = 0; i < m; ++i) {
        groups[of[i]].push_back(i);
    }
    std::erase_if(groups, [](const auto& group) { return group.empty(); });
    return groups;
}

}  // namespace

SimilarityFit fit_similarity(const CallCounts& counts) {
    const Numbers table = as_numbers(counts);
    const std::size_t m = table.size();
    ChoiceModel model(table, m, m);
    SimilarityFit fit{.log_likelihood = model.best(),
                      .df = static_cast<std::int64_t>((m - 1) * (m - 2) / 2),
                      .residual = model.largest_slope()};
    double total = 0.0;
    for (std::size_t j = 0; j < m; ++j) {
        total += fit.bias.emplace_back(model.bias(j));
    }
    double saturated = 0.0;
    for (std::size_t i = 0; i < m; ++i) {
        fit.bias[i] /= total;
        const double answers = std::accumulate(table[i].begin(), table[i].end(), 0.0);
        auto& row = fit.similarity.emplace_back();
        for (std::size_t j = 0; j < m; ++j) {
            row.push_back(model.similarity(i, j));
            saturated += table[i][j] > 0.0 ? table[i][j] * std::log(table[i][j] / answers) : 0.0;
        }
    }
    fit.deviance = std::max(2.0 * (saturated - fit.log_likelihood), 0.0);
    add_intervals(fit, table);
    fit.groups = groups_of(fit.similarity);
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
