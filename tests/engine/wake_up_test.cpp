#include "engine/base/lock_free.hpp"
#include "engine/realtime/deadline_grid.hpp"
#include "engine/realtime/lateness_histogram.hpp"
#include "engine/realtime/realtime_rights.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::engine;

namespace {

/// Lateness as machines have it: mostly tens of microseconds, now and then many periods.
std::int64_t some_lateness(std::mt19937& random, std::int64_t period) {
    const auto kind = random() % 100;
    const std::int64_t max = kind < 80 ? 50'000 : kind < 95 ? 2 * period : 50 * period;
    return static_cast<std::int64_t>(random()) % max;
}

}  // namespace

TEST_CASE(
    "a deadline is always the first point of the grid after the last wake-up, found by counting") {
    SEED(50U);
    std::mt19937 random(seed);
    const std::int64_t period = 100'000 + static_cast<std::int64_t>(random() % 900'001);
    const std::int64_t first = static_cast<std::int64_t>(random()) + 1'000'000;
    DeadlineGrid grid(first, period);
    std::int64_t counted = first;
    for (int tick = 0; tick < 500; ++tick) {
        REQUIRE(grid.deadline() == counted);
        const bool exactly = random() % 10 == 0;  // woke on a grid point, some periods late
        const std::int64_t late = exactly ? period * static_cast<std::int64_t>(random() % 5)
                                          : some_lateness(random, period);
        const std::int64_t now = counted + late;
        std::int64_t passed = -1;
        while (counted <= now) {
            counted += period;
            ++passed;
        }
        REQUIRE(grid.pass(now) == passed);
        REQUIRE(grid.deadline() > now);
        REQUIRE(grid.deadline() - now <= period);
    }
}

