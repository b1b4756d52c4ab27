#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/surfaces.hpp"

// What `palpate render` writes of ticks in which nothing is felt.

using namespace palpate;
using tests::Finished;
using tests::palpate_command;
using tests::Random;
using tests::TemporaryFolder;
using tests::write;

namespace {

/// A line of words after the other, without the head.
std::vector<std::vector<std::string>> words_of(const std::string& csv) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(csv);
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
        std::istringstream fields(line);
        auto& row = rows.emplace_back();
        for (std::string field; std::getline(fields, field, ',');) {
            row.push_back(field);
        }
    }
    return rows;
}

std::string answer(const std::string& command, const std::string& scene, const std::string& data) {
    const TemporaryFolder folder;
    write(folder.file("s.toml"), scene);
    write(folder.file("d.csv"), data);
    const Finished done = palpate_command({command, folder.file("s.toml"), folder.file("d.csv")});
    CAPTURE(done.error);
    REQUIRE(done.code == 0);
    return done.out;
}

constexpr const char* kRubs = "[friction]\nlaw = \"gos\"\nmu_s = 0.6\nmu_d = 0.4\n";

/// A bow of one convex piece, its ends on y = 0, with another bow beside it: a closest point that jumps.
std::string bows(Random& random) {
    const auto p = [&](double x, double y) {
        return fmt::format("[{}, {}]", x + random.in(-2e-3, 2e-3), y + random.in(-2e-3, 2e-3));
    };
    const std::string middle = p(0.0, 0.0);
    const auto nurbs = [](const std::string& points) {
        return "[[segment]]\nkind = \"nurbs\"\ndegree = 3\nknots = [0, 0, 0, 0, 1, 1, 1, 1]\n"
               "points_m = [" +
               points + "]\n";
    };
    return nurbs(fmt::format("{}, {}, {}, {}", p(-0.06, 0.0), p(-0.05, 0.03), p(-0.02, 0.04),
                             middle)) +
           nurbs(fmt::format("{}, {}, {}, {}", middle, p(0.02, 0.03), p(0.05, 0.03), p(0.07, 0.0)));
}

std::string sheet(Random& random) {
    const tests::SurfaceData d = tests::bicubic_8x8(random, 0.0);
    std::vector<std::string> rows;
    for (const auto& row : d.points) {
        std::vector<std::string> points;
        for (const engine::Vec3& p : row) {
            points.push_back(fmt::format("[{}, {}, {}]", p.x, p.y, p.z));
        }
        rows.push_back(fmt::format("[{}]", fmt::join(points, ", ")));
    }
    return fmt::format(
        "[[surface]]\ndegree_u = 3\ndegree_v = 3\nknots_u = [{0}]\nknots_v = [{0}]\npoints_m = "
        "[{1}]\n",
        fmt::join(d.knots_u, ", "), fmt::join(rows, ", "));
}

}  // namespace

TEST_CASE("out of contact render's god-object is the closest point, as `palpate closest` finds it",
          "[cli][law]") {
    const auto seed = GENERATE(range(0U, 6U));
    const bool space = seed % 2U == 1U;
    CAPTURE(seed, space);
    Random random(seed + 2900U);
    const std::string scene = kRubs + (space ? sheet(random) : bows(random));
    // Above the object, far and near, now and then into it.
    const double phase = random.in(0.0, 6.0);
    std::string path = space ? "t_s,x_m,y_m,z_m\n" : "t_s,x_m,y_m\n";
    constexpr std::size_t kTicks = 1500;
    for (std::size_t k = 0; k < kTicks; ++k) {
        const double t = 1e-3 * static_cast<double>(k);
        const double x = 0.04 * std::sin(4.0 * t + phase);
        const double height = 0.05 + 0.04 * std::sin(7.0 * t);
        path += space ? fmt::format("{},{},{},{}\n", t, x, 0.03 * std::cos(3.0 * t), height - 0.02)
                      : fmt::format("{},{},{}\n", t, x, height);
    }
    const auto felt = words_of(answer("render", scene, path));
    const auto near = words_of(answer("closest", scene, path));
    REQUIRE(felt.size() == kTicks);
    REQUIRE(near.size() == kTicks);
    const std::size_t dimension = space ? 3 : 2;
    const std::size_t go = 2 + (space ? 3 : 2) + dimension;
    std::size_t free = 0;
    double worst = 0.0;
    for (std::size_t k = 0; k < kTicks; ++k) {
        if (felt[k][1] != "FREE") {
            continue;
        }
        ++free;
        for (std::size_t i = 0; i < dimension; ++i) {
            const double found = std::stod(near[k][1 + (space ? 2 : 1) + i]);
            worst = std::max(worst, std::fabs(std::stod(felt[k][go + i]) - found));
        }
    }
    CHECK(free > kTicks / 3);
    CHECK(free < kTicks);
    CHECK(worst < 1e-10);
}
