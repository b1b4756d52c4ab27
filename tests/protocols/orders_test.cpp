#include "engine/base/sha256.hpp"
#include "protocols/design/streams.hpp"
#include "protocols/order/eulerian_order.hpp"
#include "protocols/order/order_sampler.hpp"
#include "tests/protocols/orders.hpp"

using namespace palpate::protocols;

namespace {

/// What not to do: shuffle once, then swap offending trials away until the limits hold.
Order repaired(Order order, const RunLimits& limits, Pcg32& random) {
    shuffle(std::span(order), random);
    for (std::size_t i = 1; !within_limits(order, limits); i = i % (order.size() - 1) + 1) {
        if (!within_limits(std::span(order).first(i + 1), limits)) {
            std::swap(order[i], order[random.bounded(static_cast<std::uint32_t>(order.size()))]);
        }
    }
    return order;
}

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

// What tells uniform orders of every way of drawing (order_counter_test.cpp) is able to fail.
TEST_CASE("repair by swaps is not uniform over all admissible orders") {
    const Order trials = factorial_of(2, 2, 2);
    const RunLimits limits{.object = 2, .friction = 2};
    const auto orders = admissible(trials, limits);
    Pcg32 random(2024, 1);
    const double excess = excess_of_chi_square(orders, 100 * orders.size(),
                                               [&] { return repaired(trials, limits, random); });
    CHECK(excess > 50.0);
}

TEST_CASE("the cheap test refuses exactly what one factor cannot keep") {
    for (std::size_t first = 0; first <= 5; ++first) {
        for (std::size_t second = 0; second <= 4; ++second) {
            for (std::size_t limit = 1; limit <= 4; ++limit) {
                Order trials(first, Condition{0, 0});
                trials.insert(trials.end(), second, Condition{1, 0});
                CAPTURE(first, second, limit);
                const RunLimits limits{.object = limit, .friction = 0};
                CHECK(why_infeasible(trials, limits).has_value() ==
                      admissible(trials, limits).empty());
            }
        }
    }
}

TEST_CASE("limits that cannot be kept are refused with a reason") {
    Pcg32 random(1, 1);
    CHECK_THROWS_WITH(
        OrderSampler(factorial_of(1, 1, 3), {.object = 2, .friction = 0}).draw(random),
        Has("object 1 occurs 3 times", "allow runs of 3"));
    CHECK_THROWS_WITH(
        OrderSampler(factorial_of(2, 2, 5), {.object = 1, .friction = 1}).draw(random),
        Has("alternate"));
    // Each limit can be kept alone: the frictions alternate, and the objects come in whole.
    Order unlike = factorial_of(2, 2, 1);
    unlike.push_back({0, 0});
    unlike.push_back({0, 1});
    CHECK_THROWS_WITH(OrderSampler(unlike, {.object = 1, .friction = 2}).draw(random),
                      Has("allow runs"));
}

TEST_CASE("no limits: the first shuffle is taken") {
    Pcg32 random(9, 9);
    CHECK(OrderSampler(factorial_of(1, 1, 30), {}).draw(random).attempts == 1);
    CHECK(OrderSampler({}, {.object = 1, .friction = 1}).draw(random).order.empty());
}

TEST_CASE("a first-order balanced sequence has every ordered pair once") {
    EACH(k, range(std::size_t{1}, std::size_t{25}));
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
TEST_CASE(
    "first-order balanced sequences are uniform over all, as many as the BEST theorem counts") {
    const std::size_t k = GENERATE(std::size_t{2}, std::size_t{3});
    const auto all = all_sequences(k);
    CHECK(all.size() == (k == 2 ? 4 : 216));
    Pcg32 random(5, k);
    CHECK(std::fabs(excess_of_chi_square(all, 300 * all.size(),
                                         [&] { return eulerian_order(k, random); })) < 4.0);
}

TEST_CASE("a walk that backs out of dead ends fails the same test") {
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

TEST_CASE("a sequence of no symbols is empty, and of too many refused") {
    Pcg32 random(1, 1);
    CHECK(eulerian_order(0, random).empty());
    CHECK_THROWS_AS(eulerian_order(kMaxSymbols + 1, random), std::invalid_argument);
}

// FIPS 180-4 and its example values (NIST, "Examples with intermediate values": SHA-256).
TEST_CASE("SHA-256 gives the published digests") {
    CHECK(sha256_hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    CHECK(sha256_hex("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    CHECK(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
          "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    CHECK(sha256_hex(std::string(1000000, 'a')) ==
          "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_CASE("a stream is the hash of its key's text") {
    const StreamKey key{.protocol_hash = "abcd",
                        .participant = "p01",
                        .session = 2,
                        .block = 3,
                        .purpose = "order.main",
                        .seed = 42};
    const std::string text =
        "palpate-stream-v1\nprotocol=4:abcd\nparticipant=3:p01\nsession=2\nblock=3\n"
        "purpose=10:order.main\nseed=42\n";
    CHECK(canonical_text(key) == text);

    const std::string hex = sha256_hex(text);
    const Pcg32 expected(std::stoull(hex.substr(0, 16), nullptr, 16),
                         std::stoull(hex.substr(16, 16), nullptr, 16));
    CHECK(stream(key) == expected);
}

TEST_CASE("keys that differ anywhere have different texts and streams") {
    const StreamKey key{.protocol_hash = "h", .participant = "p", .purpose = "catch"};
    std::vector<StreamKey> keys(8, key);
    keys[1].protocol_hash = std::string("i");
    keys[2].participant = std::string("q");
    keys[3].session = 2;
    keys[4].block = 1;
    keys[5].purpose = std::string("hand");
    keys[6].seed = 1;
    // A participant whose name imitates the rest of the text.
    keys[7].participant = std::string("p\nsession=1\nblock=0\npurpose=5:catch\nseed=0");
    std::set<std::string> texts;
    std::set<std::uint64_t> first;
    for (const StreamKey& one : keys) {
        texts.insert(canonical_text(one));
        Pcg32 random = stream(one);
        const std::uint64_t upper = random.next();
        first.insert((upper << 32U) | random.next());
    }
    CHECK(texts.size() == keys.size());
    CHECK(first.size() == keys.size());
}
