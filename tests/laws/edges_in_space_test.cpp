#include "tests/support/program.hpp"
#include "tests/support/random.hpp"

// An outline, and the same extruded along y: edges and corners of surfaces are felt as the plane's.

namespace {

using Corner = std::array<engine::Vec2, 3>;  ///< the middle one is the vertex

/// Two lines that meet in the origin, material to the right of the way: a wedge that points up, or
/// a groove between walls that rise.
Corner corner_of(bool wedge, double left, double right, double lean) {
    const auto along = [](double angle) {
        return 0.04 * engine::Vec2{std::sin(angle), std::cos(angle)};  // from the vertical
    };
    const double turn = wedge ? 3.14159265358979323846 : 0.0;
    return wedge ? Corner{along(lean + turn + left), engine::Vec2{}, along(lean + turn - right)}
                 : Corner{along(lean - left), engine::Vec2{}, along(lean + right)};
}

/// Left to right, and run through the other way.
Corner mirrored_corner(const Corner& c) {
    const auto aside = [](const engine::Vec2& p) {
        return engine::Vec2{-p.x, p.y};
    };
    return {aside(c[2]), aside(c[1]), aside(c[0])};
}

std::string in_plane(const Corner& c) {
    std::string all;
    for (std::size_t k = 0; k < 2; ++k) {
        all += fmt::format("[[segment]]\nkind = \"line\"\nfrom_m = [{}, {}]\nto_m = [{}, {}]\n",
                           c[k].x, c[k].y, c[k + 1].x, c[k + 1].y);
    }
    return all;
}

std::string in_space(const Corner& c) {
    std::string all;
    for (std::size_t k = 0; k < 2; ++k) {
        all += fmt::format(
            "[[surface]]\ndegree_u = 1\ndegree_v = 1\nknots_u = [0, 0, 1, 1]\nknots_v = [0, 0, 1, "
            "1]\npoints_m = [[[{0}, -0.04, {1}], [{0}, 0.04, {1}]], [[{2}, -0.04, {3}], [{2}, "
            "0.04, {3}]]]\n",
            c[k].x, c[k].y, c[k + 1].x, c[k + 1].y);
    }
    return all;
}

struct EdgeFelt {
    std::string mode;
    double fn, ft, fx, fy, held;
};

std::vector<EdgeFelt> edge_felt(const std::string& scene, const std::string& path, std::size_t cp) {
    std::vector<EdgeFelt> all;
    const std::size_t n = cp == 4 ? 2 : 3;  // axes
    for (const auto& row : csv_body(said_of("render", scene, path))) {
        const auto number = [&row](std::size_t column) {
            return std::stod(row.at(column));
        };
        const std::size_t force = cp + 2 * n;
        all.push_back({row.at(1), number(force), std::fabs(number(force + 1)), number(force + 2),
                       number(force + 1 + n), number(force + 2 + n)});
    }
    return all;
}

std::string law_of(Random& random, double mu) {
    switch (random.below(3)) {
        case 0:
            return "[friction]\nlaw = \"frictionless\"\n";
        case 1:
            return fmt::format("[friction]\nlaw = \"coulomb\"\nmu_d = {}\n", mu);
        default:
            return fmt::format("[friction]\nlaw = \"gos\"\nmu_s = {}\nmu_d = {}\n", mu, 0.6 * mu);
    }
}

/// t, x and z of a hand that goes to and fro over the vertex, then comes in at one side, goes on to
/// near the middle, and leaves upwards, again and again.
std::vector<std::array<double, 3>> edge_hand(Random& random) {
    double hz[4];
    double phase[4];
    for (std::size_t k = 0; k < 4; ++k) {
        hz[k] = random.in(0.5, 4.0);
        phase[k] = random.in(0.0, 6.0);
    }
    std::vector<std::array<double, 3>> path;
    const auto goes = [&path](double x, double z) {
        path.push_back({1e-3 * static_cast<double>(path.size()), x, z});
    };
    for (int k = 0; k < 2000; ++k) {
        const auto wave = [&](std::size_t w) {
            return std::sin(6.283185307179586e-3 * hz[w] * k + phase[w]);
        };
        goes(0.006 * wave(0) + 0.002 * wave(1), 0.006 * wave(2) + 0.002 * wave(3) - 0.002);
    }
    for (int stroke = 0; stroke < 12; ++stroke) {
        const double from = random.coin() ? 0.02 : -0.02;
        const double to = random.in(-0.003, 0.003);
        const double z = random.in(-0.008, -0.002);
        for (int k = 0; k < 60; ++k) {
            goes(from + (to - from) * k / 60.0, z);
        }
        for (int k = 0; k < 100; ++k) {
            goes(to, z + 1.6e-4 * k);
        }
    }
    return path;
}

/// A curve of degree 3 with two more points between its ends, and the same extruded.
struct WavySide {
    std::array<engine::Vec2, 6> points{};
    std::array<double, 6> weights{};

