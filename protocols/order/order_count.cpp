#include "protocols/order/order_count.hpp"

#include <algorithm>
#include <numeric>

namespace palpate::protocols {
namespace {

Natural choose(std::size_t n, std::size_t k) {
    return k > n ? Natural{} : multinomial({n - k, k});
}

/// Q(n, j) for j = 0 ... n; some are below 0.
std::vector<Natural> pieces_of(std::size_t n, std::size_t limit) {
    std::vector<Natural> ways(n + 1);
    if (n == 0) {
        ways[0] = 1;
    }
    for (std::size_t j = 1; j <= n; ++j) {
        for (std::size_t a = 0; a <= j && a * limit <= n - j; ++a) {
            const std::size_t rest = n - j - a * limit;
            if (rest % (limit + 1) == 0) {
                const std::size_t b = rest / (limit + 1);
                const Natural chosen = choose(j, a) * choose(j - 1 + b, b);
                ways[j] += a % 2 == 0 ? chosen : -chosen;
            }
        }
    }
    return ways;
}

/// Ways to mix s pieces of the levels so far with those of one more: C(s, j) for each.
std::vector<Natural> mixed(const std::vector<Natural>& before, const std::vector<Natural>& level) {
    std::vector<Natural> after(before.size() + level.size() - 1);
    std::vector<Natural> row{1};  // of Pascal's triangle
    for (std::size_t s = 0; s < after.size(); ++s) {
        for (std::size_t j = 0; j < level.size() && j <= s; ++j) {
            if (s - j < before.size()) {
                after[s] += before[s - j] * level[j] * row[j];
            }
        }
        row.emplace_back(1);
        for (std::size_t j = row.size() - 2; j > 0; --j) {
            row[j] += row[j - 1];
        }
    }
    return after;
}

}  // namespace

std::map<Condition, std::size_t> cells_of(std::span<const Condition> trials) {
    std::map<Condition, std::size_t> cells;
    for (const Condition& condition : trials) {
        ++cells[condition];
    }
    return cells;
}

Natural orders_of(std::span<const Condition> trials) {
    std::vector<std::size_t> counts;
    for (const auto& [condition, count] : cells_of(trials)) {
        counts.push_back(count);
    }
    return multinomial(counts);
}

std::vector<std::size_t> counts_of(std::span<const Condition> trials,
                                   std::size_t Condition::*factor) {
    std::map<std::size_t, std::size_t> counts;
    for (const Condition& condition : trials) {
        ++counts[condition.*factor];
    }
    std::vector<std::size_t> numbers;
    for (const auto& [level, count] : counts) {
        numbers.push_back(count);
    }
    return numbers;
}

bool binds(std::span<const std::size_t> counts, std::size_t limit) noexcept {
    return limit > 0 &&
           std::any_of(counts.begin(), counts.end(), [&](std::size_t n) { return n > limit; });
}

Natural count_orders(std::span<const std::size_t> counts, std::size_t limit) {
    std::vector<Natural> pieces{1};
    for (const std::size_t count : counts) {
        pieces = mixed(pieces, pieces_of(count, limit));
    }
    return std::accumulate(pieces.begin(), pieces.end(), Natural{});
}

std::size_t rarity_of(std::span<const std::size_t> counts, std::size_t limit) {
    if (!binds(counts, limit)) {
        return 0;
    }
    const std::size_t trials = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
    if (trials <= kMaxCounted) {
        return bits_of(multinomial({counts.begin(), counts.end()})) -
               bits_of(count_orders(counts, limit));
    }
    const auto n = static_cast<double>(trials);
    double too_long = 0.0;
    for (const std::size_t count : counts) {
        const double share = static_cast<double>(count) / n;
        double runs = (n - static_cast<double>(limit)) * (1.0 - share);
        for (std::size_t i = 0; i <= limit && runs > 0x1p-40; ++i) {
            runs *= share;
        }
        too_long += runs;
    }
    constexpr double kBitsPerRun = 1.4427;  // 1 / ln 2: exp(-too_long) have none
    return static_cast<std::size_t>(too_long * kBitsPerRun);
}

}  // namespace palpate::protocols
