#include "tests/figures/figure_list.hpp"
#include "tests/figures/svg_diagram.hpp"
#include "tests/support/program.hpp"
#include "tests/support/svg_reader.hpp"

// The thesis' figures, and the laws of contact read off the tables that are written beside them.

using namespace palpate::figures;

namespace {

constexpr double kPlotMuS = 0.7;
constexpr double kPlotMuD = 0.5;
constexpr double kStiffness = 1000.0;  // N/m
constexpr double kFree = 0.0;
constexpr double kStuck = 1.0;

const NamedFigure& figure_named(const std::string& name) {
    for (const NamedFigure& figure : thesis_figures()) {
        if (figure.name == name) {
            return figure;
        }
    }
    throw std::invalid_argument("no figure " + name);
}

Columns table_of(const std::string& figure, const std::string& suffix = "") {
    for (const FigureFile& file : files_of(figure_named(figure))) {
        if (file.name == figure + suffix + ".csv") {
            return columns_in(file.text);
        }
    }
    throw std::invalid_argument("no table of " + figure + suffix);
}

std::size_t tick_at(const Columns& run, double time) {
    const auto& t = run.at("time_s");
    return static_cast<std::size_t>(std::find(t.begin(), t.end(), time) - t.begin());
}

/// The cone, and mu between its two values, falling while GO slides and healing while it stands.
void check_friction(const Columns& run, const std::string& law) {
    const auto& mode = run.at(law + "mode");
    const auto& friction = run.at(law + "friction_n");
    const auto& normal = run.at(law + "normal_n");
    const auto& mu = run.at(law + "mu");
    for (std::size_t i = 0; i < mode.size(); ++i) {
        CAPTURE(i, mode[i]);
        if (mode[i] == kFree) {
            REQUIRE(friction[i] == 0.0);
            REQUIRE(normal[i] == 0.0);
            continue;
        }
        REQUIRE(std::fabs(friction[i]) <= mu[i] * normal[i] + 1e-9);
        REQUIRE(mu[i] >= kPlotMuD);
        REQUIRE(mu[i] <= kPlotMuS);
        if (i > 0 && mode[i - 1] == kStuck) {
            REQUIRE(mu[i] >= mu[i - 1]);
        } else if (i > 0 && mode[i - 1] != kFree) {
            REQUIRE(mu[i] <= mu[i - 1]);
        }
    }
}

}  // namespace

TEST_CASE("every figure of the thesis is a well-formed picture with tables, twice the same") {
    std::set<std::string> names;
    for (const NamedFigure& figure : thesis_figures()) {
        CAPTURE(figure.name);
        const std::vector<FigureFile> first = files_of(figure);
        const std::vector<FigureFile> second = files_of(figure);
        REQUIRE(first.size() >= 2);
        REQUIRE(first.size() == second.size());
        for (std::size_t i = 0; i < first.size(); ++i) {
            CAPTURE(first[i].name);
            CHECK(names.insert(first[i].name).second);
            CHECK(first[i].name == second[i].name);
            CHECK(first[i].text == second[i].text);
            CHECK(first[i].text.find("nan") == std::string::npos);
        }
        REQUIRE_NOTHROW(SvgReader(first[0].text));
        CHECK(SvgReader(first[0].text).all("text", "caption").size() >= 2);
        for (std::size_t i = 1; i < first.size(); ++i) {
            CHECK(columns_in(first[i].text).size() >= 2);
        }
    }
}

TEST_CASE("the thirteen instants of the path are found and come in order") {
    const Columns markers = table_of("fig_3_2_2", "_markers");
    const auto& ours = markers.at("gos_time_s");
    REQUIRE(ours.size() == 13);
    CHECK(std::all_of(ours.begin(), ours.end(), [](double t) { return std::isfinite(t); }));
    CHECK(std::is_sorted(ours.begin(), ours.end(), [](double a, double b) { return a <= b; }));
    // Read as load since slipping began, the thesis' test fires while HIP presses, later than ours.
    const double fired = markers.at("thesis_latched_time_s")[3];
    CHECK(fired > ours[3]);
    CHECK(fired < ours[4]);
    const Columns run = table_of("fig_3_2_2");
    CHECK(run.at("thesis_latched_normal_n")[tick_at(run, fired)] >= 7.0);
    const Columns surface = table_of("fig_3_2_7", "_markers");
    CHECK(surface.at("time_s").size() == 8);
    for (const double t : surface.at("time_s")) {
        CHECK(std::isfinite(t));
    }
}

