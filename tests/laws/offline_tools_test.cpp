#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "tests/support/catch.hpp"
#include "tests/support/foot_oracle.hpp"
#include "tests/support/gos_oracle.hpp"
#include "tests/support/nurbs_oracle.hpp"
#include "tests/support/process.hpp"

using namespace palpate;
using Catch::Matchers::ContainsSubstring;
using tests::Finished;
using tests::palpate_command;
using tests::Random;
using tests::TemporaryFolder;
using tests::Vec2;
using tests::write;

namespace {

/// Columns of a CSV text by name.
std::map<std::string, std::vector<std::string>> columns_of(const std::string& text) {
    std::istringstream lines(text);
    std::string line;
    std::vector<std::string> names;
    std::map<std::string, std::vector<std::string>> columns;
    for (bool head = true; std::getline(lines, line); head = false) {
        std::istringstream fields(line);
        std::string field;
        for (std::size_t i = 0; std::getline(fields, field, ','); ++i) {
            if (head) {
                names.push_back(field);
            } else {
                columns[names.at(i)].push_back(field);
            }
        }
    }
    return columns;
}

constexpr const char* kContact = R"(
[renderer]
stiffness_n_per_m = 1000.0
[friction]
law = "gos"
mu_s = 0.7
mu_d = 0.5
tau_slip_s = 0.02
tau_heal_s = 0.1
)";

/// Row i of a column as a number.
double number(const std::map<std::string, std::vector<std::string>>& csv,
              const std::string& column,
              std::size_t row) {
    return std::stod(csv.at(column).at(row));
}

}  // namespace

TEST_CASE("palpate render gives the forces of plane trigonometry on an arc", "[cli][law]") {
    const double kappa = GENERATE(12.0, 0.0, -12.0);
    CAPTURE(kappa);
    const TemporaryFolder folder;
    write(folder.file("s.toml"), std::string(kContact) + fmt::format(R"(
[[segment]]
kind = "arc"
from_m = [-0.05, 0.0]
to_m = [0.05, 0.0]
curvature_per_m = {}
)",
                                                                     kappa));
    const tests::ArcOracle arc{{-0.05, 0.0}, {0.05, 0.0}, kappa};
    tests::GosOracle oracle(arc, {1000.0, 0.7, 0.5, 0.02, 0.1, 1e-3});
    std::string path = "t_s,x_m,y_m\n";
    std::vector<Vec2> hips;
    for (int k = 0; k < 2000; ++k) {
        const double t = 1e-3 * k;
        const double x = 0.03 * std::sin(3.0 * t);
        const double depth = 0.004 * (1.2 - std::cos(2.1 * t)) - 0.001;  // in, and not out again
        const auto foot = arc.closest({x, kappa < 0.0 ? 0.05 : 0.5});
        hips.push_back(Vec2{x, foot.point.y - depth});
        path += fmt::format("{},{},{}\n", t, hips.back().x, hips.back().y);
    }
    write(folder.file("t.csv"), path);
    const Finished run = palpate_command(
        {"render", folder.file("s.toml"), folder.file("t.csv"), "-o", folder.file("o.csv")});
    REQUIRE(run.error.empty());
    REQUIRE(run.code == 0);
    std::ifstream in(folder.file("o.csv"));
    std::ostringstream text;
    text << in.rdbuf();
    REQUIRE_THAT(text.str(),
                 Catch::Matchers::StartsWith("t_s,mode,segment,u,cp_x_m,cp_y_m,go_x_m,"
                                             "go_y_m,fn_n,ft_n,fx_n,fy_n,held,slewed,unproven\n"));
    const auto csv = columns_of(text.str());
    REQUIRE(csv.at("t_s").size() == hips.size());
    double worst = 0.0;
    double worst_cp = 0.0;
    std::map<std::string, int> modes;
    for (std::size_t i = 0; i < hips.size(); ++i) {
        const Vec2 force = oracle.tick(hips[i]);
        const Vec2 got{number(csv, "fx_n", i), number(csv, "fy_n", i)};
        worst = std::max(worst, glm::length(got - force));
        const double fn = number(csv, "fn_n", i);
        const double ft = number(csv, "ft_n", i);
        worst = std::max(worst, std::fabs(std::hypot(fn, ft) - glm::length(force)));
        const Vec2 cp{number(csv, "cp_x_m", i), number(csv, "cp_y_m", i)};
        worst_cp = std::max(worst_cp, glm::length(cp - arc.closest(hips[i]).point));
        ++modes[csv.at("mode")[i]];
    }
    CHECK(worst < 1e-9);
    CHECK(worst_cp < 1e-12);
    CHECK(modes.size() == 4);  // free, stuck, slip, transition
}

