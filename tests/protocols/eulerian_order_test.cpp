#include "protocols/order/eulerian_order.hpp"
#include "tests/protocols/orders.hpp"

using namespace palpate::protocols;

namespace {

using Sequence = std::vector<std::size_t>;

/// Every sequence with every ordered pair once, by trying all.
void extend(std::size_t k,
            Sequence& sequence,
            std::set<std::pair<std::size_t, std::size_t>>& used,
            std::map<Sequence, std::size_t>& all) {
    if (used.size() == k * k) {
        all.emplace(sequence, 0);
        return;
    }
    for (std::size_t next = 0; next < k; ++next) {
        const auto [pair, fresh] = used.emplace(sequence.back(), next);
        if (fresh) {
            const auto kept = *pair;
            sequence.push_back(next);
            extend(k, sequence, used, all);
            sequence.pop_back();
            used.erase(kept);
        }
    }
}

std::map<Sequence, std::size_t> all_sequences(std::size_t k) {
    std::map<Sequence, std::size_t> all;
    for (std::size_t first = 0; first < k; ++first) {
        Sequence sequence{first};
        std::set<std::pair<std::size_t, std::size_t>> used;
        extend(k, sequence, used, all);
    }
    return all;
}

/// What not to do: walk by unused pairs at random, and take back steps from dead ends. (To begin
/// anew at a dead end would be uniform, but from k = 8 on hardly ever ends.)
bool backtracking(std::size_t k,
                  Sequence& sequence,
                  std::set<std::pair<std::size_t, std::size_t>>& used,
                  Pcg32& random) {
    Sequence next(k);
    std::iota(next.begin(), next.end(), std::size_t{0});
    shuffle(std::span(next), random);
    for (const std::size_t symbol : next) {
        if (used.size() == k * k) {
            return true;
        }
        const std::pair pair{sequence.back(), symbol};
        if (used.insert(pair).second) {
            sequence.push_back(symbol);
            if (backtracking(k, sequence, used, random)) {
                return true;
            }
            sequence.pop_back();
            used.erase(pair);
        }
    }
    return used.size() == k * k;
}

}  // namespace

TEST_CASE("a first-order balanced sequence has every ordered pair once", "[eulerian][law]") {
    const std::size_t k = GENERATE(range(std::size_t{1}, std::size_t{25}));
    CAPTURE(k);
    Pcg32 random(k, 9);
    const Sequence sequence = eulerian_order(k, random);
    REQUIRE(sequence.size() == k * k + 1);
    std::set<std::pair<std::size_t, std::size_t>> pairs;
    for (std::size_t i = 1; i < sequence.size(); ++i) {
        CHECK(sequence[i] < k);
        pairs.emplace(sequence[i - 1], sequence[i]);
    }
    CHECK(pairs.size() == k * k);
    CHECK(sequence.front() == sequence.back());
}

// BEST: circuits = k^(k-2) trees * (k-1)!^k; each opens at k^2 places, of which k begin with a
// given symbol. k = 2: 1 * 1 = 1 circuit, 4 sequences. k = 3: 3 * 8 = 24 circuits, 216 sequences.
TEST_CASE("first-order balanced sequences are uniform over all, as many as the BEST theorem counts",
          "[eulerian][law]") {
    const std::size_t k = GENERATE(std::size_t{2}, std::size_t{3});
    const auto all = all_sequences(k);
    CHECK(all.size() == (k == 2 ? 4 : 216));
    Pcg32 random(5, k);
    CHECK(std::fabs(excess_of_chi_square(all, 300 * all.size(),
                                         [&] { return eulerian_order(k, random); })) < 4.0);
}

TEST_CASE("a walk that backs out of dead ends fails the same test", "[eulerian]") {
    const auto all = all_sequences(3);
    Pcg32 random(5, 3);
    const double excess = excess_of_chi_square(all, 300 * all.size(), [&] {
        Sequence sequence{random.bounded(3)};
        std::set<std::pair<std::size_t, std::size_t>> used;
        REQUIRE(backtracking(3, sequence, used, random));
        return sequence;
    });
    CHECK(excess > 50.0);
}

TEST_CASE("a sequence of no symbols is empty, and of too many refused", "[eulerian]") {
    Pcg32 random(1, 1);
    CHECK(eulerian_order(0, random).empty());
    CHECK_THROWS_AS(eulerian_order(kMaxSymbols + 1, random), std::invalid_argument);
}