TEST_CASE("friction in the figures stays in its cone and mu relaxes between its two values") {
    check_friction(table_of("fig_3_2_2"), "gos_");
    check_friction(table_of("fig_3_2_7"), "");
    check_friction(table_of("fig_3_3_1"), "");
}

TEST_CASE("pressed deeper, friction keeps its value within 5 percent while the load rises") {
    const Columns run = table_of("fig_3_2_2");
    const std::vector<double> at = table_of("fig_3_2_2", "_markers").at("gos_time_s");
    const auto& friction = run.at("gos_friction_n");
    const auto& normal = run.at("gos_normal_n");
    const std::size_t from = tick_at(run, at[2]);
    const std::size_t to = tick_at(run, at[4]);
    REQUIRE(from < to);
    for (std::size_t i = from; i <= to; ++i) {
        REQUIRE(friction[i] == Approx(friction[from]).epsilon(0.05));
    }
    CHECK(normal[to] > 1.4 * normal[from]);
}

TEST_CASE("the god-object stands while stuck, and the force is K times what parts it from HIP") {
    const Columns path = table_of("fig_3_2_1");
    const Columns forces = table_of("fig_3_2_2");
    const auto& mode = path.at("mode");
    const auto& go_x = path.at("go_x_m");
    const auto& go_y = path.at("go_y_m");
    for (std::size_t i = 1; i < mode.size(); ++i) {
        CAPTURE(i);
        if (mode[i] == kStuck && mode[i - 1] != kFree) {
            REQUIRE(go_x[i] == go_x[i - 1]);
            REQUIRE(go_y[i] == go_y[i - 1]);
        }
        // Where the vertex slew holds GO back, the friction part alone is cut.
        const double spring = kStiffness * std::hypot(go_x[i] - path.at("hip_x_m")[i],
                                                      go_y[i] - path.at("hip_y_m")[i]);
        const double force =
            std::hypot(forces.at("gos_force_x_n")[i], forces.at("gos_force_y_n")[i]);
        if (mode[i] != kFree) {
            REQUIRE(force <= spring + 1e-9);
            REQUIRE(force >= forces.at("gos_normal_n")[i] - 1e-9);
        }
    }
}

TEST_CASE("over the corner the closest point changes curves while the god-object still sticks") {
    const Columns run = table_of("fig_3_2_4");
    const std::vector<double> at = table_of("fig_3_2_4", "_markers").at("gos_time_s");
    const std::size_t from = tick_at(run, at[10]);
    const std::size_t release = tick_at(run, at[11]);
    CHECK(run.at("gos_cp_curve")[from] == 0.0);
    CHECK(run.at("gos_cp_curve")[release - 1] == 1.0);
    CHECK(run.at("gos_go_curve")[release - 1] == 0.0);
    CHECK(run.at("gos_mode")[release - 1] == kStuck);
    CHECK(run.at("gos_go_curve").back() == 1.0);
}

TEST_CASE("outside the god-object of the figures is the closest point") {
    const Columns run = table_of("fig_3_2_4");
    const auto& mode = run.at("gos_mode");
    int free = 0;
    for (std::size_t i = 0; i < mode.size(); ++i) {
        if (mode[i] == kFree) {
            ++free;
            REQUIRE(run.at("gos_go_curve")[i] == run.at("gos_cp_curve")[i]);
            REQUIRE(run.at("gos_go_u")[i] == run.at("gos_cp_u")[i]);
        }
    }
    CHECK(free > 500);
}

TEST_CASE("force in the figure of touches is the stiffness times the depth, and none outside") {
    const Columns run = table_of("fig_2_1_8");
    int touches = 0;
    for (std::size_t i = 0; i < run.at("time_s").size(); ++i) {
        const bool felt = run.at("mode")[i] != kFree;
        touches += felt && run.at("mode")[i - 1] == kFree ? 1 : 0;
        REQUIRE(felt == (run.at("depth_m")[i] > 0.0));
        REQUIRE(std::hypot(run.at("force_x_n")[i], run.at("force_y_n")[i]) ==
                Approx(100.0 * run.at("depth_m")[i]).margin(1e-9));
    }
    CHECK(touches == 4);
}

