#include <cctype>

#include "tests/support/program.hpp"
#include "tests/support/scene_text.hpp"

using engine::Vec2;

namespace {

using Row = std::map<std::string, std::string>;

double number_of(const Row& row, const std::string& name) {
    return std::stod(row.at(name));
}
Vec2 point(const Row& row, const std::string& name) {
    return {number_of(row, name + "_x_m"), number_of(row, name + "_y_m")};
}

std::vector<Row> rows_of(const std::string& file, const std::string& query) {
    return csv_records(sql_csv(file, query));
}

/// Two hillsides of several spans each, with uneven knots that do not begin at 0 and a kink within
/// the first. They meet at vertex 0, which is that of a two-curve object as well; a base line
/// closes them.
const std::vector<NurbsData<2>> kHill{
    {2,
     {0, 0, 0, 0.3, 1, 1, 2, 2, 2},
     {{-0.04, 0.0}, {-0.034, 0.01}, {-0.027, 0.019}, {-0.019, 0.0268}, {-0.01, 0.034}, {0.0, 0.04}},
     {1, 1.5, 0.7, 1, 2, 1}},
    {3,
     {5, 5, 5, 5, 6, 6.5, 8, 8, 8, 8},
     {{0.0, 0.04},
      {0.0095, 0.0345},
      {0.0185, 0.0275},
      {0.0265, 0.02},
      {0.0335, 0.0105},
      {0.04, 0.0}},
     {1, 1, 1, 1, 1, 1}},
    {1, {0, 0, 1, 1}, {{0.04, 0.0}, {-0.04, 0.0}}, {1, 1}},
};

std::string hill_tables(const std::string& head) {
    std::string text;
    for (const NurbsData<2>& segment : kHill) {
        text += segment_text(segment, head);
    }
    return text;
}

const std::string kHills = test_text("hills.toml");

std::string scene_text(const Row& trial) {
    const bool rubs = trial.at("friction") == "on";
    return fmt::format(
               "[renderer]\nstiffness_n_per_m = 1000.0\n[friction]\nlaw = {}\n"
               "vertex_slew_m_per_s = 0.2\nvertex_radius_m = 0.003\n",
               rubs ? "\"gos\"\nmu_s = 0.7\nmu_d = 0.5\ntau_slip_s = 0.02\ntau_heal_s = 0.1"
                    : "\"frictionless\"") +
           (trial.at("object") == "hill" ? hill_tables("segment") : two_arcs_text(8.0));
}

/// The point of a segment of the hill, from the definition of a NURBS.
Vec2 on_hill(std::size_t segment, double u) {
    const auto [x, y] = nurbs_point(kHill.at(segment), u);
    return {static_cast<double>(x), static_cast<double>(y)};
}

/// One trial's ticks of `sample` and what `palpate render` makes of their path.
struct Felt {
    std::vector<Row> sample;
    std::vector<Row> rendered;
};

Felt felt_in(const TemporaryFolder& folder, const std::string& file, const Row& trial) {
    Felt felt{rows_of(file, "SELECT * FROM sample WHERE trial_id = " + trial.at("trial_id")), {}};
    std::string path = "t_s,x_m,y_m\n";
    for (const Row& tick : felt.sample) {
        path +=
            fmt::format("{},{},{}\n", tick.at("time_s"), tick.at("hip_x_m"), tick.at("hip_y_m"));
    }
    std::ofstream(folder.file("s.toml")) << scene_text(trial);
    std::ofstream(folder.file("t.csv")) << path;
    ran({"render", folder.file("s.toml"), folder.file("t.csv"), "-o", folder.file("o.csv")});
    felt.rendered = csv_records(slurp(folder.file("o.csv")));
    REQUIRE(felt.rendered.size() == felt.sample.size());
    return felt;
}

/// What the recorded hand felt is what `render` makes of its path, and both name places of the same
/// segments.
void check_rendered(const Felt& felt, bool hill, bool rubs, std::map<int, int>& visits) {
    for (std::size_t i = 0; i < felt.sample.size(); ++i) {
        const Row& tick = felt.sample[i];
        const Row& again = felt.rendered[i];
        CAPTURE(i);
        const int place = std::stoi(tick.at("segment"));
        const int segment = place >= 0 ? place : -1 - place;  // vertex j is at the end of segment j
        const double u = number_of(tick, "u");
        const Vec2 go = point(tick, "go");
        const bool skipped = (std::stoi(tick.at("flags")) & 16) != 0;
        ++visits[place];
        REQUIRE((segment >= 0 && segment < 3));
        if (hill) {
            const double end = kHill[static_cast<std::size_t>(segment)].knots.back();
            const Vec2 named = on_hill(static_cast<std::size_t>(segment), place >= 0 ? u : end);
            REQUIRE(glm::length(named - go) < 1e-9);
            const Vec2 cp = on_hill(static_cast<std::size_t>(std::stoi(again.at("segment"))),
                                    number_of(again, "u"));
            REQUIRE(glm::length(cp - point(again, "cp")) < 1e-9);
        }
        if (skipped) {
            continue;  // sample then has the last closest point that was looked for
        }
        // Without friction a god-object at rest is a matter of last bits.
        std::string mode = again.at("mode");
        std::ranges::transform(mode, mode.begin(), [](unsigned char c) { return std::tolower(c); });
        REQUIRE(
            (tick.at("mode") == mode || (!rubs && tick.at("mode") != "free" && mode != "free")));
        REQUIRE(glm::length(go - point(again, "go")) < 1e-9);
        REQUIRE(glm::length(point(tick, "cp") - point(again, "cp")) < 1e-9);
        REQUIRE(std::fabs(number_of(tick, "rendered_normal_n") - number_of(again, "fn_n")) < 1e-6);
        REQUIRE(std::fabs(number_of(tick, "rendered_tangential_n") - number_of(again, "ft_n")) <
                1e-6);
        if (go == point(tick, "cp")) {  // render names the closest point's place
            REQUIRE(std::stoi(again.at("segment")) == segment);
            REQUIRE((place < 0 || std::fabs(number_of(again, "u") - u) < 1e-9));
        }
    }
}

/// Before and after the vertex, which is at x = 0 whatever the spans: by where the god-object was.
void check_sides(const Felt& felt, const Row& trial) {
    std::array<std::int64_t, 2> inner{};
    std::array<std::int64_t, 2> outer{};
    for (const Row& tick : felt.sample) {
        if (std::stoll(tick.at("tick")) < std::stoll(trial.at("ticks")) &&
            tick.at("mode") != "free") {
            const double x = number_of(tick, "go_x_m");
            inner[0] += x < -1e-9 ? 1 : 0;
            outer[0] += x < 1e-9 ? 1 : 0;
            inner[1] += x > 1e-9 ? 1 : 0;
            outer[1] += x > -1e-9 ? 1 : 0;
        }
    }
    const std::array<std::int64_t, 2> shown{std::llround(1e3 * number_of(trial, "before_vertex_s")),
                                            std::llround(1e3 * number_of(trial, "after_vertex_s"))};
    for (std::size_t side : {0U, 1U}) {
        CAPTURE(side, inner, outer, shown);
        CHECK((shown[side] >= inner[side] && shown[side] <= outer[side]));
        CHECK(inner[side] > 100);
    }
}

/// The motion of each run of a BIDS export, by its own list of channels.
std::vector<std::vector<Row>> bids_runs(const std::filesystem::path& out) {
    std::map<std::string, std::vector<Row>> runs;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(out)) {
        const std::string path = entry.path().string();
        const std::string end = "_motion.tsv";
        if (path.size() < end.size() || path.compare(path.size() - end.size(), end.size(), end)) {
            continue;
        }
        const std::string stem = path.substr(0, path.size() - end.size());
        Words names;
        for (const Row& channel : csv_records(slurp(stem + "_channels.tsv"), '\t')) {
            names.push_back(channel.at("name"));
        }
        runs[path] = csv_records(slurp(path), '\t', names);
    }
    std::vector<std::vector<Row>> all;
    for (auto& [name, rows] : runs) {
        all.push_back(std::move(rows));
    }
    return all;
}

}  // namespace