    [[nodiscard]] std::string in_plane() const {
        Words p;
        for (const engine::Vec2& q : points) {
            p.push_back(fmt::format("[{}, {}]", q.x, q.y));
        }
        return fmt::format(
            "[[segment]]\nkind = \"nurbs\"\ndegree = 3\nknots = [0, 0, 0, 0, 1, 2, 2.5, 2.5, 2.5, "
            "2.5]\npoints_m = [{}]\nweights = [{}]\n",
            fmt::join(p, ", "), fmt::join(weights, ", "));
    }
    [[nodiscard]] std::string in_space() const {
        Words p;
        Words w;
        for (std::size_t k = 0; k < points.size(); ++k) {
            const engine::Vec2& q = points[k];
            p.push_back(fmt::format("[[{0}, -0.2, {1}], [{0}, 0.2, {1}]]", q.x, q.y));
            w.push_back(fmt::format("[{0}, {0}]", weights[k]));
        }
        return fmt::format(
            "[[surface]]\ndegree_u = 3\ndegree_v = 1\nknots_u = [0, 0, 0, 0, 1, 2, 2.5, 2.5, 2.5, "
            "2.5]\nknots_v = [0, 0, 1, 1]\npoints_m = [{}]\nweights = [{}]\n",
            fmt::join(p, ", "), fmt::join(w, ", "));
    }
};

/// A clockwise outline of three to five wavy sides around the origin, some 40 mm away.
std::vector<WavySide> wavy(Random& random) {
    const auto n = static_cast<std::size_t>(3 + random.below(3));
    std::vector<engine::Vec2> corners;
    for (std::size_t k = 0; k < n; ++k) {
        const double turn =
            (static_cast<double>(k) + random.in(-0.2, 0.2)) / static_cast<double>(n);
        const double angle = -6.283185307179586 * turn;
        corners.push_back(random.in(0.025, 0.05) * engine::Vec2{std::cos(angle), std::sin(angle)});
    }
    std::vector<WavySide> sides(n);
    for (std::size_t k = 0; k < n; ++k) {
        const engine::Vec2 from = corners[k];
        const engine::Vec2 along = corners[(k + 1) % n] - from;
        const engine::Vec2 aside{-along.y, along.x};
        for (std::size_t i = 0; i < 6; ++i) {
            const bool inner = i > 0 && i < 5;
            sides[k].points[i] = from + (static_cast<double>(i) / 5.0) * along +
                                 (inner ? random.in(-0.2, 0.3) : 0.0) * aside;
            sides[k].weights[i] = random.decade(-0.7, 0.7);
        }
        sides[k].points[5] = corners[(k + 1) % n];
    }
    return sides;
}

}  // namespace

