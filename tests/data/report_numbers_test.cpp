#include "data/plot/axis_ticks.hpp"
#include "tests/figures/csv.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"
#include "tests/support/slurp.hpp"

using namespace palpate::data;
using namespace palpate::figures;

TEST_CASE("ticks are 1, 2 or 5 times a power of ten, inside the axis, and say their value",
          "[report][law]") {
    SEEDED(random, 300U);
    const double size = random.decade(-12.0, 12.0);
    const double low = size * random.in(-3.0, 3.0);
    const AxisRange range{.low = low, .high = low + size * random.in(0.01, 5.0)};
    const AxisTicks ticks = nice_ticks(range, 6);
    REQUIRE(ticks.ticks.size() >= 2);
    CHECK(ticks.ticks.size() <= 14);
    const double step = ticks.ticks[1].at - ticks.ticks[0].at;
    const double mantissa = step / std::pow(10.0, std::floor(std::log10(step) + 1e-6));
    CHECK((std::fabs(mantissa - 1.0) < 1e-6 || std::fabs(mantissa - 2.0) < 1e-6 ||
           std::fabs(mantissa - 5.0) < 1e-6));
    for (const AxisTick& tick : ticks.ticks) {
        CHECK(range.share(tick.at) >= -1e-6);
        CHECK(range.share(tick.at) <= 1.0 + 1e-6);
        std::string label = tick.label;
        if (label.rfind("\xE2\x88\x92", 0) == 0) {
            label.replace(0, 3, "-");
        }
        CHECK(std::strtod(label.c_str(), nullptr) * std::pow(10.0, ticks.exponent) ==
              Approx(tick.at).margin(1e-6 * step));
    }
}

TEST_CASE("log axes name their decades", "[report]") {
    const auto labels = [](double low, double high) {
        std::string all;
        for (const AxisTick& tick : nice_ticks({.low = low, .high = high, .log = true}, 6).ticks) {
            all += tick.label.empty() ? "" : tick.label + " ";
        }
        return all;
    };
    CHECK(labels(0.05, 2000.0) == "0.1 1 10 100 1000 ");
    CHECK(labels(1e-9, 1e-6) == "10⁻⁹ 10⁻⁸ 10⁻⁷ 10⁻⁶ ");
    CHECK(labels(1.5, 30.0) == "2 5 10 20 ");
    CHECK(labels(1.0, 4.0) == "1.0 1.5 2.0 2.5 3.0 3.5 4.0 ");
}

TEST_CASE("CSV numbers read back to the same bits", "[report][law]") {
    Random random(11);
    CsvColumn a{.name = "time_s", .values = {}};
    CsvColumn b{.name = "a, \"b\"", .values = {}};
    for (int i = 0; i < 500; ++i) {
        a.values.push_back((random.coin() ? 1.0 : -1.0) * random.decade(-300.0, 300.0));
        b.values.push_back(i == 3 ? std::numeric_limits<double>::quiet_NaN() : i * 0.1);
    }
    const std::vector<CsvColumn> columns{a, b};
    const auto lines = lines_in(csv(columns));
    REQUIRE(lines.size() == a.values.size() + 1);
    CHECK(lines[0] == "time_s,\"a, \"\"b\"\"\"");
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        const std::string& line = lines[i + 1];
        const std::size_t comma = line.find(',');
        const double x = std::strtod(line.c_str(), nullptr);
        REQUIRE(std::memcmp(&x, &a.values[i], sizeof x) == 0);
        if (std::isnan(b.values[i])) {
            REQUIRE(comma + 1 == line.size());
        } else {
            REQUIRE(std::strtod(line.c_str() + comma + 1, nullptr) == b.values[i]);
        }
    }
    CHECK(csv(std::vector<CsvColumn>{{"x", {0.1, 1e300}}}) == "x\n0.1\n1e+300\n");
    CHECK_THROWS_WITH(csv(std::vector<CsvColumn>{{"x", {1.0}}, {"y", {}}}),
                      Has("\"y\" has 0 values"));
    CHECK_THROWS_AS(csv({}), std::invalid_argument);
}
