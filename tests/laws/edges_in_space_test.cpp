#include "tests/support/program.hpp"
#include "tests/support/scene_text.hpp"

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
    return lines_text({c[0], c[1], c[2]});
}

/// A curve along y, so far to both sides.
std::string extruded(const NurbsData<2>& curve, double half) {
    SurfaceData sheet{
        .degree_u = curve.degree, .knots_u = curve.knots, .knots_v = {0.0, 0.0, 1.0, 1.0}};
    for (const engine::Vec2& p : curve.points) {
        sheet.points.push_back({{p.x, -half, p.y}, {p.x, half, p.y}});
    }
    for (const double weight : curve.weights) {
        sheet.weights.push_back({weight, weight});
    }
    return surface_text(sheet);
}
std::string in_space(const Corner& c) {
    return extruded(bezier_data({c[0], c[1]}), 0.04) + extruded(bezier_data({c[1], c[2]}), 0.04);
}

/// A hand's way in the plane, in its mirror, and in space, aside of the plane there.
struct EdgeWay {
    std::string plane = "t_s,x_m,y_m\n";
    std::string mirrored = plane;
    std::string space = "t_s,x_m,y_m,z_m\n";
    std::size_t ticks = 0;

    void go(double x, double z, double aside = 0.01) {
        const double t = 1e-3 * static_cast<double>(ticks++);
        plane += fmt::format("{},{},{}\n", t, x, z);
        mirrored += fmt::format("{},{},{}\n", t, -x, z);
        space += fmt::format("{},{},{},{}\n", t, x, aside, z);
    }
};

/// What `palpate render` makes of a way: its columns, where it is free, the size of friction, and the
/// force upwards, which is along y in the plane and along z in space.
Columns edge_felt(const std::string& scene, const std::string& way) {
    const std::string out = said_of("render", scene, way);
    Columns felt = columns_in(out);
    for (const auto& row : csv_records(out)) {
        felt["free"].push_back(row.at("mode") == "FREE" ? 1.0 : 0.0);
    }
    for (double& friction : felt["ft_n"]) {
        friction = std::fabs(friction);
    }
    felt["up"] = felt[felt.contains("fz_n") ? "fz_n" : "fy_n"];
    return felt;
}

/// Of both the same, these columns within `tolerance`.
void check_alike(const Columns& a,
                 const Columns& b,
                 const Words& columns,
                 double tolerance,
                 bool mirrored = false) {
    for (const std::string& column : columns) {
        CAPTURE(column, mirrored);
        REQUIRE(apart(a.at(column), b.at(column), mirrored && column == "fx_n" ? -1.0 : 1.0) <=
                tolerance);
    }
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

/// A hand that goes to and fro over the vertex, then comes in at one side, goes on to near the
/// middle, and leaves upwards, again and again.
EdgeWay edge_hand(Random& random) {
    double hz[4];
    double phase[4];
    for (std::size_t k = 0; k < 4; ++k) {
        hz[k] = random.in(0.5, 4.0);
        phase[k] = random.in(0.0, 6.0);
    }
    EdgeWay way;
    for (int k = 0; k < 2000; ++k) {
        const auto wave = [&](std::size_t w) {
            return std::sin(6.283185307179586e-3 * hz[w] * k + phase[w]);
        };
        way.go(0.006 * wave(0) + 0.002 * wave(1), 0.006 * wave(2) + 0.002 * wave(3) - 0.002);
    }
    for (int stroke = 0; stroke < 12; ++stroke) {
        const double from = random.coin() ? 0.02 : -0.02;
        const double to = random.in(-0.003, 0.003);
        const double z = random.in(-0.008, -0.002);
        for (int k = 0; k < 60; ++k) {
            way.go(from + (to - from) * k / 60.0, z);
        }
        for (int k = 0; k < 100; ++k) {
            way.go(to, z + 1.6e-4 * k);
        }
    }
    return way;
}

/// A clockwise outline of three to five wavy sides around the origin, some 40 mm away: curves of
/// degree 3 with two more points between their ends.
std::vector<NurbsData<2>> wavy(Random& random) {
    const auto n = static_cast<std::size_t>(3 + random.below(3));
    std::vector<engine::Vec2> corners;
    for (std::size_t k = 0; k < n; ++k) {
        const double turn =
            (static_cast<double>(k) + random.in(-0.2, 0.2)) / static_cast<double>(n);
        const double angle = -6.283185307179586 * turn;
        corners.push_back(random.in(0.025, 0.05) * engine::Vec2{std::cos(angle), std::sin(angle)});
    }
    std::vector<NurbsData<2>> sides(n, {3, {0, 0, 0, 0, 1, 2, 2.5, 2.5, 2.5, 2.5}, {}, {}});
    for (std::size_t k = 0; k < n; ++k) {
        const engine::Vec2 from = corners[k];
        const engine::Vec2 along = corners[(k + 1) % n] - from;
        const engine::Vec2 aside{-along.y, along.x};
        for (std::size_t i = 0; i < 6; ++i) {
            const bool inner = i > 0 && i < 5;
            sides[k].points.push_back(from + (static_cast<double>(i) / 5.0) * along +
                                      (inner ? random.in(-0.2, 0.3) : 0.0) * aside);
            sides[k].weights.push_back(random.decade(-0.7, 0.7));
        }
        sides[k].points[5] = corners[(k + 1) % n];
    }
    return sides;
}

}  // namespace

