#include "tests/bench/report.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/slurp.hpp"

using bench::Kind;
using bench::Row;

namespace {

std::vector<Row> random_rows(Random& random) {
    std::vector<Row> rows;
    for (int panel = 0; panel < 1 + random.below(5); ++panel) {
        const bool ticks = random.below(3) == 0;
        for (int i = 0; i < 1 + random.below(20); ++i) {
            Row& row = rows.emplace_back();
            row.machine = "a machine";
            row.object = fmt::format("{}", panel);
            row.path = "-3..+3 mm";
            row.method = fmt::format("method <{}> of {}, it has", i, panel);
            row.kind = ticks || i == 1 ? Kind::floor : static_cast<Kind>(1 + random.below(4));
            row.time.warm = std::round(100.0 * random.decade(0.5, 4.0)) / 100.0;
            row.time.p50 = 20.0;
            row.time.p99 = 60.0;
            row.error.distance_p99 = random.coin() ? 1e-7 : 0.0;
        }
    }
    return rows;
}

}  // namespace

TEST_CASE("the picture of run time against error shows every row of its table") {
    SEEDED(random, std::uint64_t{30});
    const std::vector<Row> rows = random_rows(random);
    std::stringstream table;
    bench::write_csv(table, rows);
    const std::string svg = bench::picture(bench::read_csv(table));
    const bool same = svg == bench::picture(rows);
    CHECK(same);
    std::size_t points = 0;
    for (const Row& row : rows) {
        std::string name = row.method;
        name.replace(name.find('<'), 1, "&lt;");
        name.replace(name.find('>'), 1, "&gt;");
        CAPTURE(name);
        CHECK(count_of(svg, name) == 1);
        const bool alone = std::ranges::none_of(rows, [&](const Row& other) {
            return other.object == row.object && other.kind != Kind::floor;
        });
        points += alone || row.kind != Kind::floor ? 1 : 0;
    }
    CHECK(count_of(svg, "class=\"point\"") == points);
}

TEST_CASE("the picture in the documents is that of the table beside it") {
    const std::string name = PALPATE_SOURCE_DIR "/tests/bench/results/amd-epyc.contact";
    std::ifstream table(name + ".csv");
    // Else: palpate bench contact --from amd-epyc.contact.csv --svg amd-epyc.contact.svg
    const bool same = slurp(name + ".svg") == bench::picture(bench::read_csv(table));
    CHECK(same);
}
