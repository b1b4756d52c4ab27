#include "tests/figures/thesis/thesis_scene.hpp"
#include "tests/support/program.hpp"
#include "tests/support/scene_text.hpp"
#include "tests/support/surfaces.hpp"
#include "tests/support/thesis_objects.hpp"

// What `palpate render` writes of ticks in which nothing is felt.

namespace {

constexpr const char* kRubs = "[friction]\nlaw = \"gos\"\nmu_s = 0.6\nmu_d = 0.4\n";

/// A bow of one convex piece, its ends on y = 0, with another bow beside it: a closest point that
/// jumps.
std::string bows(Random& random) {
    const auto p = [&](double x, double y) {
        const double right = x + random.in(-2e-3, 2e-3);
        return engine::Vec2{right, y + random.in(-2e-3, 2e-3)};
    };
    const engine::Vec2 middle = p(0.0, 0.0);
    const auto left = bezier_data({p(-0.06, 0.0), p(-0.05, 0.03), p(-0.02, 0.04), middle});
    return segment_text(left) +
           segment_text(bezier_data({middle, p(0.02, 0.03), p(0.05, 0.03), p(0.07, 0.0)}));
}

std::string sheet(Random& random) {
    return surface_text(bicubic_8x8(random, 0.0));
}

}  // namespace

TEST_CASE(
    "out of contact render's god-object is the closest point, as `palpate closest` finds it") {
    SEEDED(random, 6U, 2900U);
    const bool space = seed % 2U == 1U;
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
    const std::string felt = said_of("render", scene, path);
    const Columns columns = columns_in(felt);
    const Columns near = columns_in(said_of("closest", scene, path));
    const auto rows = csv_records(felt);
    REQUIRE(rows.size() == kTicks);
    std::size_t free = 0;
    double worst = 0.0;
    for (std::size_t k = 0; k < kTicks; ++k) {
        if (rows[k].at("mode") != "FREE") {
            continue;
        }
        ++free;
        for (const std::string axis : {"x", "y", "z"}) {
            if (axis != "z" || space) {
                worst = std::max(worst, std::fabs(columns.at("go_" + axis + "_m")[k] -
                                                  near.at("cp_" + axis + "_m")[k]));
            }
        }
    }
    CHECK(free > kTicks / 3);
    CHECK(free < kTicks);
    CHECK(worst < 1e-10);
}

TEST_CASE(
    "a hand led round an open end or border feels nothing before it comes through the surface") {
    SEEDED(random, 20U, 4100U);
    const char* const scenes[] = {"", kRubs, "[friction]\nlaw = \"dahl\"\nmu_d = 0.5\n"};
    const bool space = seed % 4U == 3U;
    const std::string scene = space ? kRubs + sheet(random) : scenes[seed % 4U] + bows(random);
    CAPTURE(scene);
    // Above, round the side, under it and deep, back, and down through it from above.
    const double step = random.in(1e-4, 1e-3);
    const double side = random.coin() ? 0.09 : -0.09;
    const double deep = random.in(-0.03, -0.005);
    const double x = random.in(-0.03, 0.03);
    const engine::Vec2 corners[] = {{x, 0.06},    {side, 0.06}, {side, deep}, {x, deep},
                                    {side, deep}, {side, 0.06}, {x, 0.06},    {x, deep}};
    std::string path = space ? "t_s,x_m,y_m,z_m\n" : "t_s,x_m,y_m\n";
    std::size_t ticks = 0;
    std::size_t from_above = 0;
    for (std::size_t k = 1; k < std::size(corners); ++k) {
        from_above = ticks;
        const engine::Vec2 way = corners[k] - corners[k - 1];
        const auto steps = static_cast<std::size_t>(glm::length(way) / step) + 1;
        for (std::size_t i = 0; i < steps; ++i, ++ticks) {
            const engine::Vec2 h =
                corners[k - 1] + way * (static_cast<double>(i) / static_cast<double>(steps));
            const double t = 1e-3 * static_cast<double>(ticks);
            path += space ? fmt::format("{},{},0.01,{}\n", t, h.x, h.y)
                          : fmt::format("{},{},{}\n", t, h.x, h.y);
        }
    }
    const auto felt = csv_body(said_of("render", scene, path));
    REQUIRE(felt.size() == ticks);
    const auto free = [](const auto& row) {
        return row[1] == "FREE";
    };
    const auto first = std::ranges::find_if_not(felt, free);
    REQUIRE(first != felt.end());
    CHECK(first - felt.begin() > static_cast<std::ptrdiff_t>(from_above));
    CHECK(std::all_of(first, felt.end(), std::not_fn(free)));
    const std::size_t force = space ? 12 : 10;
    double strength = 0.0;
    for (std::size_t i = 0; i < (space ? 3U : 2U); ++i) {
        strength = std::hypot(strength, std::stod((*first)[force + i]));
    }
    CHECK(strength <= 1000.0 * step * 1.001);
}

