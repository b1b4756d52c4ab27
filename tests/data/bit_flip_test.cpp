#include "tests/support/adaptive.hpp"
#include "tests/support/database_edits.hpp"
#include "tests/support/sample_rows.hpp"

using namespace palpate::data;

namespace {

/// The bytes with one bit of them flipped.
void write_flipped(const std::string& file, std::string bytes, std::uint64_t seed) {
    Random random(seed);
    auto& byte = bytes[random.index(bytes.size())];
    byte = static_cast<char>(byte ^ (1 << random.below(8)));
    std::ofstream(file, std::ios::binary) << bytes;
}

/// Six trials of a fifth of a second, felt and answered by simulation.
void record_small_session(const std::string& file) {
    protocols::Protocol protocol = small_protocol();
    protocol.timing.explore_min = 0.1;
    protocol.timing.explore_prompt = 0.15;
    protocol.timing.explore_timeout = 0.2;
    protocol.invalid.contact_min = 0.0;
    protocol.invalid.path_min = 0.0;
    Database database(file, Access::write);
    REQUIRE(run_simulated(database, session_spec(protocol)).why ==
            protocols::SessionEnd::Why::finished);
}

}  // namespace

TEST_CASE(
    "one flipped bit anywhere in a file is reported, or nothing that the file says has changed",
    "[long]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    record_small_session(file);
    const auto said = [](Database& database) {  // all that an analyst can read
        std::string text;
        for (const auto& tables : database.prepare("SELECT name FROM sqlite_schema WHERE type IN "
                                                   "('table', 'view') ORDER BY type, name")) {
            for (const auto& row : database.prepare("SELECT * FROM " + tables.text(0))) {
                for (int i = 0; i < row.columns(); ++i) {
                    const auto blob = row.blob(i);
                    text += row.type(i) == 4
                              ? std::string(reinterpret_cast<const char*>(blob.data()), blob.size())
                              : row.text(i);
                    text += '|';
                }
            }
        }
        return text;
    };
    const std::string bytes = slurp(file);
    std::string before;
    std::string known;
    {
        Database database(file, Access::read);
        before = said(database);
        known = text_of(data::verify(database));  // made-up provenance
    }
    int wrong = 0;
    int noticed = 0;
    int harmless = 0;
    const std::string copy = folder.file("copy.sqlite");
    for (std::uint64_t seed = 0; seed < cases(150U); ++seed) {
        write_flipped(copy, bytes, seed);
        try {
            Database database(copy, Access::read);
            const bool reported = text_of(data::verify(database)) != known;
            noticed += reported ? 1 : 0;
            if (!reported && said(database) == before) {
                ++harmless;
            } else if (!reported) {
                CAPTURE(seed);
                ++wrong;
                WARN("silently wrong with seed " << seed);
            }
        } catch (const std::exception&) {  // it cannot be read, and says so
            ++noticed;
        }
    }
    CAPTURE(noticed, harmless);
    CHECK(wrong == 0);
    CHECK(noticed + harmless == cases(150));
    CHECK(noticed > cases(30));
    CHECK(harmless > 0);
}

TEST_CASE(
    "of a file with a flipped bit sample gives what it gave before, or an error, never another "
    "number") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    record_small_session(file);
    const std::string bytes = slurp(file);
    const std::string queries[] = {
        "SELECT trial_id, interval, count(*), sum(tick), sum(time_s), sum(count_1 - 3 * code_1), "
        "sum(count_2 - 3 * code_2), sum(commanded_x_n), sum(commanded_y_n), sum(flags), "
        "sum(lateness_us) FROM sample GROUP BY 1, 2",
        "SELECT trial_id, interval, sum(hip_x_m), sum(hip_y_m), sum(hip_vx_m_per_s) FROM sample "
        "GROUP BY 1, 2",
        "SELECT trial_id, interval, sum(rendered_normal_n), sum(mu), sum(u), sum(go_x_m), sum(mode "
        "= 'slip') FROM sample GROUP BY 1, 2",
        "SELECT sum(time_s), sum(count_1), sum(tick) FROM sample WHERE trial_id = 3 AND tick >= "
        "100",
        "SELECT sum(hip_x_m), sum(rendered_normal_n) FROM sample WHERE trial_id = 4 AND time_s > "
        "0.1"};
    const auto say = [&](const std::string& of, std::size_t i) {
        Opened database(of);
        return sql_rows(database, queries[i]);
    };
    std::vector<std::vector<SampleRow>> before;
    for (std::size_t i = 0; i < std::size(queries); ++i) {
        before.push_back(say(file, i));
    }
    int refused = 0;
    const std::string copy = folder.file("copy.sqlite");
    for (std::uint64_t seed = 0; seed < cases(100U); ++seed) {
        write_flipped(copy, bytes, seed);
        for (std::size_t i = 0; i < std::size(queries); ++i) {
            try {
                const auto now = say(copy, i);
                CAPTURE(seed, queries[i], now, before[i]);
                CHECK((now == before[i]));
            } catch (const std::exception&) {
                ++refused;
            }
        }
    }
    CHECK(refused > cases(10));
}