TEST_CASE("a wake-up before its deadline, as no sleep gives one, still goes one period on") {
    DeadlineGrid grid(1'000, 100);
    CHECK(grid.pass(-5'000) == 0);
    CHECK(grid.deadline() == 1'100);
}

TEST_CASE("the watch before a deadline never passes its bound, whatever the lateness was") {
    SEED(100U);
    std::mt19937 random(seed);
    const std::int64_t max = seed == 0 ? 0 : static_cast<std::int64_t>(random() % 500'000);
    AdaptiveSpin spin(max);
    for (int i = 0; i < 5000; ++i) {
        REQUIRE(spin.ahead_ns() >= 0);
        REQUIRE(spin.ahead_ns() <= max);
        const std::int64_t extreme = std::int64_t{1} << (random() % 62U);
        spin.woke(random() % 20 == 0 ? extreme : some_lateness(random, 1'000'000));
    }
}

TEST_CASE("the watch settles where about one sleep in 512 ends later, for two kinds of machine") {
    const double scale = GENERATE(8'000.0, 40'000.0);
    std::mt19937 random(7);
    AdaptiveSpin spin(500'000);
    int later = 0;
    constexpr int kSettle = 100'000;
    constexpr int kCount = 400'000;
    for (int i = 0; i < kSettle + kCount; ++i) {
        // Exponential lateness: its 511/512 quantile is scale * ln 512.
        const double uniform = (static_cast<double>(random()) + 1.0) / 4294967297.0;
        const auto late = static_cast<std::int64_t>(-scale * std::log(uniform));
        later += i >= kSettle && late > spin.ahead_ns() ? 1 : 0;
        spin.woke(late);
    }
    const double share = static_cast<double>(later) / kCount;
    CHECK(share > 0.5 / 512.0);
    CHECK(share < 2.0 / 512.0);
}

TEST_CASE("quantiles of the lateness histogram are those of the sorted values, to 1/32") {
    SEED(40U);
    std::mt19937 random(seed);
    LatenessHistogram histogram;
    std::vector<std::int64_t> values;
    const std::size_t count = 1 + random() % 3000;
    std::int64_t late = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::int64_t bound = std::int64_t{1} << (1U + random() % 33U);
        values.push_back(static_cast<std::int64_t>(random()) % bound);
        late += values.back() > 500'000 ? 1 : 0;
        histogram.add(values.back(), values.back() > 500'000);
    }
    std::sort(values.begin(), values.end());
    CHECK(histogram.count() == static_cast<std::int64_t>(count));
    CHECK(histogram.late() == late);
    CHECK(histogram.max_ns() == values.back());
    for (const double share : {0.0, 0.01, 0.5, 0.9, 0.99, 0.999, 1.0}) {
        CAPTURE(share);
        const auto rank =
            static_cast<std::size_t>(std::max(1.0, std::ceil(share * static_cast<double>(count))));
        const std::int64_t exact = values[rank - 1];
        CHECK(histogram.quantile_ns(share) >= exact);
        CHECK(static_cast<double>(histogram.quantile_ns(share)) <=
              static_cast<double>(exact) * (1.0 + 1.0 / 32.0));
    }
}

TEST_CASE(
    "a lateness histogram of parts is the histogram of the whole, and holds what no bin does") {
    std::mt19937 random(3);
    LatenessHistogram whole;
    std::array<LatenessHistogram, 3> parts{};
    for (int i = 0; i < 9000; ++i) {
        const std::int64_t late = some_lateness(random, 1'000'000);
        whole.add(late, late > 500'000);
        parts[random() % 3].add(late, late > 500'000);
    }
    LatenessHistogram sum;
    for (const LatenessHistogram& part : parts) {
        sum.add(part);
    }
    CHECK(sum.count() == whole.count());
    CHECK(sum.late() == whole.late());
    for (const double share : {0.1, 0.5, 0.99, 1.0}) {
        CHECK(sum.quantile_ns(share) == whole.quantile_ns(share));
    }
    CHECK(LatenessHistogram{}.quantile_ns(0.5) == 0);
    LatenessHistogram odd;
    odd.add(-5, false);
    odd.add(std::int64_t{3600} * 1'000'000'000, true);  // a suspended machine
    CHECK(odd.quantile_ns(0.1) == 0);
    CHECK(odd.quantile_ns(1.0) == std::int64_t{3600} * 1'000'000'000);
    CHECK(odd.below(1'000) == 1);
}

TEST_CASE("a histogram describes itself in a line") {
    LatenessHistogram histogram;
    for (int i = 0; i < 99; ++i) {
        histogram.add(63, false);
    }
    histogram.add(2'345'678, true);
    histogram.add_missed(2);
    CHECK(describe(histogram) ==
          "100 ticks, late by 0.0 us (half of them), 0.0 us (99 %), 2.3 ms (worst); 1 more than "
          "half a period late, 2 missed");
}

TEST_CASE("the latest value is never torn and never goes back, with two readers at full speed") {
    struct Value {
        std::int64_t number = 0;
        std::array<std::int64_t, 10> echoes{};
        std::int32_t last = 0;  // not a whole number of words
    };
    LatestValue<Value> latest;
    CHECK_FALSE(latest.read().has_value());
    constexpr int kChanges = 5'000;           // enough of them seen by each reader
    constexpr std::int64_t kMax = 1'000'000;  // where one processor runs all three
    std::atomic<bool> wrong{false};
    std::atomic<int> watching{2};
    const auto watch = [&] {
        std::int64_t seen = 0;
        for (int changes = 0; changes < kChanges && seen < kMax;) {
            const auto value = latest.read();
            if (!value) {
                continue;
            }
            bool whole = value->last == static_cast<std::int32_t>(value->number);
            for (const std::int64_t echo : value->echoes) {
                whole = whole && echo == value->number;
            }
            if (!whole || value->number < seen) {
                wrong.store(true);
            }
            changes += value->number > seen ? 1 : 0;
            seen = value->number;
        }
        watching.fetch_sub(1);
    };
    std::thread one(watch);
    std::thread two(watch);
    for (std::int64_t i = 1; i <= kMax && watching.load() > 0; ++i) {
        Value value{.number = i, .last = static_cast<std::int32_t>(i)};
        value.echoes.fill(i);
        latest.publish(value);
        // A breath, or a slow reader would meet the writer at every try.
        const auto own = latest.read();
        if (!own || own->number != i) {
            wrong.store(true);
        }
    }
    one.join();
    two.join();
    CHECK_FALSE(wrong.load());
}

TEST_CASE("each right that was refused comes with its reason and a remedy, the others with none") {
    for (std::size_t i = 0; i < kRights; ++i) {
        const auto right = static_cast<Right>(i);
        RealtimeRights rights;
        CHECK(rights.complete());
        CHECK(describe(right, rights) == "not asked for");
        CHECK(remedy(right, rights).empty());
        rights.of(right) = {.grant = Grant::given};
        CHECK(rights.complete());
        CHECK(remedy(right, rights).empty());
        rights.of(right) = {.grant = Grant::refused, .error = 1};
        CHECK_FALSE(rights.complete());
        CHECK_THAT(describe(right, rights), Has("refused") || Has("not locked"));
        CHECK_FALSE(remedy(right, rights).empty());
    }
    CHECK(provenance(RealtimeRights{}).size() == kRights);
}