TEST_CASE(
    "a scene that names a law or a tracker of the thesis is felt by its renderer, to the bit") {
    using figures::ThesisLaw;
    using figures::TrackerKind;
    struct Named {
        const char* keys;
        figures::TrackerSpec spec;
    };
    const Named tracker = GENERATE(values<Named>(
        {{"\"certified\"", {.kind = TrackerKind::newton, .iterations = 2}},
         {"\"feedback\"\ngain = 6e4\nsub_steps = 3",
          {.kind = TrackerKind::feedback, .gain = 6e4, .sub_steps = 3}},
         {"\"feed_forward\"\ngain = 5e4", {.kind = TrackerKind::feed_forward, .gain = 5e4}},
         {"\"feedback_linearised\"\ngain = 500",
          {.kind = TrackerKind::feedback_linearised, .gain = 500.0}},
         {"\"tangent_plane\"\nrate_hz = 60", {.kind = TrackerKind::tangent_plane, .rate_hz = 60.0}},
         {"\"newton\"\niterations = 3", {.kind = TrackerKind::newton, .iterations = 3}}}));
    const auto law = GENERATE(ThesisLaw::literal, ThesisLaw::latched, ThesisLaw::frictionless);
    if (tracker.spec.iterations == 2 && law == ThesisLaw::frictionless) {
        return;  // our own renderer's
    }
    const std::string friction =
        law == ThesisLaw::frictionless
            ? "law = \"frictionless\""
            : fmt::format("law = \"thesis_{}\"\nmu_s = 0.6\nmu_d = 0.4\ndead_band_m_per_s = 0.001",
                          law == ThesisLaw::literal ? "literal" : "latched");
    std::string text =
        fmt::format("[renderer]\nstiffness_n_per_m = 800\ntracker = {}\n[friction]\n{}\n",
                    tracker.keys, friction);
    for (const auto& polygon : two_polygons()) {
        text += segment_text(bezier_data({polygon.begin(), polygon.end()}));
    }
    CAPTURE(text);
    const double tick = std::ldexp(1.0, -10);  // s, exact
    std::vector<engine::Vec2> path;
    std::string table = "t_s,x_m,y_m\n";
    for (int k = 0; k < 600; ++k) {
        path.push_back({-0.04 + 0.08 * k / 600, 0.026 + 0.004 * std::sin(0.05 * k)});
        table += fmt::format("{},{},{}\n", k * tick, path.back().x, path.back().y);
    }
    const auto felt = csv_body(said_of("render", text, table));
    REQUIRE(felt.size() == path.size());

    const bool rubs = law != ThesisLaw::frictionless;
    const figures::ThesisScene scene(two_cubics(), false,
                                     {.stiffness = 800.0,
                                      .period = tick,
                                      .tracker = tracker.spec,
                                      .law = law,
                                      .mu_s = rubs ? 0.6 : 0.0,
                                      .mu_d = rubs ? 0.4 : 0.0,
                                      .dead_band = rubs ? 0.001 : 0.0});
    figures::ThesisState state;
    std::size_t touching = 0;
    for (std::size_t k = 0; k < path.size(); ++k) {
        const figures::ThesisTick expected = scene.tick(state, path[k]);
        touching += expected.mode == engine::Mode::free ? 0U : 1U;
        const auto number = [&](std::size_t column) {
            return std::stod(felt[k][column]);
        };
        CAPTURE(k);
        REQUIRE(felt[k][2] == std::to_string(expected.cp_segment));
        REQUIRE(number(3) == expected.cp_u);
        REQUIRE((engine::Vec2{number(4), number(5)} == expected.cp));
        REQUIRE((engine::Vec2{number(6), number(7)} == expected.go));
        REQUIRE((engine::Vec2{number(10), number(11)} == expected.force));
    }
    CHECK(touching > path.size() / 4);
    CHECK(touching < path.size());
}

