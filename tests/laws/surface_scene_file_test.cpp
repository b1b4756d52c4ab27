#include "tests/support/program.hpp"
#include "tests/support/random.hpp"

namespace {

const std::string kFelt = test_text("scenes/felt.toml");

/// x from `from` to `to`, y from -0.05 to 0.05, z = slope x.
std::string plate(double from, double to, double slope, const std::string& more = "") {
    return fmt::format(
        "[[surface]]\ndegree_u = 1\ndegree_v = 1\nknots_u = [0, 0, 1, 1]\nknots_v = [0, 0, 1, 1]\n"
        "points_m = [[[{0}, -0.05, {1}], [{0}, 0.05, {1}]], [[{2}, -0.05, {3}], [{2}, 0.05, "
        "{3}]]]\n{4}",
        from, slope * from, to, slope * to, more);
}

/// Rows of numbers; of a word 0.
std::vector<std::vector<double>> rows_of(const std::string& csv) {
    std::vector<std::vector<double>> rows;
    for (const auto& fields : csv_body(csv)) {
        auto& row = rows.emplace_back();
        for (const std::string& field : fields) {
            const bool number = field.find_first_of("0123456789") != std::string::npos;
            row.push_back(number ? std::stod(field) : 0.0);
        }
    }
    return rows;
}

}  // namespace

TEST_CASE("a plate in two tables, and one cut by its trims, are felt as the plate in one",
          "[cli][surface][law]") {
    Random random(20261123);
    const double slope = GENERATE(0.0, 0.3);
    std::string path = "t_s,x_m,y_m,z_m\n";
    for (int k = 0; k < 1500; ++k) {  // over the joint and back, pressed now and then
        const double x = 0.03 * std::sin(0.01 * k);
        const double y = 0.03 * std::cos(0.007 * k) + random.in(-1e-4, 1e-4);
        path += fmt::format("{},{},{},{}\n", 1e-3 * k, x, y,
                            slope * x + 0.002 - 0.004 * std::sin(0.02 * k));
    }
    const auto whole = rows_of(said_of("render", kFelt + plate(-0.04, 0.04, slope), path));
    const auto two = rows_of(
        said_of("render", kFelt + plate(-0.04, 0.01, slope) + plate(0.01, 0.04, slope), path));
    const auto cut =
        rows_of(said_of("render",
                        kFelt + plate(-0.04, 0.04, slope,
                                      "trim_loops = [[0, 0, 0.4, 0, 1, 0, 1, 0.7, 1, 1, 0, 1]]\n"),
                        path));
    REQUIRE(whole.size() == 1500);
    REQUIRE(two.size() == 1500);
    REQUIRE(cut.size() == 1500);
    constexpr std::size_t kSegment = 2;
    constexpr std::size_t kCp = 5;  // and go, fn, ft, force: to column 15
    bool on_second = false;
    double worst = 0.0;
    double max = 0.0;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        on_second = on_second || two[i][kSegment] == 1.0;
        CHECK(cut[i][kSegment] == 0.0);
        max = std::max(max, whole[i][11]);
        for (std::size_t k = kCp; k < 16; ++k) {
            worst = std::max(
                {worst, std::fabs(whole[i][k] - two[i][k]), std::fabs(whole[i][k] - cut[i][k])});
        }
    }
    CHECK(on_second);
    CHECK(max > 1.0);
    CHECK(worst < 1e-10);
}

TEST_CASE("over a hole the closest point lies on its border", "[cli][surface][law]") {
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
    const auto found = rows_of(said_of("closest", scene, points));
    REQUIRE(found.size() == wanted.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        CHECK(found[i].end()[-2] == Approx(wanted[i]).epsilon(1e-12));
        CHECK(found[i].back() == 0.0);  // unproven
    }
}

TEST_CASE("surfaces that cannot be one object are refused with value and remedy",
          "[cli][surface]") {
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