TEST_CASE(
    "a wedge and a groove are felt in space as in the plane and its mirror, friction in its cone",
    "[cli][surface][law]") {
    // In 51 the god-object stood on the patch that leads out, and the other one holds it.
    const auto seed = GENERATE(seeds(16U), value(51U));
    Random random(seed + 4100U);
    const bool wedge = seed % 2U == 0U;
    const double most_open = seed % 4U < 2U ? 0.5 : 1.4;
    const double left = random.in(0.1, most_open);  // of each side from the vertical, rad
    const double right = random.in(0.1, most_open);
    const double mu = random.in(0.05, seed % 4U == 0U ? 1.0 : 3.0);
    const Corner corner = corner_of(wedge, left, right, random.in(-0.3, 0.3));
    const double damping = seed % 3U == 0U ? random.in(0.1, 0.8) : 0.0;
    const std::string common =
        fmt::format("[renderer]\nstiffness_n_per_m = 1000.0\ndamping_n_s_per_m = {}\n", damping) +
        law_of(random, mu);
    std::string plane_path = "t_s,x_m,y_m\n";
    std::string mirrored_path = plane_path;
    std::string space_path = "t_s,x_m,y_m,z_m\n";
    for (const auto& [t, x, z] : edge_hand(random)) {
        plane_path += fmt::format("{},{},{}\n", t, x, z);
        mirrored_path += fmt::format("{},{},{}\n", t, -x, z);
        space_path += fmt::format("{},{},0.01,{}\n", t, x, z);
    }
    const auto plane = edge_felt(common + in_plane(corner), plane_path, 4);
    const auto mirrored = edge_felt(common + in_plane(mirrored_corner(corner)), mirrored_path, 4);
    const auto space = edge_felt(common + in_space(corner), space_path, 5);
    CAPTURE(seed, wedge, left, right, common);
    REQUIRE(plane.size() == 3920);
    REQUIRE(mirrored.size() == 3920);
    REQUIRE(space.size() == 3920);
    std::size_t touched = 0;
    for (std::size_t k = 0; k < plane.size(); ++k) {
        const EdgeFelt& a = plane[k];
        const EdgeFelt& b = space[k];
        CAPTURE(k, a.mode, b.mode, a.fn, b.fn, a.ft, b.ft, a.fx, b.fx, a.fy, b.fy);
        touched += a.mode == "FREE" ? 0U : 1U;
        REQUIRE((a.mode == "FREE") == (b.mode == "FREE"));
        REQUIRE(a.held == b.held);
        REQUIRE(std::fabs(a.fx - b.fx) < 1e-9);
        REQUIRE(std::fabs(a.fy - b.fy) < 1e-9);
        REQUIRE(std::fabs(a.fn - b.fn) < 1e-9);
        REQUIRE(std::fabs(a.ft - b.ft) < 1e-9);
        REQUIRE(std::fabs(a.fx + mirrored[k].fx) < 1e-9);
        REQUIRE(std::fabs(a.fy - mirrored[k].fy) < 1e-9);
        REQUIRE((damping > 0.0 || b.ft <= mu * b.fn + 1e-9));
    }
    CHECK(touched > 200);
}