TEST_CASE("sample, render, the views and BIDS name the same segment of a form of many spans") {
    const TemporaryFolder folder;
    write(folder.file("p.toml"), kHills + hill_tables("object.segment"));
    const std::string file = run_by({"P1"}, folder.file("p.toml"), folder.file("a.sqlite"));
    const std::vector<Row> trials = rows_of(
        file,
        "SELECT trial_id, s.planned_object AS object, friction, before_vertex_s, after_vertex_s, "
        "ticks FROM analysis_trial AS s JOIN trial USING (trial_id) ORDER BY trial_id");
    REQUIRE(trials.size() == 4);
    ran({"export", file, "--format", "bids", "--kind", "simulated", "--traces", "-o",
         folder.file("out")});
    const auto runs = bids_runs(folder.file("out"));
    REQUIRE(runs.size() == trials.size());

    std::map<int, int> on_spans;
    for (std::size_t i = 0; i < trials.size(); ++i) {
        const bool hill = trials[i].at("object") == "hill";
        CAPTURE(trials[i].at("object"), trials[i].at("friction"));
        const Felt felt = felt_in(folder, file, trials[i]);
        std::map<int, int> visits;
        check_rendered(felt, hill, trials[i].at("friction") == "on", visits);
        check_sides(felt, trials[i]);
        CHECK((visits[0] > 100 && visits[1] > 100));
        REQUIRE(runs[i].size() == felt.sample.size());
        for (std::size_t k = 0; k < runs[i].size(); ++k) {
            CAPTURE(k);
            REQUIRE(number_of(runs[i][k], "segment") == number_of(felt.sample[k], "segment"));
            REQUIRE(number_of(runs[i][k], "u") == number_of(felt.sample[k], "u"));
            REQUIRE(number_of(runs[i][k], "go_x_m") == number_of(felt.sample[k], "go_x_m"));
            if (const double u = number_of(felt.sample[k], "u");
                hill && felt.sample[k].at("segment") == "0") {
                ++on_spans[u < 0.3 ? 0 : u < 1.0 ? 1 : 2];
            }
        }
    }
    CHECK((on_spans[1] > 50 && on_spans[2] > 50));  // all of segment 0
    ran({"verify", file});
}