TEST_CASE("palpate closest answers for separate curves like an oracle that proves its distance",
          "[cli][law]") {
    const auto seed = GENERATE(range(0U, 6U));
    CAPTURE(seed);
    Random random(seed);
    const TemporaryFolder folder;
    std::string scene;
    std::vector<tests::FootOracle> oracles;
    for (int i = 0; i < 3; ++i) {
        const auto data = tests::random_nurbs<2>(random, 0.1, 1.0);
        oracles.emplace_back(data);
        std::vector<std::string> points;
        for (const Vec2& p : data.points) {
            points.push_back(fmt::format("[{}, {}]", p.x, p.y));
        }
        scene += fmt::format(
            "[[segment]]\nkind = \"nurbs\"\ndegree = {}\nknots = [{}]\npoints_m = [{}]\n"
            "weights = [{}]\n",
            data.degree, fmt::join(data.knots, ", "), fmt::join(points, ", "),
            fmt::join(data.weights, ", "));
    }
    write(folder.file("s.toml"), scene);
    std::string table = "x_m,y_m\n";
    std::vector<Vec2> points;
    for (int i = 0; i < 60; ++i) {
        points.push_back(random.point(-0.1, 0.1));
        table += fmt::format("{},{}\n", points.back().x, points.back().y);
    }
    write(folder.file("p.csv"), table);
    const Finished run = palpate_command({"closest", folder.file("s.toml"), folder.file("p.csv")});
    REQUIRE(run.error.empty());
    const auto csv = columns_of(run.out);
    REQUIRE(csv.at("distance_m").size() == points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        std::vector<long double> distances;
        for (const auto& oracle : oracles) {
            distances.push_back(oracle.closest(points[i]).distance);
        }
        const auto nearest = std::min_element(distances.begin(), distances.end());
        CHECK(std::fabs(number(csv, "distance_m", i) - static_cast<double>(*nearest)) < 1e-15);
        CHECK(number(csv, "segment", i) == static_cast<double>(nearest - distances.begin()));
    }
}

TEST_CASE(
    "a wrong scene or table gets file, line, value and remedy, exit code 2, and no output file",
    "[cli][law]") {
    const TemporaryFolder folder;
    const std::string good = std::string(kContact) + R"(
[[segment]]
kind = "line"
from_m = [0.0, 0.0]
to_m = [0.1, 0.0]
)";
    const std::string path = "t_s,x_m,y_m\n0,0.05,0.01\n0.001,0.05,0.0\n";
    struct Wrong {
        std::string from, to, place, value;
    };
    const auto replaced = [](std::string text, const Wrong& wrong) {
        const std::size_t at = text.find(wrong.from);
        return at == std::string::npos ? text : text.replace(at, wrong.from.size(), wrong.to);
    };
    for (const Wrong& wrong :
         {Wrong{"mu_s = 0.7", "mu_s = 0.4", "s.toml:6:", "0.4"},
          Wrong{"\"gos\"", "\"goss\"", "s.toml:5:", "did you mean gos"},
          Wrong{"stiffness_n_per_m = 1000.0", "stiffness_n_per_m = 0", "s.toml:3:", "above 0"},
          Wrong{"\"line\"", "\"lien\"", "s.toml:12:", "lien"},
          Wrong{"[0.1, 0.0]", "[0.0, 0.0]", "s.toml:11:", "apart"},
          Wrong{"[renderer]", "[renderer]\ntracker = \"feedback\"", "s.toml:2:", "gain"},
          Wrong{"0.001,0.05,0.0\n", "0.001,0.05,abc\n", "t.csv:3:", "\"abc\", not a finite number"},
          Wrong{"0.001,0.05,0.0\n", "0.001,0.05,nan\n", "t.csv:3:", "nan"},
          Wrong{"0.001,0.05,0.0\n", "0,0.05,0.0\n", "t.csv:3:", "time has to grow"},
          Wrong{"0.001,0.05,0.0\n", "0.001,0.05\n", "t.csv:3:", "2 fields"},
          Wrong{"t_s,x_m", "t,x_m", "t.csv:1:", "no column t_s"}}) {
        CAPTURE(wrong.to);
        write(folder.file("s.toml"), replaced(good, wrong));
        write(folder.file("t.csv"), replaced(path, wrong));
        const Finished run = palpate_command(
            {"render", folder.file("s.toml"), folder.file("t.csv"), "-o", folder.file("o.csv")});
        CAPTURE(run.error);
        CHECK(run.code == 2);
        CHECK_THAT(run.error, ContainsSubstring(wrong.place) && ContainsSubstring(wrong.value));
        CHECK(folder.names() == std::vector<std::string>{"s.toml", "t.csv"});
    }
}

TEST_CASE("the same scene and path give the same bytes", "[cli][law]") {
    const TemporaryFolder folder;
    write(folder.file("s.toml"), std::string(kContact) + R"(
[[segment]]
kind = "nurbs"
degree = 3
knots = [0, 0, 0, 0, 1, 1, 1, 1]
points_m = [[-0.08, 0.0], [-0.06, 0.03], [-0.03, 0.04], [0.0, 0.04]]
[[segment]]
kind = "arc"
from_m = [0.0, 0.04]
to_m = [0.07, 0.0]
curvature_per_m = 8.0
)");
    std::string path = "t_s,x_m,y_m\n";
    for (int k = 0; k < 1000; ++k) {
        path += fmt::format("{},{},{}\n", 0.001 * k, -0.05 + 1e-4 * k, 0.03);
    }
    write(folder.file("t.csv"), path);
    const Finished first = palpate_command({"render", folder.file("s.toml"), folder.file("t.csv")});
    const Finished second =
        palpate_command({"render", folder.file("s.toml"), folder.file("t.csv")});
    CHECK(first.code == 0);
    CHECK(first.out.size() > 50000);
    CHECK((first.out == second.out));
}