TEST_CASE(
    "a wedge and a groove are felt in space as in the plane and its mirror, friction in its cone") {
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
    const EdgeWay way = edge_hand(random);
    const Columns plane = edge_felt(common + in_plane(corner), way.plane);
    const Columns mirrored = edge_felt(common + in_plane(mirrored_corner(corner)), way.mirrored);
    const Columns space = edge_felt(common + in_space(corner), way.space);
    CAPTURE(seed, wedge, left, right, common);
    REQUIRE(plane.at("t_s").size() == 3920);
    check_alike(plane, space, {"free", "held"}, 0.0);
    check_alike(plane, space, {"fn_n", "ft_n", "fx_n", "up"}, 1e-9);
    check_alike(plane, mirrored, {"fx_n", "up"}, 1e-9, true);
    for (std::size_t k = 0; k < way.ticks && damping == 0.0; ++k) {
        CAPTURE(k);
        REQUIRE(space.at("ft_n")[k] <= mu * space.at("fn_n")[k] + 1e-9);
    }
    CHECK(std::ranges::count(plane.at("free"), 0.0) > 200);
}

TEST_CASE(
    "without friction a god-object goes to the first foot of its way in space as in the plane") {
    SEEDED(random, 12U, 4200U);
    std::string plane_scene = "[friction]\nlaw = \"frictionless\"\n";
    std::string space_scene = plane_scene;
    for (const NurbsData<2>& side : wavy(random)) {
        plane_scene += segment_text(side);
        space_scene += extruded(side, 0.2);
    }
    // From outside to the middle, and then in leaps.
    EdgeWay way;
    const auto goes = [&](double far, double angle) {
        way.go(far * std::cos(angle), far * std::sin(angle));
    };
    for (int k = 0; k < 30; ++k) {
        const double angle = random.in(0.0, 6.28);
        for (int step = 0; step < 60; ++step) {
            goes(0.09 - 0.07 * step / 59.0, angle);
        }
        for (int leap = 0; leap < 4; ++leap) {
            const double far = random.in(0.002, 0.02);
            goes(far, random.in(0.0, 6.28));
        }
    }
    const Columns plane = edge_felt(plane_scene, way.plane);
    const Columns space = edge_felt(space_scene, way.space);
    REQUIRE(plane.at("t_s").size() == way.ticks);
    check_alike(plane, space, {"held"}, 0.0);
    check_alike(plane, space, {"fx_n", "up"}, 1e-6);
}

