#include "data/store/reader.hpp"
#include "tests/support/program.hpp"
#include "tests/support/studies.hpp"

using namespace palpate::data;

// An independent reader of the stored bytes: what README gives to analysts.
TEST_CASE("plain Python, base R and palpate trace read every stored value as it was recorded") {
    if (!installed("python3 with sqlite3 and zlib", {"python3", "-c", "import sqlite3, zlib"})) {
        return;
    }
    SmallSession session;
    const auto ticks = random_ticks(5, 5000);
    const std::string id = std::to_string(session.record(0, answered(0, true, 5000), ticks));
    const std::string file = session.folder.file("a.sqlite");

    const Finished python = ended(
        Process({"python3", PALPATE_SOURCE_DIR "/data/trace/read_trace.py", file, id}).wait());
    const auto lines = lines_in(python.out);
    REQUIRE(lines.size() == ticks.size() + 1);
    CHECK(lines[0] ==
          "tick,time_ns,count_1,count_2,code_1,code_2,lateness_ns,flags,hip_x_100nm,hip_y_100nm,"
          "commanded_x_100un,commanded_y_100un,count_3,code_3,hip_z_100nm,commanded_z_100un");
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        const engine::TickRecord& tick = ticks[i];
        const std::string& line = lines[i + 1];
        std::vector<std::int64_t> number;
        for (const std::string& word : split(line)) {
            number.push_back(std::stoll(word));
        }
        CAPTURE(line);
        const auto steps = [](double value, double per_unit) {
            const double exact = std::floor(value * per_unit + 0.5);
            return !std::isfinite(value) ? -2147483648.0
                                         : std::clamp(exact, -2147483647.0, 2147483647.0);
        };
        REQUIRE(number ==
                std::vector<std::int64_t>{
                    tick.tick, tick.time_ns, tick.counts[0], tick.counts[1], tick.codes[0],
                    tick.codes[1],
                    static_cast<std::int64_t>(std::floor(double{tick.lateness_us} * 1e3 + 0.5)),
                    tick.flags, static_cast<std::int64_t>(steps(tick.hip.x, 1e7)),
                    static_cast<std::int64_t>(steps(tick.hip.y, 1e7)),
                    static_cast<std::int64_t>(steps(tick.command.x, 1e4)),
                    static_cast<std::int64_t>(steps(tick.command.y, 1e4)), tick.counts[2],
                    tick.codes[2], static_cast<std::int64_t>(steps(tick.hip.z, 1e7)),
                    static_cast<std::int64_t>(steps(tick.command.z, 1e4))});
    }

    CHECK(palpate_command({"trace", file, id}).out == python.out);
    if (!installed("R with RSQLite", {"Rscript", "-e", "library(RSQLite)"})) {
        return;
    }
    const Finished r =
        ended(Process({"Rscript", PALPATE_SOURCE_DIR "/data/trace/read_trace.R", file, id}).wait());
    CHECK(r.out == python.out);
}

namespace {

/// A trial of a new session, answered, with these ticks stored.
struct Recorded : SmallSession {
    Recorded(const std::vector<engine::TickRecord>& ticks, std::int64_t counted)
        : trial(record(0, answered(0, true, counted), ticks)) {}
    protocols::TrialId trial;
};

/// Ticks 0 to `count` - 1 without those from `first` to `last`.
std::vector<engine::TickRecord> without(std::int64_t first, std::int64_t last, std::size_t count) {
    auto ticks = random_ticks(1, count);
    ticks.erase(ticks.begin() + first, ticks.begin() + last + 1);
    return ticks;
}

std::string missing(std::int64_t first, std::int64_t last) {
    return "ticks " + std::to_string(first) + " to " + std::to_string(last) + " are missing";
}

}  // namespace

TEST_CASE("a trace without its tail is refused, and what is stored of it can still be had") {
    constexpr std::int64_t kTicks = 9000;
    const std::int64_t kept = GENERATE(0, 2048, 8192);  // whole chunks
    CAPTURE(kept);
    Recorded rig(random_ticks(1, kTicks), kTicks);
    CHECK(data::TraceReader(rig.database).read(rig.trial).size() == kTicks);
    rig.database.execute(
        ("DELETE FROM trace_chunk WHERE first_tick >= " + std::to_string(kept)).c_str());
    CHECK_THROWS_WITH(data::TraceReader(rig.database).read(rig.trial),
                      Has(missing(kept, kTicks - 1)));
    CHECK(data::TraceReader(rig.database).stored(rig.trial).size() ==
          static_cast<std::size_t>(kept));
}

TEST_CASE("a trace with a hole is refused wherever the hole is, and named") {
    const auto seed = GENERATE(seeds(std::uint64_t{10}));
    Random random(seed);
    constexpr int kTicks = 5000;
    const std::int64_t first = random.below(kTicks - 1);
    const std::int64_t last = first + random.below(kTicks - 1 - static_cast<int>(first));
    CAPTURE(seed, first, last);
    const auto ticks = without(first, last, kTicks);
    Recorded rig(ticks, static_cast<std::int64_t>(ticks.size()));
    CHECK_THROWS_WITH(data::TraceReader(rig.database).read(rig.trial), Has(missing(first, last)));
    CHECK(data::TraceReader(rig.database).stored(rig.trial).size() == ticks.size());
}

TEST_CASE("a trace that goes back in time is refused") {
    auto ticks = random_ticks(1, 200);
    const auto again = random_ticks(2, 100, 150);
    ticks.insert(ticks.end(), again.begin(), again.end());
    Recorded rig(ticks, static_cast<std::int64_t>(ticks.size()));
    CHECK_THROWS_WITH(data::TraceReader(rig.database).read(rig.trial),
                      Has("tick 150 follows tick 199"));
}

TEST_CASE("a trial that is not there has no trace, not an empty one") {
    Recorded rig(random_ticks(1, 10), 10);
    for (const std::int64_t trial : {rig.trial + 1, std::int64_t{0}, std::int64_t{-1}}) {
        const std::string says = "there is no trial " + std::to_string(trial);
        CHECK_THROWS_WITH(data::TraceReader(rig.database).read(trial), Has(says));
        CHECK_THROWS_WITH(data::TraceReader(rig.database).stored(trial), Has(says));
    }
}
