#include "tests/support/arc_oracle.hpp"
#include "tests/support/foot_oracle.hpp"
#include "tests/support/program.hpp"

namespace {

/// Columns of a CSV text by name.
std::map<std::string, Words> columns_of(const std::string& text) {
    std::map<std::string, Words> columns;
    for (auto& row : csv_records(text)) {
        for (auto& [name, field] : row) {
            columns[name].push_back(field);
        }
    }
    return columns;
}

const std::string kContact = test_text("scenes/contact.toml");

/// Row i of a column as a number.
double number(const std::map<std::string, Words>& csv, const std::string& column, std::size_t row) {
    return std::stod(csv.at(column).at(row));
}

}  // namespace

TEST_CASE("palpate render gives the forces of plane trigonometry on an arc", "[cli][law]") {
    EACH(kappa, 12.0, 0.0, -12.0);
    const TemporaryFolder folder;
    write(folder.file("s.toml"), std::string(kContact) + fmt::format(R"(
[[segment]]
kind = "arc"
from_m = [-0.05, 0.0]
to_m = [0.05, 0.0]
curvature_per_m = {}
)",
                                                                     kappa));
    const ArcOracle arc{{-0.05, 0.0}, {0.05, 0.0}, kappa};
    GosOracle oracle(arc, {1000.0, 0.7, 0.5, 0.02, 0.1, 1e-3});
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
    REQUIRE_THAT(text.str(), StartsWith("t_s,mode,segment,u,cp_x_m,cp_y_m,go_x_m,"
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
    SEEDED(random, 6U);
    const TemporaryFolder folder;
    std::string scene;
    std::vector<FootOracle> oracles;
    for (int i = 0; i < 3; ++i) {
        const auto data = random_nurbs<2>(random, 0.1, 1.0);
        oracles.emplace_back(data);
        Words points;
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

TEST_CASE("palpate closest says of a point of a surface whether its search was broken off",
          "[cli][surface][law]") {
    // Weights of 1e-3 beside 1e3 bend the patch into valleys that cost too much; found by search.
    const TemporaryFolder folder;
    write(folder.file("p.csv"), "x_m,y_m,z_m\n0.058,0.108,0.0376\n");
    for (const bool bent : {false, true}) {
        const std::string weights =
            bent ? "[[1, 1000, 0.001], [1, 0.001, 1000]]" : "[[1, 1, 1], [1, 1, 1]]";
        write(folder.file("s.toml"),
              std::string(kContact) +
                  "[[surface]]\ndegree_u = 1\ndegree_v = 2\nknots_u = [0, 0, 1, 1]\n"
                  "knots_v = [0, 0, 0, 1, 1, 1]\npoints_m = [[[0.01, 0, -0.02], [0.01, 0.06, "
                  "-0.02], [-0.02, 0.1, -0.02]], [[0.05, -0.02, -0.02], [0.06, 0.05, 0], [0.06, "
                  "0.11, 0.04]]]\nweights = " +
                  weights + "\n");
        const Finished run =
            palpate_command({"closest", folder.file("s.toml"), folder.file("p.csv")});
        REQUIRE(run.error.empty());
        CHECK(columns_of(run.out).at("unproven").at(0) == (bent ? "1" : "0"));
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
          Wrong{"0.001,0.05,0.0\n", "1e-300,0.05,0.0\n", "t.csv:3:", "ticks of 1e-12 to 3600 s"},
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
        CHECK_THAT(
            ran({"render", folder.file("s.toml"), folder.file("t.csv"), "-o", folder.file("o.csv")},
                2)
                .error,
            Has(wrong.place, wrong.value));
        CHECK(folder.names() == Words{"s.toml", "t.csv"});
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

TEST_CASE("palpate deform says where a bow is over time and at rest, with a column for each number",
          "[offline][law]") {
    const TemporaryFolder folder;
    // As docs/protocol.md shows it.
    const std::string page = slurp(PALPATE_SOURCE_DIR "/docs/protocol.md");
    const std::size_t begin = page.find("degree = 3", page.find("**Curves that yield**"));
    const std::string bow = page.substr(begin, page.find("dt_s", begin) - begin);
    write(folder.file("rest.toml"), bow + "static = true\n");
    const Finished rest = ran({"deform", folder.file("rest.toml")});
    const auto still = columns_of(rest.out);
    CHECK(still.size() == 1 + 4 * 4 + 2);
    // By hand: 3 F / (4 (3 alpha + 36 beta)) for both free points, 3/4 of it at the loaded one.
    CHECK(number(still, "dy1_m", 0) == Approx(-0.015625).epsilon(1e-12));
    CHECK(number(still, "dy2_m", 0) == Approx(-0.015625).epsilon(1e-12));
    CHECK(number(still, "cy_m", 0) == Approx(0.0375 - 0.75 * 0.015625).epsilon(1e-12));
    CHECK(number(still, "vx1_m_per_s", 0) == 0.0);
    CHECK(still.at("t_s").at(0) == "inf");

    // Both free points move as one mass: m y'' + g y' + k y = F r, a damped oscillation from rest.
    // Their form 3 u (1 - u) has the square integral 3/10, and k is as above.
    const double m = 0.1 * 0.3;
    const double g = 0.5 * 0.3;
    const double k = 3.0 * 10.0 + 36.0 * 0.5;
    const double decay = g / (2.0 * m);
    const double turn = std::sqrt(k / m - decay * decay);
    const auto exact = [&](double t) {
        return -0.015625 * (1.0 - std::exp(-decay * t) *
                                      (std::cos(turn * t) + decay / turn * std::sin(turn * t)));
    };
    write(folder.file("motion.toml"), bow + "dt_s = 0.0001\n");
    const Finished motion = ran({"deform", folder.file("motion.toml"), "--times",
                                 "0,0.02,0.05005,0.1", "-o", folder.file("out.csv")});
    const auto moved = columns_of(slurp(folder.file("out.csv")));
    CHECK(number(moved, "dy1_m", 0) == 0.0);
    for (std::size_t row = 1; row < 4; ++row) {
        const double t = number(moved, "t_s", row);
        CAPTURE(t);
        CHECK(number(moved, "dy1_m", row) == Approx(exact(t)).epsilon(1e-4));
        CHECK(number(moved, "dx1_m", row) == Approx(0.0).margin(1e-15));
        CHECK(number(moved, "cy_m", row) == Approx(0.0375 + 0.75 * exact(t)).epsilon(1e-5));
    }

    const auto refused = [&](const std::string& text, const Words& words,
                             const std::string& sentence) {
        write(folder.file("wrong.toml"), text);
        const Words line = joined({"deform", folder.file("wrong.toml")}, words);
        CAPTURE(sentence);
        const Finished run = ran(line, 2);
        CHECK(run.out.empty());
        CHECK_THAT(run.error, Has(sentence));
    };
    const Words some{"--times", "0.1"};
    refused(bow + "free_weights = true\n", some,
            "wrong.toml:11:16: free_weights is true: weights cannot be");
    refused(bow + "mass = 1\n", some, "wrong.toml:11:1: ");
    refused(bow, {}, "give --times");
    refused(bow + "static = true\n", some, "leave out one");
    refused(bow, {"--times", "0.1,0.1"}, "each more than the one before");
    refused(bow, {"--times", "0.1,x"}, "\"x\"");
    refused(bow, {"--times", "1e9"}, "a larger dt_s");
    const auto with = [&](const std::string& from, const std::string& to) {
        return replaced(bow, from, to);
    };
    refused(with("beta = 0.5", "beta = 1e308"), some, "give 0 to 1000000000");
    refused(with("fixed = [0, 3]", "fixed = [0, 4]"), some, "wrong.toml:8:9: ");
    refused(with("fixed = [0, 3]", "fixed = [0.5]"), some, "whole numbers");
    refused(with("at_u = 0.5", "at_u = 1.5"), some, "the knots go from 0 to 1");
    refused(with("mu = 0.1 ", "# "), some, "a motion needs mass");
    refused(with("fixed = [0, 3]", "fixed = []") + "static = true\n", {}, "fixed leaves a motion");
}

TEST_CASE("palpate render presses a soft object to where palpate deform has it at rest",
          "[cli][soft][law]") {
    EACH(soft, 0.0004, 0.002);
    const TemporaryFolder folder;
    const auto scene = [&](double compliance) {
        const std::string file = folder.file(fmt::format("{}.toml", compliance));
        write(file,
              fmt::format("[renderer]\nstiffness_n_per_m = 800.0\ncompliance_m_per_n = {}\n"
                          "[friction]\nlaw = \"coulomb\"\nmu_d = 10.0\n",
                          compliance) +
                  "[[segment]]\nkind = \"line\"\nfrom_m = [-0.04, 0.0]\nto_m = [0.0, 0.04]\n"
                  "[[segment]]\nkind = \"line\"\nfrom_m = [0.0, 0.04]\nto_m = [0.04, 0.0]\n"
                  "[[segment]]\nkind = \"line\"\nfrom_m = [0.04, 0.0]\nto_m = [-0.04, 0.0]\n");
        return file;
    };
    // Down the normal in the middle of A-V to 4 mm below it in a second, and there for another.
    std::string path = "t_s,x_m,y_m\n";
    for (int k = 0; k < 2000; ++k) {
        const double way = (0.001 - 0.005 * std::min(1.0, 1e-3 * k)) / std::sqrt(2.0);
        path += fmt::format("{},{},{}\n", 1e-3 * k, -0.02 - way, 0.02 + way);
    }
    write(folder.file("t.csv"), path);
    const auto pressed = [&](double compliance) {
        ran({"render", scene(compliance), folder.file("t.csv"), "-o", folder.file("o.csv")});
        return columns_of(slurp(folder.file("o.csv")));
    };
    const auto rigid = pressed(0.0);
    const auto csv = pressed(soft);
    const std::size_t last = csv.at("t_s").size() - 1;
    for (std::size_t i = 0; i <= last; ++i) {
        REQUIRE(number(csv, "fn_n", i) <= number(rigid, "fn_n", i) + 1e-9);
    }
    CHECK(csv.at("mode").at(last) == "STUCK");
    CHECK(number(rigid, "fn_n", last) == Approx(3.2).epsilon(1e-9));
    // The two lines as one curve with a kink, its control points over the mean of three knots each.
    const std::vector<double> places{0.0,       1.0 / 15, 0.2, 0.4, 0.6, 0.8,       14.0 / 15, 1.0,
                                     16.0 / 15, 1.2,      1.4, 1.6, 1.8, 29.0 / 15, 2.0};
    std::string points;
    for (const double u : places) {
        points += fmt::format("{}[{}, {}]", points.empty() ? "" : ", ", 0.04 * (u - 1.0),
                              0.04 * (1.0 - std::fabs(u - 1.0)));
    }
    write(
        folder.file("c.toml"),
        fmt::format("degree = 3\nknots = [0, 0, 0, 0, 0.2, 0.4, 0.6, 0.8, 1, 1, 1, 1.2, 1.4, 1.6, "
                    "1.8, 2, 2, 2, 2]\npoints_m = [{}]\nalpha = {}\nbeta = {}\nfixed = [0, 14]\n"
                    "force_n = [{}, {}]\nat_u = 0.5\nstatic = true\n",
                    points, 0.5 / soft, 0.5 / soft / 400.0, -number(csv, "fx_n", last),
                    -number(csv, "fy_n", last)));
    const Finished deformed = ran({"deform", folder.file("c.toml")});
    const auto rest = columns_of(deformed.out);
    CHECK(number(rest, "cx_m", 0) == Approx(number(csv, "go_x_m", last)).margin(1e-8));
    CHECK(number(rest, "cy_m", 0) == Approx(number(csv, "go_y_m", last)).margin(1e-8));
}
