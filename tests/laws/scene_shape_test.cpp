#include "tests/support/program.hpp"
#include "tests/support/scene_text.hpp"

// Scenes whose inside nobody can tell are refused by both commands that read them, at their place.

using engine::Vec2;

namespace {

/// Lines from corner to corner and back, clockwise; the last ends at `last`.
std::string lines_through(std::vector<Vec2> corners, const Vec2& last) {
    corners.push_back(last);
    return lines_text(corners);
}

/// What both commands say of a scene; empty where they take it.
void both_say(const std::string& scene, const std::string& sentence, const std::string& points) {
    const TemporaryFolder folder;
    write(folder.file("s.toml"), scene);
    write(folder.file("p.csv"), points);
    for (const std::string command : {"render", "closest"}) {
        const Finished done = palpate_command({command, folder.file("s.toml"), folder.file("p.csv"),
                                               "-o", folder.file(command + ".csv")});
        CAPTURE(command, scene, done.error, sentence);
        if (sentence.empty()) {
            CHECK(done.code == 0);
            CHECK(done.error.empty());
            continue;
        }
        check_end(done, 2, Has(folder.file("s.toml") + ":" + sentence));
        CHECK(folder.names() == Words{"p.csv", "s.toml"});
    }
}

constexpr const char* kPlanePoints = "t_s,x_m,y_m\n0,0.2,0.2\n0.001,0.2,0.19\n";
constexpr const char* kSpacePoints = "t_s,x_m,y_m,z_m\n0,0.2,0.2,0.2\n0.001,0.2,0.19,0.2\n";

/// Clockwise corners round the origin, `size` m about.
std::vector<Vec2> ring(Random& random, std::size_t corners, double size) {
    std::vector<Vec2> ring;
    for (std::size_t i = 0; i < corners; ++i) {
        const double angle =
            -6.28 * (static_cast<double>(i) + random.in(0.0, 0.6)) / static_cast<double>(corners);
        const double radius = size * random.in(0.6, 1.0);
        ring.push_back(Vec2{radius * std::cos(angle), radius * std::sin(angle)});
    }
    return ring;
}

}  // namespace

TEST_CASE("an outline is closed or clearly open: what nearly closes is refused where it ends") {
    SEEDED(random, 4U, 2904U);
    const double size = random.decade(-2.0, -1.0);
    const std::vector<Vec2> corners = ring(random, 3 + seed, size);
    const double heading = random.in(0.0, 6.28);
    const Vec2 away{std::cos(heading), std::sin(heading)};
    const auto with_gap = [&](double gap) {
        return lines_through(corners, corners.front() + gap * away);
    };
    const std::string place = fmt::format("{}:1: ", 4 * corners.size() - 3);
    for (const double gap : {2e-9, 1e-7, 1e-4 * size}) {
        both_say(with_gap(gap), place + "the outline is open: its last segment ends ",
                 kPlanePoints);
    }
    both_say(with_gap(0.0), "", kPlanePoints);
    both_say(with_gap(0.3 * size), "", kPlanePoints);
}

TEST_CASE("an outline that crosses itself is refused with the place of the crossing") {
    SEEDED(random, 4U, 2905U);
    const double size = random.decade(-1.7, -1.0);
    std::vector<Vec2> corners = ring(random, 6, size);
    both_say(lines_through(corners, corners.front()), "", kPlanePoints);
    // Two neighbours change places: the edges that lead to them and away from them cross.
    const auto first = random.index(4);
    std::swap(corners[first + 1], corners[first + 2]);
    const std::string meets = "1:1: the outline meets itself near [";
    both_say(lines_through(corners, corners.front()), meets, kPlanePoints);
    std::reverse(corners.begin(), corners.end());  // whichever way round it runs
    both_say(lines_through(corners, corners.front()), meets, kPlanePoints);
    // An open one: a zigzag whose second line comes back over the first.
    const double x = size * random.in(0.2, 0.8);
    const std::vector<Vec2> zigzag{{-size, 0.0}, {size, 0.8 * size}, {x, -0.5 * size}};
    both_say(lines_through(zigzag, {x, 2.0 * size}), meets, kPlanePoints);
    both_say(lines_through(zigzag, {1.5 * size, -0.4 * size}), "", kPlanePoints);
}

TEST_CASE("curves that cross beside their vertex are refused, however near to each other") {
    // Out along the axis and back below it: where the way back begins above the axis and crosses
    // it, half a micrometre or less lies between, but a wedge beyond the tip, of any length, would
    // push a hand in free air.
    const auto spike = [](double bend) {
        return line_text({-0.03, 0.0}, {0.03, 0.0}) +
               segment_text(bezier_data({{0.03, 0.0}, {0.0275, bend}, {-0.03, -0.02}})) +
               line_text({-0.03, -0.02}, {-0.03, 0.0});
    };
    both_say(spike(-1e-4), "", kPlanePoints);
    for (const double bend : {3e-4, 1e-4, 1e-5, 1e-6}) {
        both_say(spike(bend), "1:1: the outline meets itself near [", kPlanePoints);
    }
}