TEST_CASE(
    "a long path from a file, a pipe or standard input is felt alike, each row as in a shorter "
    "path") {
    SEEDED(random, 2U, 2910U);
    EACH(command, as<std::string>{}, "render", "closest");
    const TemporaryFolder folder;
    write(folder.file("s.toml"), kRubs + bows(random));
    // Rows of any width, some 2 MB: pieces of them begin anywhere in a row.
    constexpr int kRows = 40'000;
    constexpr int kFew = 3'000;
    const double phase = random.in(0.0, 6.0);
    std::string path = seed == 0U ? "t_s,x_m,y_m\n" : "\xEF\xBB\xBF\"t_s\",what,y_m,x_m\r\n";
    std::string few;
    for (int k = 0; k < kRows; ++k) {
        few = k == kFew ? path : few;
        const double x = 0.04 * std::sin(0.003 * k + phase);
        const double y = 0.03 + 0.02 * std::sin(0.011 * k);
        path += seed == 0U ? fmt::format("{},{},{:.{}f}\n", 0.001 * k, x, y, random.below(40))
                           : fmt::format(" {}, \"a, b\",{:.{}f}  ,{}\r\n{}", 0.001 * k, y,
                                         random.below(40), x, k % 100 == 7 ? "\n" : "");
    }
    write(folder.file("t.csv"), path);
    write(folder.file("few.csv"), few);
    const auto felt = [&](const std::string& shell) {
        return ended(tests::shell(fmt::format("P=\"$0 {} s.toml\" && {}", command, shell),
                                  folder.path()))
            .out;
    };
    const std::string whole = felt("$P t.csv");
    CHECK(std::count(whole.begin(), whole.end(), '\n') == kRows + 1);
    CHECK((felt("cat t.csv | $P /dev/stdin") == whole));
    CHECK((felt("$P /dev/stdin < t.csv") == whole));
    CHECK((felt("$P t.csv -o o.csv && cat o.csv") == whole));
    CHECK((felt("mkfifo p && (cat t.csv > p & $P p -o o.csv) && cat o.csv") == whole));
    const std::string begin = felt("$P few.csv");
    CHECK((begin == whole.substr(0, begin.size())));

    // A wrong row far down is refused with its place before anything is written.
    const std::size_t last = path.rfind("0.0", path.size() - 40);
    path.insert(last, "x");
    write(folder.file("bad.csv"), path);
    for (const std::string to : {"", "-o bad_o.csv"}) {
        const Finished done =
            shell(fmt::format("\"$0\" {} s.toml bad.csv {}", command, to), folder.path());
        CAPTURE(to);
        check_end(done, 2, Has("bad.csv:", "not a finite number"));
        CHECK(done.out.empty());
        CHECK_FALSE(std::filesystem::exists(folder.file("bad_o.csv")));
    }
}

TEST_CASE("a step of a micrometre weighs a micrometre, whatever the vertex slew") {
    std::string table = "t_s,x_m,y_m\n";
    for (int k = 0; k < 160; ++k) {
        table += fmt::format("{:.3f},{:.4f},{:.4f}\n", k / 1000.0,
                             -0.008 + 1e-4 * std::max(k - 40, 0), 0.002 - 1e-4 * std::min(k, 40));
    }
    for (const char* slew : {"0.2", "0.01"}) {
        const std::string text = fmt::format(
            "[renderer]\nstiffness_n_per_m = 1000\n[friction]\nlaw = \"frictionless\"\n"
            "vertex_slew_m_per_s = {}\nvertex_radius_m = 0.003\n",
            slew);
        const std::vector<engine::Vec2> corners{{-0.04, 0},    {0, 0},        {0, -1e-6},
                                                {0.04, -1e-6}, {0.04, -0.04}, {-0.04, -0.04},
                                                {-0.04, 0}};
        const auto felt = csv_body(said_of("render", text + lines_text(corners), table));
        REQUIRE(felt.size() == 160);
        for (std::size_t k = 41; k < felt.size(); ++k) {
            CAPTURE(slew, k);
            REQUIRE(std::stod(felt[k][11]) == Approx(k <= 120 ? 2.0 : 1.999).epsilon(1e-12));
        }
    }
}
