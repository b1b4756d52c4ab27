#include "tests/support/arc_oracle.hpp"
#include "tests/support/foot_oracle.hpp"
#include "tests/support/program.hpp"
#include "tests/support/scene_text.hpp"

namespace {

const std::string kContact = test_text("scenes/contact.toml");

/// Row i of a column.
double number(const Columns& csv, const std::string& column, std::size_t row) {
    return csv.at(column).at(row);
}

}  // namespace

TEST_CASE("palpate render gives the forces of plane trigonometry on an arc") {
    EACH(kappa, 12.0, 0.0, -12.0);
    const std::string scene = kContact + arc_text({-0.05, 0.0}, {0.05, 0.0}, kappa);
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
    const std::string out = said_of("render", scene, path);
    REQUIRE_THAT(out, StartsWith("t_s,mode,segment,u,cp_x_m,cp_y_m,go_x_m,"
                                 "go_y_m,fn_n,ft_n,fx_n,fy_n,held,slewed,unproven\n"));
    const auto csv = columns_in(out);
    REQUIRE(csv.at("t_s").size() == hips.size());
    double worst = 0.0;
    double worst_cp = 0.0;
    for (std::size_t i = 0; i < hips.size(); ++i) {
        const Vec2 force = oracle.tick(hips[i]);
        const Vec2 got{number(csv, "fx_n", i), number(csv, "fy_n", i)};
        worst = std::max(worst, glm::length(got - force));
        const double fn = number(csv, "fn_n", i);
        const double ft = number(csv, "ft_n", i);
        worst = std::max(worst, std::fabs(std::hypot(fn, ft) - glm::length(force)));
        const Vec2 cp{number(csv, "cp_x_m", i), number(csv, "cp_y_m", i)};
        worst_cp = std::max(worst_cp, glm::length(cp - arc.closest(hips[i]).point));
    }
    CHECK(worst < 1e-9);
    CHECK(worst_cp < 1e-12);
    for (const char* mode : {"FREE", "STUCK", "SLIP", "TRANSITION"}) {
        CHECK_THAT(out, Has(fmt::format(",{},", mode)));
    }
}

TEST_CASE("palpate closest answers for separate curves like an oracle that proves its distance") {
    SEEDED(random, 6U);
    std::string scene;
    std::vector<FootOracle> oracles;
    for (int i = 0; i < 3; ++i) {
        const auto data = random_nurbs<2>(random, 0.1, 1.0);
        oracles.emplace_back(data);
        scene += segment_text(data);
    }
    std::string table = "x_m,y_m\n";
    std::vector<Vec2> points;
    for (int i = 0; i < 60; ++i) {
        points.push_back(random.point(-0.1, 0.1));
        table += fmt::format("{},{}\n", points.back().x, points.back().y);
    }
    const auto csv = columns_in(said_of("closest", scene, table));
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

TEST_CASE("palpate closest says of a point of a surface whether its search was broken off") {
    // Weights of 1e-3 beside 1e3 bend the patch into valleys that cost too much; found by search.
    for (const bool bent : {false, true}) {
        SurfaceData patch{.degree_v = 2, .knots_u = {0, 0, 1, 1}, .knots_v = {0, 0, 0, 1, 1, 1}};
        patch.points = {{{0.01, 0, -0.02}, {0.01, 0.06, -0.02}, {-0.02, 0.1, -0.02}},
                        {{0.05, -0.02, -0.02}, {0.06, 0.05, 0}, {0.06, 0.11, 0.04}}};
        patch.weights = {{1, bent ? 1000.0 : 1.0, bent ? 0.001 : 1.0},
                         {1, bent ? 0.001 : 1.0, bent ? 1000.0 : 1.0}};
        const std::string scene = kContact + surface_text(patch);
        const auto csv = columns_in(said_of("closest", scene, "x_m,y_m,z_m\n0.058,0.108,0.0376\n"));
        CHECK(number(csv, "unproven", 0) == (bent ? 1.0 : 0.0));
    }
}

TEST_CASE(
    "a wrong scene or table gets file, line, value and remedy, exit code 2, and no output file") {
    const TemporaryFolder folder;
    const std::string good = kContact + R"(
[[segment]]
kind = "line"
from_m = [0.0, 0.0]
to_m = [0.1, 0.0]
)";
    const std::string path = "t_s,x_m,y_m\n0,0.05,0.01\n0.001,0.05,0.0\n";
    const auto changed = [](const std::string& text, const Words& row) {
        return text.find(row.at(0)) == std::string::npos ? text
                                                         : replaced(text, row.at(0), row.at(1));
    };
    for (const auto& row : test_rows("render_problems.tsv")) {
        CAPTURE(row);
        write(folder.file("s.toml"), changed(good, row));
        write(folder.file("t.csv"), changed(path, row));
        check_end(palpate_command({"render", folder.file("s.toml"), folder.file("t.csv"), "-o",
                                   folder.file("o.csv")}),
                  2, Has(row.at(2), row.at(3)));
        CHECK(folder.names() == Words{"s.toml", "t.csv"});
    }
}