TEST_CASE("a surface with a collapsed span is refused, however it lies in space") {
    SEEDED(random, 4U, 2906U);
    // Rows of two points; the second row repeats the first where it is asked to.
    const bool full_knots = seed % 2U == 1U;
    const auto scene = [&](std::size_t repeated) {
        SurfaceData sheet{.knots_v = {0, 0, 1, 1}};
        sheet.knots_u = full_knots ? std::vector<double>{0, 0, 1, 2, 3, 3}
                                   : std::vector<double>{0, 0, 0.5, 1, 1};
        for (std::size_t i = 0; i + 2 < sheet.knots_u.size(); ++i) {
            const double x = 0.03 * static_cast<double>(i);
            const auto p = [&] {
                return random.in(-0.002, 0.002);
            };
            sheet.points.push_back(i > 0 && i == repeated
                                       ? sheet.points.back()
                                       : std::vector<engine::Vec3>{{x, p(), p()}, {x, 0.05, p()}});
        }
        return surface_text(sheet);
    };
    both_say(scene(1), "1:1: [[surface]] 1: the patch with u from 0 to ", kSpacePoints);
    both_say(scene(0), "", kSpacePoints);
}

TEST_CASE("what is wrong with a scene is said at its place, and what its law does not read") {
    for (const auto& row : test_rows("scene_problems.tsv")) {
        both_say(row.at(0), row.at(1), kPlanePoints);
    }
    // What no object can be made of is refused by render, as in a protocol.
    const TemporaryFolder folder;
    write(folder.file("p.csv"), kPlanePoints);
    for (const auto& row : test_rows("no_object_problems.tsv")) {
        write(folder.file("s.toml"), row.at(0));
        CAPTURE(row);
        check_end(palpate_command({"render", folder.file("s.toml"), folder.file("p.csv")}), 2,
                  Has(folder.file("s.toml") + ":" + row.at(1)));
    }
}

TEST_CASE("deform warns once, on standard error, of a step beyond the motion") {
    const TemporaryFile file("c.toml");
    // Both free points move as one (offline_tools_test.cpp): omega = sqrt(48 / 0.03) = 40 rad/s.
    const std::string bow =
        "degree = 3\nknots = [0, 0, 0, 0, 1, 1, 1, 1]\n"
        "points_m = [[0, 0], [0.03, 0.05], [0.07, 0.05], [0.1, 0]]\nmu = 0.1\ngamma = 0.5\n"
        "alpha = 10.0\nbeta = 0.5\nfixed = [0, 3]\nforce_n = [0.0, -1.0]\nat_u = 0.5\n";
    for (const double step : {0.024, 0.026, 10.0}) {
        CAPTURE(step);
        write(file, bow + fmt::format("dt_s = {}\n", step));
        const Finished done = ran({"deform", file, "--times", "50,100"});
        CHECK_THAT(done.out, !Has("warn"));
        if (step < 1.0 / 40.0) {
            CHECK(done.error.empty());
            continue;
        }
        CHECK_THAT(done.error, Has(fmt::format("dt_s is {} s", step), "1/omega = 0.025 s"));
        CHECK(std::count(done.error.begin(), done.error.end(), '\n') == 1);
    }
}

TEST_CASE("a walk that breaks off beside the centre of a sphere is unproven, and not held",
          "[cli][surface][law]") {
    const double radius = 0.05;
    const double c = std::cos(0.4);
    const double s = std::sin(0.4);
    const std::vector<double> knots{0, 0, 0, 1, 1, 1};
    SurfaceData patch{.degree_u = 2, .degree_v = 2, .knots_u = knots, .knots_v = knots};
    for (const int i : {-1, 0, 1}) {  // the exact patch, its middle in the origin
        const double x = i * radius * s;
        const double r = i == 0 ? radius / c : radius * c;
        const double outer = i == 0 ? c : 1.0;
        patch.points.push_back(
            {{x, -r * s, r * c - radius}, {x, 0.0, r / c - radius}, {x, r * s, r * c - radius}});
        patch.weights.push_back({outer, outer * c, outer});
    }
    std::string path = "t_s,x_m,y_m,z_m\n";
    for (int k = 0; k < 400; ++k) {  // in, and about the centre
        const double about = k < 200 ? 0.0 : 1e-8;
        path += fmt::format("{},{},{},{}\n", 1e-3 * k, k < 200 ? 0.001 : about * std::sin(7.0 * k),
                            k < 200 ? 0.002 : about * std::cos(5.0 * k),
                            k < 200 ? 0.01 - 0.0003 * k : -radius + about * std::sin(3.0 * k));
    }
    const std::string scene = "[friction]\nlaw = \"frictionless\"\n" + surface_text(patch);
    int unproven = 0;
    for (const Words& tick : csv_body(said_of("render", scene, path))) {
        CAPTURE(tick[0]);
        CHECK_FALSE((tick[16] == "1" && tick[18] == "1"));
        unproven += tick[18] == "1" ? 1 : 0;
    }
    CHECK(unproven > 0);
}