TEST_CASE(
    "stiction in the figure is mu_s at break-away and mu_d beyond, Stribeck's law its formula") {
    const Columns curves = table_of("fig_3_1_1");
    const auto& speed = curves.at("speed_m_per_s");
    for (std::size_t i = 0; i < speed.size(); ++i) {
        CAPTURE(speed[i]);
        CHECK(curves.at("stiction_sliding")[i] == Approx(kPlotMuD).epsilon(1e-9));
        CHECK(curves.at("stiction_breakaway")[i] <= kPlotMuS + 1e-9);
        if (speed[i] < 0.005) {  // a tick of a faster hand goes over the top
            CHECK(curves.at("stiction_breakaway")[i] == Approx(kPlotMuS).epsilon(0.01));
        }
        const double share = speed[i] / 0.01;
        const double steady = (kPlotMuD + (kPlotMuS - kPlotMuD) * std::exp(-share * share)) *
                              std::tanh(speed[i] / 0.002);
        CHECK(curves.at("stribeck_sliding")[i] == Approx(steady).epsilon(1e-6));
    }
}

TEST_CASE(
    "held at a corner, the god-object stands on the first curve while HIP is in another region") {
    const Columns run = table_of("fig_3_1_4");
    const auto& mode = run.at("mode");
    const std::size_t last =
        mode.size() - 1 -
        static_cast<std::size_t>(std::find(mode.rbegin(), mode.rend(), kStuck) - mode.rbegin());
    const std::size_t first =
        static_cast<std::size_t>(std::find(mode.begin(), mode.end(), kStuck) - mode.begin());
    REQUIRE(first < last);
    CHECK(run.at("region")[first] != run.at("region")[last]);
    for (std::size_t i = first + 1; i <= last; ++i) {
        REQUIRE(mode[i] == kStuck);
        REQUIRE(run.at("go_x_m")[i] == run.at("go_x_m")[first]);
    }
    CHECK(std::hypot(run.at("cp_x_m")[last] - run.at("go_x_m")[last],
                     run.at("cp_y_m")[last] - run.at("go_y_m")[last]) > 1e-3);
}

TEST_CASE("without friction the force is the stiffness times the depth") {
    const Columns press = table_of("fig_2_1_6");
    for (const int k : {100, 500, 1000}) {
        const auto& force = press.at("force_at_" + std::to_string(k) + "_n_per_m_n");
        for (std::size_t i = 0; i < force.size(); ++i) {
            REQUIRE(force[i] == Approx(k * std::max(press.at("depth_m")[i], 0.0)).margin(1e-9));
        }
    }
}

TEST_CASE("external Voronoi borders are the normals at the curves' ends") {
    const Columns borders = table_of("fig_2_1_4");
    const Columns points = table_of("fig_2_1_4", "_object");
    const auto& x = points.at("control_x_m");
    const auto& y = points.at("control_y_m");
    std::set<std::pair<int, int>> pairs;
    for (std::size_t i = 0; i < borders.at("region").size(); ++i) {
        const int region = static_cast<int>(borders.at("region")[i]);
        const int other = static_cast<int>(borders.at("other_region")[i]);
        pairs.emplace(region, other);
        if (other > 5) {
            continue;
        }
        // Curves are even, the vertex at the end of curve c is 2 c + 1.
        const int vertex = region % 2 == 1 ? region : other;
        const int curve = (region + other - vertex) / 2;
        const bool at_end = vertex == 2 * curve + 1;
        const auto end = static_cast<std::size_t>(4 * curve + (at_end ? 3 : 0));
        const std::size_t inner = at_end ? end - 1 : end + 1;
        const double length = std::hypot(x[inner] - x[end], y[inner] - y[end]);
        for (const std::string side : {"from", "to"}) {
            const double dx = borders.at(side + "_x_m")[i] - x[end];
            const double dy = borders.at(side + "_y_m")[i] - y[end];
            const double off = (dx * (x[inner] - x[end]) + dy * (y[inner] - y[end])) / length;
            REQUIRE(std::fabs(off) < 1e-8);  // a foot counts as at the end within rounding of u
        }
    }
    CHECK(pairs.size() == 9);  // six normals, three bisectors
}