TEST_CASE(
    "without friction a god-object goes to the first foot of its way in space as in the plane",
    "[cli][surface][law]") {
    const auto seed = GENERATE(seeds(12U));
    CAPTURE(seed);
    Random random(seed + 4200U);
    std::string plane_scene = "[friction]\nlaw = \"frictionless\"\n";
    std::string space_scene = plane_scene;
    for (const WavySide& side : wavy(random)) {
        plane_scene += side.in_plane();
        space_scene += side.in_space();
    }
    // From outside to the middle, and then in leaps.
    std::string plane_path = "t_s,x_m,y_m\n";
    std::string space_path = "t_s,x_m,y_m,z_m\n";
    std::size_t ticks = 0;
    const auto goes = [&](double far, double angle) {
        const double t = 1e-3 * static_cast<double>(ticks++);
        const double x = far * std::cos(angle);
        const double y = far * std::sin(angle);
        plane_path += fmt::format("{},{},{}\n", t, x, y);
        space_path += fmt::format("{},{},0.01,{}\n", t, x, y);
    };
    for (int k = 0; k < 30; ++k) {
        const double angle = random.in(0.0, 6.28);
        for (int step = 0; step < 60; ++step) {
            goes(0.09 - 0.07 * step / 59.0, angle);
        }
        for (int leap = 0; leap < 4; ++leap) {
            goes(random.in(0.002, 0.02), random.in(0.0, 6.28));
        }
    }
    const auto plane = edge_felt(plane_scene, plane_path, 4);
    const auto space = edge_felt(space_scene, space_path, 5);
    REQUIRE(plane.size() == ticks);
    REQUIRE(space.size() == ticks);
    for (std::size_t k = 0; k < ticks; ++k) {
        const EdgeFelt& a = plane[k];
        const EdgeFelt& b = space[k];
        CAPTURE(k, a.mode, b.mode, a.fx, b.fx, a.fy, b.fy);
        REQUIRE(a.held == b.held);
        REQUIRE(std::fabs(a.fx - b.fx) < 1e-6);
        REQUIRE(std::fabs(a.fy - b.fy) < 1e-6);
    }
}

TEST_CASE("the open end of a groove between two walls holds as that of its floor in the plane",
          "[cli][surface][law]") {
    const auto seed = GENERATE(seeds(8U));
    Random random(seed + 4400U);
    const engine::Vec2 from{-0.04, random.in(-0.01, 0.01)};
    const engine::Vec2 to{0.04, random.in(-0.01, 0.01)};
    const double wall = random.in(0.4, 2.0);  // how steep both rise from the floor
    const std::string common =
        "[renderer]\nstiffness_n_per_m = 1000.0\n" + law_of(random, random.in(0.05, 1.0));
    const std::string plane_scene =
        common + fmt::format("[[segment]]\nkind = \"line\"\nfrom_m = [{}, {}]\nto_m = [{}, {}]\n",
                             from.x, from.y, to.x, to.y);
    std::string space_scene = common;
    for (const double side : {-0.05, 0.05}) {
        const auto row = [&](const engine::Vec2& p) {
            const std::string floor = fmt::format("[{}, 0.0, {}]", p.x, p.y);
            const std::string top =
                fmt::format("[{}, {}, {}]", p.x, side, p.y + wall * std::fabs(side));
            return side < 0.0 ? fmt::format("[{}, {}]", top, floor)
                              : fmt::format("[{}, {}]", floor, top);
        };
        space_scene += fmt::format(
            "[[surface]]\ndegree_u = 1\ndegree_v = 1\nknots_u = [0, 0, 1, 1]\nknots_v = [0, 0, 1, "
            "1]\npoints_m = [{}, {}]\n",
            row(from), row(to));
    }
    // Presses, and out over one end and the other.
    std::string plane_path = "t_s,x_m,y_m\n";
    std::string space_path = "t_s,x_m,y_m,z_m\n";
    for (int k = 0; k < 2000; ++k) {
        const double t = 1e-3 * k;
        const double x = std::min(2.5 * t, 1.0) * 0.07 * std::sin(6.3 * t);
        const double z = k < 200 ? 0.03 - 2.5e-4 * k : -0.02 - 0.003 * std::sin(11.0 * t);
        plane_path += fmt::format("{},{},{}\n", t, x, z);
        space_path += fmt::format("{},{},0.0,{}\n", t, x, z);
    }
    const auto plane = edge_felt(plane_scene, plane_path, 4);
    const auto space = csv_body(said_of("render", space_scene, space_path));
    CAPTURE(seed, from.y, to.y, wall, common);
    REQUIRE(plane.size() == 2000);
    REQUIRE(space.size() == 2000);
    std::size_t held = 0;
    for (std::size_t k = 0; k < plane.size(); ++k) {
        const auto number = [&row = space[k]](std::size_t column) {
            return std::stod(row.at(column));
        };
        CAPTURE(k, plane[k].fx, number(13), number(14), plane[k].fy, number(15));
        held += plane[k].held > 0.0 ? 1U : 0U;
        REQUIRE(plane[k].held == number(16));
        REQUIRE(std::fabs(plane[k].fn - number(11)) < 1e-9);
        REQUIRE(std::fabs(plane[k].ft - number(12)) < 1e-9);
        REQUIRE(std::fabs(plane[k].fx - number(13)) < 1e-9);
        REQUIRE(std::fabs(number(14)) < 1e-9);
        REQUIRE(std::fabs(plane[k].fy - number(15)) < 1e-9);
    }
    CHECK(held > 50);
}

