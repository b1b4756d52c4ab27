#include "tests/support/catch.hpp"
#include "tests/support/slurp.hpp"
#include "tests/support/studies.hpp"

// An independent reader of the stored bytes: what README gives to analysts.
TEST_CASE("plain Python, base R and palpate trace read every stored value as it was recorded",
          "[trace][law]") {
    if (tests::Process({"python3", "-c", "import sqlite3, zlib"}).wait().code != 0) {
        WARN("python3 with sqlite3 and zlib is not installed: not checked");
        return;
    }
    tests::SmallSession session;
    const auto ticks = tests::random_ticks(5, 5000);
    const std::string id = std::to_string(session.record(0, tests::answered(0, true, 5000), ticks));
    const std::string file = session.folder.file("a.sqlite");

    const tests::Finished python =
        tests::Process({"python3", PALPATE_SOURCE_DIR "/data/trace/read_trace.py", file, id})
            .wait();
    CAPTURE(python.error);
    REQUIRE(python.code == 0);
    const auto lines = tests::lines_in(python.out);
    REQUIRE(lines.size() == ticks.size() + 1);
    CHECK(lines[0] ==
          "tick,time_ns,count_1,count_2,code_1,code_2,lateness_ns,flags,hip_x_100nm,hip_y_100nm,"
          "commanded_x_100un,commanded_y_100un,count_3,code_3,hip_z_100nm,commanded_z_100un");
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        const engine::TickRecord& tick = ticks[i];
        const std::string& line = lines[i + 1];
        std::vector<std::int64_t> number;
        for (const std::string& word : tests::split(line)) {
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

    CHECK(tests::palpate_command({"trace", file, id}).out == python.out);
    if (tests::Process({"Rscript", "-e", "library(RSQLite)"}).wait().code != 0) {
        WARN("R with RSQLite is not installed: not checked");
        return;
    }
    const tests::Finished r =
        tests::Process({"Rscript", PALPATE_SOURCE_DIR "/data/trace/read_trace.R", file, id}).wait();
    CAPTURE(r.error);
    REQUIRE(r.code == 0);
    CHECK(r.out == python.out);
}
