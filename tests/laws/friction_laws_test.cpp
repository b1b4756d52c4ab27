#include "tests/support/program.hpp"
#include "tests/support/scene_text.hpp"
#include "tests/support/sql_first.hpp"

namespace {

/// Every law that a protocol may have, in two files of 7: its word, and its keys, as a protocol and
/// a scene have them alike.
const std::vector<Words> kWords = test_rows("friction_laws.tsv");

const std::string kStudy = test_text("laws_study.toml");

std::string protocol_of(std::size_t from, std::size_t to) {
    std::string text = kStudy;
    for (std::size_t i = from; i < to; ++i) {
        text += fmt::format("[[friction]]\nname = \"{0}\"\nlaw = \"{0}\"\n{1}", kWords[i][0],
                            kWords[i][1]);
    }
    return text;
}

std::string scene_of(const Words& law, bool convex) {
    return fmt::format(
               "[renderer]\nstiffness_n_per_m = 1000.0\n[friction]\nlaw = \"{}\"\n{}"
               "vertex_slew_m_per_s = 0.2\nvertex_radius_m = 0.003\n",
               law[0], law[1]) +
           two_arcs_text(convex ? 8.0 : -8.0);
}

using Rows = std::vector<Words>;

/// Of a soft object and a hard one.
std::string soft_study() {
    return replaced(kStudy, "curvature_per_m = 8\n",
                    "curvature_per_m = 8\ncompliance_mm_per_n = 3\n") +
           "[apparatus]\nrate_hz = 1000\nvertex_slew_mm_per_s = 0\n"
           "[[friction]]\nname = \"off\"\nlaw = \"frictionless\"\n"
           "[[friction]]\nname = \"gos\"\nlaw = \"gos\"\nmu_s = 0.7\nmu_d = 0.5\n";
}

}  // namespace

TEST_CASE(
    "every law of friction runs in a session, is replayed to the bit, and renders the same from "
    "its path") {
    const std::size_t from = GENERATE(0U, 7U);
    const TemporaryFolder folder;
    const std::string file = folder.file("laws.toml");
    const std::string db = folder.file("laws.sqlite");
    std::ofstream(file) << protocol_of(from, from + 7);
    CHECK_THAT(ran(run_words(file, "P1", db, {"--headless"})).out,
               Has("14 answered, 0 of them do not count, 0 faulted"));
    CHECK_THAT(ran({"verify", db}).out, Has("ticks replayed, nothing differs"));

    for (std::size_t i = from; i < from + 7; ++i) {
        CAPTURE(kWords[i][0]);
        const Rows trial = csv_body(sql_csv(
            db, fmt::format("SELECT trial_id, felt_object FROM presentation WHERE friction = '{}' "
                            "ORDER BY trial_id LIMIT 1",
                            kWords[i][0])));
        REQUIRE(trial.size() == 1);
        const std::string sample = sql_csv(
            db, fmt::format("SELECT time_s AS t_s, hip_x_m AS x_m, hip_y_m AS y_m, "
                            "rendered_normal_n AS fn_n, rendered_tangential_n AS ft_n, mode "
                            "FROM sample WHERE trial_id = {}",
                            trial[0][0]));
        const Columns rendered =
            columns_in(said_of("render", scene_of(kWords[i], trial[0][1] == "convex"), sample));
        std::map<std::string, int> modes;
        for (const auto& tick : csv_records(sample)) {
            ++modes[tick.at("mode")];
        }
        for (const char* force : {"fn_n", "ft_n"}) {
            CHECK(apart(columns_in(sample).at(force), rendered.at(force)) < 1e-9);
        }
        CHECK(modes["slip"] + modes["transition"] > 100);
        CHECK(modes["stuck"] > 0);
    }
}

TEST_CASE("snags lie by the length of an edge, whatever its knots and weights") {
    std::string path = "t_s,x_m,y_m\n";
    for (int i = 0; i < 3000; ++i) {
        path += fmt::format("{},{},{}\n", 1e-3 * i, -0.1495 + 299e-3 / 3000 * i,
                            0.001 - std::min(5e-3, 1e-3 * i));
    }
    const auto catches = [&](const std::string& segment) {
        const std::string scene =
            "[friction]\nlaw = \"snags\"\nmu_s = 0.11\nmu_d = 0.1\nsnag_spacing_m = 0.01\n"
            "law_seed = 5\n" +
            segment;
        Words at;
        std::string before = "STUCK";
        for (const Words& tick : csv_body(said_of("render", scene, path))) {
            if (tick[1] == "STUCK" && before != "STUCK") {
                at.push_back(tick[0]);
            }
            before = tick[1];
        }
        return at;
    };
    const auto line = catches(line_text({-0.15, 0.0}, {0.15, 0.0}));
    CHECK(line.size() >= 28);  // of 30, of which one may lie in the catch of another
    for (const NurbsData<2>& nurbs :
         {bezier_data({{-0.15, 0}, {-0.14, 0}, {-0.13, 0}, {0.15, 0}}),
          bezier_data({{-0.15, 0}, {0, 0}, {0.15, 0}}, {1, 0.05, 1}),
          NurbsData<2>{1, {0, 0, 0.9, 1, 1}, {{-0.15, 0}, {-0.1, 0}, {0.15, 0}}, {}}}) {
        CAPTURE(nurbs.knots);
        CHECK(catches(segment_text(nurbs)) == line);
    }
}

