#include "data/store/reader.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/studies.hpp"

using namespace palpate::data;

namespace {

/// A trial of a new session, answered, with these ticks stored.
struct Recorded : tests::SmallSession {
    Recorded(const std::vector<engine::TickRecord>& ticks, std::int64_t counted)
        : trial(record(0, tests::answered(0, true, counted), ticks)) {}
    protocols::TrialId trial;
};

/// Ticks 0 to `count` - 1 without those from `first` to `last`.
std::vector<engine::TickRecord> without(std::int64_t first, std::int64_t last, std::size_t count) {
    auto ticks = tests::random_ticks(1, count);
    ticks.erase(ticks.begin() + first, ticks.begin() + last + 1);
    return ticks;
}

std::string missing(std::int64_t first, std::int64_t last) {
    return "ticks " + std::to_string(first) + " to " + std::to_string(last) + " are missing";
}

}  // namespace

TEST_CASE("a trace without its tail is refused, and what is stored of it can still be had",
          "[trace][law]") {
    constexpr std::int64_t kTicks = 9000;
    const std::int64_t kept = GENERATE(0, 2048, 8192);  // whole chunks
    CAPTURE(kept);
    Recorded rig(tests::random_ticks(1, kTicks), kTicks);
    CHECK(data::read_trace(rig.database, rig.trial).size() == kTicks);
    rig.database.execute(
        ("DELETE FROM trace_chunk WHERE first_tick >= " + std::to_string(kept)).c_str());
    CHECK_THROWS_WITH(data::read_trace(rig.database, rig.trial), Has(missing(kept, kTicks - 1)));
    CHECK(data::stored_ticks(rig.database, rig.trial).size() == static_cast<std::size_t>(kept));
}

TEST_CASE("a trace with a hole is refused wherever the hole is, and named", "[trace][law]") {
    const auto seed = GENERATE(palpate::tests::seeds(std::uint64_t{10}));
    tests::Random random(seed);
    constexpr int kTicks = 5000;
    const std::int64_t first = random.below(kTicks - 1);
    const std::int64_t last = first + random.below(kTicks - 1 - static_cast<int>(first));
    CAPTURE(seed, first, last);
    const auto ticks = without(first, last, kTicks);
    Recorded rig(ticks, static_cast<std::int64_t>(ticks.size()));
    CHECK_THROWS_WITH(data::read_trace(rig.database, rig.trial), Has(missing(first, last)));
    CHECK(data::stored_ticks(rig.database, rig.trial).size() == ticks.size());
}

TEST_CASE("a trace that goes back in time is refused", "[trace][law]") {
    auto ticks = tests::random_ticks(1, 200);
    const auto again = tests::random_ticks(2, 100, 150);
    ticks.insert(ticks.end(), again.begin(), again.end());
    Recorded rig(ticks, static_cast<std::int64_t>(ticks.size()));
    CHECK_THROWS_WITH(data::read_trace(rig.database, rig.trial), Has("tick 150 follows tick 199"));
}

TEST_CASE("a trial that is not there has no trace, not an empty one", "[trace][law]") {
    Recorded rig(tests::random_ticks(1, 10), 10);
    for (const std::int64_t trial : {rig.trial + 1, std::int64_t{0}, std::int64_t{-1}}) {
        const std::string says = "there is no trial " + std::to_string(trial);
        CHECK_THROWS_WITH(data::read_trace(rig.database, trial), Has(says));
        CHECK_THROWS_WITH(data::stored_ticks(rig.database, trial), Has(says));
    }
}