TEST_CASE("a groove that hardly yields is felt as a rigid one, however sharp, and as its mirror",
          "[cli][deformation][law]") {
    const auto seed = GENERATE(seeds(8U));
    Random random(seed + 4300U);
    const double left = random.in(0.15, 0.5);
    const double right = random.in(0.15, 0.5);
    const double mu = random.in(0.3, 3.0);
    const auto scene_of = [mu](const Corner& c, double compliance) {
        return fmt::format(
            "[renderer]\nstiffness_n_per_m = 1000.0\ncompliance_m_per_n = {}\n[friction]\nlaw = "
            "\"coulomb\"\nmu_d = {}\n{}[[segment]]\nkind = \"nurbs\"\ndegree = 2\nknots = [0, 0, "
            "0, 1, 1, 1]\npoints_m = [[{}, {}], [0.0, -0.12], [{}, {}]]\n",
            compliance, mu, in_plane(c), c[2].x, c[2].y, c[0].x, c[0].y);
    };
    const Corner corner = corner_of(false, left, right, 0.0);
    std::string path = "t_s,x_m,y_m\n";
    std::string mirrored_path = path;
    for (int k = 0; k < 3000; ++k) {
        const double t = 1e-3 * k;
        const double down = std::min(t / 0.2, 1.0);  // from above the object
        const double x = down * (0.003 * std::sin(9.0 * t) + 0.001 * std::sin(17.0 * t));
        const double y = down * 0.004 * std::sin(5.0 * t + 1.0) + (1.0 - down) * 0.06;
        path += fmt::format("{},{},{}\n", t, x, y);
        mirrored_path += fmt::format("{},{},{}\n", t, -x, y);
    }
    const auto rigid = edge_felt(scene_of(corner, 0.0), path, 4);
    const auto soft = edge_felt(scene_of(corner, 1e-7), path, 4);
    CAPTURE(seed, left, right, mu);
    REQUIRE(rigid.size() == 3000);
    REQUIRE(soft.size() == 3000);
    for (std::size_t k = 0; k < rigid.size(); ++k) {
        CAPTURE(k, rigid[k].fx, soft[k].fx, rigid[k].fy, soft[k].fy);
        REQUIRE(std::fabs(rigid[k].fx - soft[k].fx) < 5e-3);
        REQUIRE(std::fabs(rigid[k].fy - soft[k].fy) < 5e-3);
    }
    for (const double compliance : {1e-7, 1e-5, 1e-3}) {  // also where a surface still moves
        const auto felt = edge_felt(scene_of(corner, compliance), path, 4);
        const auto mirrored =
            edge_felt(scene_of(mirrored_corner(corner), compliance), mirrored_path, 4);
        REQUIRE(mirrored.size() == felt.size());
        for (std::size_t k = 0; k < felt.size(); ++k) {
            CAPTURE(compliance, k, felt[k].fx, mirrored[k].fx, felt[k].fy, mirrored[k].fy);
            REQUIRE(std::fabs(mirrored[k].fx + felt[k].fx) < 2e-6);
            REQUIRE(std::fabs(mirrored[k].fy - felt[k].fy) < 2e-6);
        }
    }
}
