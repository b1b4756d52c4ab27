#include <cmath>
#include <cstdlib>
#include <sstream>

#include "data/store/sqlite_recorder.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/studies.hpp"

using namespace palpate;
using tests::TemporaryFolder;

// An independent reader of the stored bytes: what README gives to analysts.
TEST_CASE("twenty lines of plain Python read every value as it was recorded", "[trace][law]") {
    if (tests::Process({"python3", "-c", "import sqlite3, zlib"}).wait().code != 0) {
        WARN("python3 with sqlite3 and zlib is not installed: not checked");
        return;
    }
    const TemporaryFolder folder;
    data::Database database(folder.file("a.sqlite"), data::Access::write);
    const auto spec = tests::session_spec(tests::small_protocol());
    const auto opened = data::open_session(database, spec);
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    const auto ticks = tests::random_ticks(5, 600);
    const auto id = recorder.begin_trial(spec.plan.trials[0], {});
    recorder.append(id, ticks);
    recorder.end_trial(id, tests::answered(0, true, 600));

    const tests::Finished python =
        tests::Process({"python3", PALPATE_SOURCE_DIR "/data/trace/read_trace.py",
                        folder.file("a.sqlite"), std::to_string(id), "tick", "hip_x_m", "hip_y_m",
                        "fx_n", "fy_n", "count_1", "feature", "flags"})
            .wait();
    CAPTURE(python.error);
    REQUIRE(python.code == 0);
    std::istringstream lines(python.out);
    std::string line;
    std::getline(lines, line);
    CHECK(line == "tick,hip_x_m,hip_y_m,fx_n,fy_n,count_1,feature,flags");
    const auto same = [](const std::string& text, double value) {
        return std::isnan(value) ? text == "nan" : std::strtod(text.c_str(), nullptr) == value;
    };
    for (const engine::TickRecord& tick : ticks) {
        REQUIRE(std::getline(lines, line));
        std::istringstream words(line);
        std::vector<std::string> word(8);
        for (std::string& w : word) {
            std::getline(words, w, ',');
        }
        CAPTURE(line);
        REQUIRE(std::stoll(word[0]) == tick.tick);
        REQUIRE((same(word[1], tick.hip.x) && same(word[2], tick.hip.y) &&
                 same(word[3], tick.force.x) && same(word[4], tick.force.y)));
        REQUIRE(std::stoi(word[5]) == tick.counts[0]);
        REQUIRE(std::stoi(word[6]) == tick.feature);
        REQUIRE(std::stoi(word[7]) == tick.flags);
    }
    CHECK_FALSE(std::getline(lines, line));
}