TEST_CASE(
    "palpate deform says where a bow is over time and at rest, with a column for each number") {
    const TemporaryFolder folder;
    // As docs/protocol.md shows it.
    const std::string page = slurp(PALPATE_SOURCE_DIR "/docs/protocol.md");
    const std::string bow =
        "degree = 3" +
        behind(behind(page, "**Curves that yield**", "## Every key"), "degree = 3", "dt_s");
    write(folder.file("rest.toml"), bow + "static = true\n");
    const auto still = columns_in(ran({"deform", folder.file("rest.toml")}).out);
    CHECK(still.size() == 1 + 4 * 4 + 2);
    // By hand: 3 F / (4 (3 alpha + 36 beta)) for both free points, 3/4 of it at the loaded one.
    CHECK(number(still, "dy1_m", 0) == Approx(-0.015625).epsilon(1e-12));
    CHECK(number(still, "dy2_m", 0) == Approx(-0.015625).epsilon(1e-12));
    CHECK(number(still, "cy_m", 0) == Approx(0.0375 - 0.75 * 0.015625).epsilon(1e-12));
    CHECK(number(still, "vx1_m_per_s", 0) == 0.0);
    CHECK(std::isinf(number(still, "t_s", 0)));

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
    ran({"deform", folder.file("motion.toml"), "--times", "0,0.02,0.05005,0.1", "-o",
         folder.file("out.csv")});
    const auto moved = columns_in(slurp(folder.file("out.csv")));
    CHECK(number(moved, "dy1_m", 0) == 0.0);
    for (std::size_t row = 1; row < 4; ++row) {
        const double t = number(moved, "t_s", row);
        CAPTURE(t);
        CHECK(number(moved, "dy1_m", row) == Approx(exact(t)).epsilon(1e-4));
        CHECK(number(moved, "dx1_m", row) == Approx(0.0).margin(1e-15));
        CHECK(number(moved, "cy_m", row) == Approx(0.0375 + 0.75 * exact(t)).epsilon(1e-5));
    }

    for (const auto& row : test_rows("deform_problems.tsv")) {
        CAPTURE(row);
        write(folder.file("wrong.toml"), replaced(bow, row.at(1), row.at(2)) + row.at(0));
        refused(words_of("deform", folder.file("wrong.toml") + " " + row.at(3)), row.at(4));
    }
    write(folder.file("light.toml"), replaced(bow, "mu = 0.1 ", "mu = 1e-310 "));
    CHECK_THAT(ran({"deform", folder.file("light.toml"), "--times", "0.1"}).error,
               Has("1/omega = ", "e-157 s"));
}

TEST_CASE("palpate render presses a soft object to where palpate deform has it at rest") {
    EACH(soft, 0.0004, 0.002);
    const TemporaryFolder folder;
    const auto scene = [&](double compliance) {
        const std::string file = folder.file(fmt::format("{}.toml", compliance));
        write(file, fmt::format("[renderer]\nstiffness_n_per_m = 800.0\ncompliance_m_per_n = {}\n"
                                "[friction]\nlaw = \"coulomb\"\nmu_d = 10.0\n",
                                compliance) +
                        lines_text({{-0.04, 0.0}, {0.0, 0.04}, {0.04, 0.0}, {-0.04, 0.0}}));
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
        return columns_in(slurp(folder.file("o.csv")));
    };
    const auto rigid = pressed(0.0);
    const auto csv = pressed(soft);
    const std::size_t last = csv.at("t_s").size() - 1;
    for (std::size_t i = 0; i <= last; ++i) {
        REQUIRE(number(csv, "fn_n", i) <= number(rigid, "fn_n", i) + 1e-9);
    }
    CHECK_THAT(slurp(folder.file("o.csv")), Has("\n1.999,STUCK,"));
    CHECK(number(rigid, "fn_n", last) == Approx(3.2).epsilon(1e-9));
    // The two lines as one curve with a kink, its control points over the mean of three knots each.
    const std::vector<double> places{0.0,       1.0 / 15, 0.2, 0.4, 0.6, 0.8,       14.0 / 15, 1.0,
                                     16.0 / 15, 1.2,      1.4, 1.6, 1.8, 29.0 / 15, 2.0};
    std::vector<Vec2> points;
    for (const double u : places) {
        points.push_back(0.04 * Vec2{u - 1.0, 1.0 - std::fabs(u - 1.0)});
    }
    write(
        folder.file("c.toml"),
        fmt::format("degree = 3\nknots = [0, 0, 0, 0, 0.2, 0.4, 0.6, 0.8, 1, 1, 1, 1.2, 1.4, 1.6, "
                    "1.8, 2, 2, 2, 2]\npoints_m = {}\nalpha = {}\nbeta = {}\nfixed = [0, 14]\n"
                    "force_n = [{}, {}]\nat_u = 0.5\nstatic = true\n",
                    toml_of(points), 0.5 / soft, 0.5 / soft / 400.0, -number(csv, "fx_n", last),
                    -number(csv, "fy_n", last)));
    const auto rest = columns_in(ran({"deform", folder.file("c.toml")}).out);
    CHECK(number(rest, "cx_m", 0) == Approx(number(csv, "go_x_m", last)).margin(1e-8));
    CHECK(number(rest, "cy_m", 0) == Approx(number(csv, "go_y_m", last)).margin(1e-8));
}