TEST_CASE("the open end of a groove between two walls holds as that of its floor in the plane") {
    SEEDED(random, 8U, 4400U);
    const engine::Vec2 from{-0.04, random.in(-0.01, 0.01)};
    const engine::Vec2 to{0.04, random.in(-0.01, 0.01)};
    const double wall = random.in(0.4, 2.0);  // how steep both rise from the floor
    const std::string common =
        "[renderer]\nstiffness_n_per_m = 1000.0\n" + law_of(random, random.in(0.05, 1.0));
    std::string space_scene = common;
    for (const auto& [left, right] : {std::pair{-0.05, 0.0}, std::pair{0.0, 0.05}}) {
        const auto row = [&](const engine::Vec2& p) {
            return std::vector<engine::Vec3>{{p.x, left, p.y - wall * left},
                                             {p.x, right, p.y + wall * right}};
        };
        space_scene += plate_text(row(from), row(to));
    }
    // Presses, and out over one end and the other.
    EdgeWay way;
    for (int k = 0; k < 2000; ++k) {
        const double t = 1e-3 * k;
        way.go(std::min(2.5 * t, 1.0) * 0.07 * std::sin(6.3 * t),
               k < 200 ? 0.03 - 2.5e-4 * k : -0.02 - 0.003 * std::sin(11.0 * t), 0.0);
    }
    const Columns plane = edge_felt(common + line_text(from, to), way.plane);
    const Columns space = edge_felt(space_scene, way.space);
    CAPTURE(from.y, to.y, wall, common);
    REQUIRE(plane.at("t_s").size() == 2000);
    check_alike(plane, space, {"held"}, 0.0);
    check_alike(plane, space, {"fn_n", "ft_n", "fx_n", "up"}, 1e-9);
    CHECK(apart(space.at("fy_n"), space.at("fy_n"), 0.0) < 1e-9);
    CHECK(std::ranges::count_if(plane.at("held"), [](double held) { return held > 0.0; }) > 50);
}

TEST_CASE("a groove that hardly yields is felt as a rigid one, however sharp, and as its mirror") {
    SEEDED(random, 8U, 4300U);
    const double left = random.in(0.15, 0.5);
    const double right = random.in(0.15, 0.5);
    const double mu = random.in(0.3, 3.0);
    const auto scene_of = [mu](const Corner& c, double compliance) {
        return fmt::format(
                   "[renderer]\nstiffness_n_per_m = 1000.0\ncompliance_m_per_n = {}\n[friction]\n"
                   "law = \"coulomb\"\nmu_d = {}\n",
                   compliance, mu) +
               in_plane(c) + segment_text(bezier_data({c[2], {0.0, -0.12}, c[0]}));
    };
    const Corner corner = corner_of(false, left, right, 0.0);
    EdgeWay way;
    for (int k = 0; k < 3000; ++k) {
        const double t = 1e-3 * k;
        const double down = std::min(t / 0.2, 1.0);  // from above the object
        way.go(down * (0.003 * std::sin(9.0 * t) + 0.001 * std::sin(17.0 * t)),
               down * 0.004 * std::sin(5.0 * t + 1.0) + (1.0 - down) * 0.06);
    }
    const Columns rigid = edge_felt(scene_of(corner, 0.0), way.plane);
    const Columns soft = edge_felt(scene_of(corner, 1e-7), way.plane);
    CAPTURE(left, right, mu);
    REQUIRE(rigid.at("t_s").size() == 3000);
    check_alike(rigid, soft, {"fx_n", "up"}, 5e-3);
    for (const double compliance : {1e-7, 1e-5, 1e-3}) {  // also where a surface still moves
        CAPTURE(compliance);
        check_alike(edge_felt(scene_of(mirrored_corner(corner), compliance), way.mirrored),
                    edge_felt(scene_of(corner, compliance), way.plane), {"fx_n", "up"}, 2e-6, true);
    }
}
