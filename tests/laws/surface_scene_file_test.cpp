#include "tests/support/program.hpp"
#include "tests/support/scene_text.hpp"

namespace {

const std::string kFelt = test_text("scenes/felt.toml");

/// x from `from` to `to`, y from -0.05 to 0.05, z = slope x.
std::string plate(double from, double to, double slope, const std::string& more = "") {
    const auto border = [slope](double x) {
        return std::vector<engine::Vec3>{{x, -0.05, slope * x}, {x, 0.05, slope * x}};
    };
    return plate_text(border(from), border(to)) + more;
}

}  // namespace

TEST_CASE("a plate in two tables, and one cut by its trims, are felt as the plate in one") {
    Random random(20261123);
    const double slope = GENERATE(0.0, 0.3);
    std::string path = "t_s,x_m,y_m,z_m\n";
    for (int k = 0; k < 1500; ++k) {  // over the joint and back, pressed now and then
        const double x = 0.03 * std::sin(0.01 * k);
        const double y = 0.03 * std::cos(0.007 * k) + random.in(-1e-4, 1e-4);
        path += fmt::format("{},{},{},{}\n", 1e-3 * k, x, y,
                            slope * x + 0.002 - 0.004 * std::sin(0.02 * k));
    }
    const auto felt = [&](const std::string& plates) {
        return columns_in(said_of("render", kFelt + plates, path));
    };
    const Columns whole = felt(plate(-0.04, 0.04, slope));
    const Columns two = felt(plate(-0.04, 0.01, slope) + plate(0.01, 0.04, slope));
    const Columns cut = felt(
        plate(-0.04, 0.04, slope, "trim_loops = [[0, 0, 0.4, 0, 1, 0, 1, 0.7, 1, 1, 0, 1]]\n"));
    REQUIRE(whole.at("t_s").size() == 1500);
    for (const std::string of : {"cp_x_m", "cp_y_m", "cp_z_m", "go_x_m", "go_y_m", "go_z_m", "fn_n",
                                 "ft_n", "fx_n", "fy_n", "fz_n"}) {
        CAPTURE(of);
        CHECK(apart(whole.at(of), two.at(of)) < 1e-10);
        CHECK(apart(whole.at(of), cut.at(of)) < 1e-10);
    }
    CHECK(std::ranges::count(two.at("segment"), 1.0) > 0);
    CHECK(std::ranges::count(cut.at("segment"), 0.0) == 1500);
    CHECK(std::ranges::max(whole.at("fn_n")) > 1.0);
}

TEST_CASE("over a hole the closest point lies on its border") {
    // The hole is -0.02 to 0.02 by -0.01 to 0.01.
    const std::string scene =
        plate(-0.05, 0.05, 0.0, "trim_loops = [[0.3, 0.4, 0.3, 0.6, 0.7, 0.6, 0.7, 0.4]]\n");
    Random random(7);
    std::string points = "x_m,y_m,z_m\n";
    std::vector<double> wanted;
    for (int k = 0; k < 200; ++k) {
        const double x = random.in(-0.04, 0.04);
        const double y = random.in(-0.04, 0.04);
        const double z = random.in(0.001, 0.03);
        points += fmt::format("{},{},{}\n", x, y, z);
        const double in_x = 0.02 - std::fabs(x);
        const double in_y = 0.01 - std::fabs(y);
        const bool over = in_x > 0.0 && in_y > 0.0;
        wanted.push_back(over ? std::hypot(std::min(in_x, in_y), z) : z);
    }
    const Columns found = columns_in(said_of("closest", scene, points));
    CHECK(apart(found.at("distance_m"), wanted) < 1e-15);
    CHECK(std::ranges::count(found.at("unproven"), 0.0) == 200);
}

TEST_CASE("surfaces that cannot be one object are refused with value and remedy") {
    const TemporaryFolder folder;
    write(folder.file("d.csv"), "x_m,y_m,z_m\n0,0,0.01\n");
    const auto refused = [&](const std::string& scene, const char* why) {
        write(folder.file("s.toml"), scene);
        CHECK_THAT(ran({"closest", folder.file("s.toml"), folder.file("d.csv")}, 2).error,
                   Has("s.toml:", why));
    };
    refused(plate(-0.04, 0.0, 0.0) + plate(0.00001, 0.04, 0.0), "are up to 1e-05 m apart");
    refused(plate(-0.04, 0.04, 0.0, "trim_loops = [[0, 0, 1, 0, 1, 1, 0.5]]\n"), "has 7 numbers");
    refused(plate(-0.04, 0.04, 0.0, "trim_loops = [[0, 0, 1, 0, 0.5, 1, 0, 1]]\n"),
            "goes from (1, 0) to (0.5, 1)");
    refused(plate(-0.04, 0.04, 0.0, "[surface]\n"), "surface");
}