TEST_CASE("under a vertex slew knots that change nothing change no force") {
    std::string path = "t_s,x_m,y_m\n";
    for (int i = 0; i < 300; ++i) {  // deep, about the centre of curvature: its god-object runs
        path += fmt::format("{},{},{}\n", 1e-3 * i, 0.007 * std::cos(0.1 * i),
                            0.0585 + 0.0015 * std::sin(0.2 * i));
    }
    const auto rendered = [&](const NurbsData<2>& nurbs) {
        return columns_in(
            said_of("render",
                    "[friction]\nlaw = \"frictionless\"\nvertex_slew_m_per_s = 0.2\n" +
                        segment_text(nurbs) + line_text({0.03, 0.0}, {-0.03, 0.0}),
                    path));
    };
    const Columns whole =
        rendered(bezier_data({{-0.03, 0}, {-0.03, 0.09}, {0.03, 0.09}, {0.03, 0}}));
    CHECK(std::ranges::count(whole.at("slewed"), 1.0) > 20);
    for (const NurbsData<2>& same :  // knots inserted, in halves and beside them; a degree more
         {NurbsData<2>{3,
                       {0, 0, 0, 0, 0.25, 0.5, 0.75, 1, 1, 1, 1},
                       {{-0.03, 0},
                        {-0.03, 0.0225},
                        {-0.0225, 0.05625},
                        {0, 0.073125},
                        {0.0225, 0.05625},
                        {0.03, 0.0225},
                        {0.03, 0}},
                       {}},
          NurbsData<2>{3,
                       {0, 0, 0, 0, 0.3, 1, 1, 1, 1},
                       {{-0.03, 0}, {-0.03, 0.027}, {-0.012, 0.09}, {0.03, 0.063}, {0.03, 0}},
                       {}},
          bezier_data({{-0.03, 0}, {-0.03, 0.0675}, {0, 0.09}, {0.03, 0.0675}, {0.03, 0}})}) {
        CAPTURE(same.knots);
        const Columns other = rendered(same);
        CHECK(whole.at("slewed") == other.at("slewed"));
        CHECK(apart(whole.at("fx_n"), other.at("fx_n")) < 1e-9);
        CHECK(apart(whole.at("fy_n"), other.at("fy_n")) < 1e-9);
    }
}

TEST_CASE("check says which laws creep, chatter or are not passive, and refuses what diverges") {
    const TemporaryFile file("laws.toml");
    std::ofstream(file) << protocol_of(5, 9);
    const Finished check = ran({"check", file});
    CHECK_THAT(check.out, Has("\"stribeck\": the law stribeck (Stribeck 1902) creeps "
                              "under a load that it should hold, chatters",
                              "\"dahl\": the law dahl (Dahl 1968) creeps", "is not passive") &&
                              !Has("friction \"bristle\""));
    const auto checked = [&](const std::string& law, int code) {
        write(file, kStudy + "[[friction]]\nname = \"a\"\n" + law);
        const Finished said = ran({"check", file}, code);
        return said.out + said.error;
    };
    const std::string dahl = "law = \"dahl\"\nmu_d = 0.5\ntangential_stiffness_n_per_m = ";
    CHECK_THAT(
        checked("law = \"lugre_euler\"\nmu_s = 0.7\nmu_d = 0.5\n", 2),
        Has("diverges where sigma_0 |v| T / (mu_d F_N) > 2: at 1.5 m/s below a load of 1.5 N",
            "give \"lugre\""));
    CHECK_THAT(checked(dahl + "2000\n", 2), Has("above stiffness_n_per_m = 1000"));
    CHECK_THAT(checked(dahl + "100\n", 0),  // (0.5 x 10 N)^2 / (2 x 100 N/m)
               Has("of 100 N/m along the surface gives back up to 0.12 J"));
    CHECK_THAT(checked("law = \"viscous\"\nmu_d = 0.5\nviscous_n_s_per_m = 5\n", 1),
               Has("with a damper of 5 N s/m"));
}

TEST_CASE("an episode is one coming into contact of soft objects too, and no free tick is cut") {
    const TemporaryFolder folder;
    const std::string db =
        run_by({"P1"}, write(folder.file("soft.toml"), soft_study()), folder.file("soft.sqlite"));
    const auto trials = csv_body(sql_csv(
        db,
        "WITH s AS (SELECT trial_id, mode, flags, lag(mode, 1, 'free') OVER (PARTITION BY "
        "trial_id ORDER BY tick) AS was FROM sample JOIN presentation USING (trial_id) WHERE "
        "tick < ticks) "
        "SELECT felt_object, sum(mode <> 'free' AND was = 'free'), contact_episodes, "
        "sum(mode = 'free' AND flags & 32), worst_episode_j FROM s JOIN trial USING "
        "(trial_id) JOIN presentation USING (trial_id) GROUP BY trial_id"));
    REQUIRE(trials.size() == 4);
    std::size_t again = 0;
    for (const Words& trial : trials) {
        CAPTURE(trial[0]);
        CHECK(trial[1] == trial[2]);
        CHECK(trial[3] == "0");
        CHECK(std::stod(trial[4]) <= 1e-12);
        again += trial[0] == "convex" && trial[2] != "1" ? 1U : 0U;
    }
    CHECK(again > 0);  // the soft one is touched more than once
    CHECK_THAT(ran({"verify", db}).out, Has("ticks replayed, nothing differs"));
    sql_edit(db, "UPDATE trial SET contact_episodes = contact_episodes - 1 WHERE trial_id = 1");
    CHECK_THAT(ran({"verify", db}, 1).out, Has("contact_episodes"));
}
