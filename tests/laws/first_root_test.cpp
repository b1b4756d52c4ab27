#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"

// The god-object slides to the first place of its way that lies in its friction cone, and nowhere further: scenes in
// which earlier walks of ours went wrong, two or three ticks each, with the place that the exact law gives.
using namespace palpate;

namespace {

using Row = std::map<std::string, std::string>;

std::vector<Row> rows_of(std::istream& in) {
    const auto fields_of = [](const std::string& line) {
        std::istringstream text(line);
        std::vector<std::string> fields;
        for (std::string field; std::getline(text, field, ',');) {
            fields.push_back(field);
        }
        return fields;
    };
    std::string line;
    std::getline(in, line);
    const std::vector<std::string> names = fields_of(line);
    std::vector<Row> rows;
    while (std::getline(in, line)) {
        const std::vector<std::string> fields = fields_of(line);
        Row& row = rows.emplace_back();
        for (std::size_t i = 0; i < names.size(); ++i) {
            row[names[i]] = fields.at(i);
        }
    }
    return rows;
}

double number(const Row& row, const std::string& name) {
    return std::stod(row.at(name));
}

}  // namespace

TEST_CASE("the god-object stops at the first place in its cone, in the scenes that were hardest",
          "[cli][friction][law]") {
    const std::string folder = PALPATE_SOURCE_DIR "/tests/golden/first_root/";
    std::ifstream table(folder + "expected.csv");
    const std::vector<Row> cases = rows_of(table);
    REQUIRE(cases.size() >= 18);
    for (const Row& expected : cases) {
        const std::string& scene = expected.at("scene");
        CAPTURE(scene);
        const tests::Finished run =
            tests::palpate_command({"render", folder + scene + ".toml", folder + scene + ".csv"});
        REQUIRE(run.code == 0);
        std::istringstream text(run.out);
        const Row row = rows_of(text).at(std::stoul(expected.at("tick")));
        if (expected.at("what") == "free") {
            CHECK(row.at("mode") == "FREE");
            CHECK(number(row, "fn_n") == 0.0);
            continue;
        }
        CHECK(row.at("mode") != "FREE");
        const double apart = std::hypot(number(row, "go_x_m") - number(expected, "go_x_m"),
                                        number(row, "go_y_m") - number(expected, "go_y_m"));
        CHECK(apart <= number(expected, "tolerance_m"));
        CHECK(row.at("held") == (expected.at("what") == "held" ? "1" : "0"));
        CHECK(row.at("slewed") == "0");
        CHECK(row.at("unproven") == "0");
    }
}