TEST_CASE("the certified closest point is nearer than any tracker's") {
    const Columns run = table_of("fig_2_1_2");
    for (std::size_t i = 0; i < run.at("time_s").size(); ++i) {
        const auto distance = [&](const std::string& name) {
            return std::hypot(run.at(name + "_x_m")[i] - run.at("hip_x_m")[i],
                              run.at(name + "_y_m")[i] - run.at("hip_y_m")[i]);
        };
        REQUIRE(run.at("certified_error_m")[i] < 1e-11);
        for (const std::string name :
             {"feedback", "feed_forward", "feedback_linearised", "newton"}) {
            REQUIRE(distance(name) >= distance("certified") - 1e-15);
        }
    }
}

TEST_CASE(
    "over the edge of four surfaces the god-object visits them in turn, and the slew spares the "
    "hand the step") {
    const Columns run = table_of("fig_3_1_2_patches");
    const auto step = [&](const std::string& force, std::size_t k) {
        double sum = 0.0;
        for (const std::string axis : {"_x_n", "_y_n", "_z_n"}) {
            const auto& f = run.at(force + axis);
            sum += (f[k] - f[k - 1]) * (f[k] - f[k - 1]);
        }
        return std::sqrt(sum);
    };
    double plain = 0.0;
    double slewed = 0.0;
    std::vector<double> visited;
    for (std::size_t k = 1; k < run.at("time_s").size(); ++k) {
        for (const std::string name : {"feedback_slow", "feedback", "newton"}) {
            REQUIRE(run.at(name + "_excess_m")[k] >= -1e-15);
        }
        if (run.at("mode")[k] == 0.0) {
            continue;
        }
        if (visited.empty() || visited.back() != run.at("surface")[k]) {
            visited.push_back(run.at("surface")[k]);
        }
        plain = std::max(plain, step("force_without_slew", k));
        slewed = std::max(slewed, step("force", k));
    }
    CHECK(visited == std::vector<double>{1.0, 2.0, 4.0});
    CHECK(plain > 5.0);
    CHECK(slewed < 0.25 * plain);
}

TEST_CASE("the recorded stick-slip transition takes 95 ms") {
    const Columns run = table_of("fig_3_3_1");
    const auto& mode = run.at("mode");
    const auto ticks = std::count(mode.begin(), mode.end(), 3.0);
    CHECK(ticks >= 95);
    CHECK(ticks <= 97);
}

TEST_CASE("a diagram without the node that an arrow names is refused") {
    Diagram diagram{.title = "a", .nodes = {{"one", "", 50.0, 50.0}}, .transitions = {{0, 1}}};
    CHECK_THROWS_AS(svg(diagram), std::invalid_argument);
    diagram.transitions = {{0, 0, "a < b & c"}};
    CHECK_NOTHROW(SvgReader(svg(diagram)));
    diagram.height = 0.0;
    CHECK_THROWS_AS(svg(diagram), std::invalid_argument);
}

TEST_CASE("palpate figures without its program names it and writes nothing") {
    const TemporaryFolder folder;
    std::filesystem::copy_file(palpate_program(), folder.file("palpate"));
    const auto done = Process({folder.file("palpate"), "figures", "-o", folder.file("x")}).wait();
    CHECK(done.code == 1);
    CHECK(done.error.find("build the target palpate_figures") != std::string::npos);
    CHECK(folder.names() == std::vector<std::string>{"palpate"});
}

TEST_CASE("palpate figures makes its folder and names every file that it wrote") {
    const TemporaryFolder folder;
    const std::string output = folder.file("a/b");
    const Finished done = ran({"figures", "-o", output});
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(output)) {
        CHECK(done.out.find(entry.path().string() + "\n") != std::string::npos);
        CHECK(entry.file_size() > 0);
        ++files;
    }
    CHECK(static_cast<std::size_t>(std::count(done.out.begin(), done.out.end(), '\n')) == files);
    CHECK(files > 2 * thesis_figures().size());
}
