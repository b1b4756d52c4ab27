#include "tests/support/program.hpp"

namespace {

struct LawText {
    const char* word;
    const char* keys;  ///< as a protocol and a scene have them alike
};

constexpr const char* kBoth = "mu_s = 0.7\nmu_d = 0.5\n";
constexpr const char* kOne = "mu_d = 0.5\n";

/// Every law that a protocol may have, in two files of 7.
const std::vector<LawText> kWords{
    {"gos", kBoth},
    {"coulomb", kOne},
    {"coulomb_sign", kOne},
    {"viscous", "mu_d = 0.5\nviscous_n_s_per_m = 0.1\n"},
    {"stiction", kBoth},
    {"stribeck", kBoth},
    {"karnopp", kBoth},
    {"dahl", "mu_d = 0.5\ndahl_exponent = 1.5\n"},
    {"bristle", "mu_s = 0.7\nmu_d = 0.5\nbristles = 12\nlaw_seed = 9\n"},
    {"reset_integrator", kBoth},
    {"lugre", "mu_s = 0.7\nmu_d = 0.5\nbristle_damping_n_s_per_m = 0.05\n"},
    {"hayward_armstrong", "mu_d = 0.5\nstick_share = 0.6\n"},
    {"friction_cone", "mu_s = 0.7\nmu_d = 0.5\ntangential_stiffness_n_per_m = 600\n"},
    {"snags", kBoth}};

const std::string kStudy = test_text("laws_study.toml");

std::string protocol_of(std::size_t from, std::size_t to) {
    std::string text = kStudy;
    for (std::size_t i = from; i < to; ++i) {
        text += fmt::format("[[friction]]\nname = \"{0}\"\nlaw = \"{0}\"\n{1}", kWords[i].word,
                            kWords[i].keys);
    }
    return text;
}

std::string scene_of(const LawText& law, bool convex) {
    const int curvature = convex ? 8 : -8;
    return fmt::format(
        "[renderer]\nstiffness_n_per_m = 1000.0\n[friction]\nlaw = \"{}\"\n{}vertex_slew_m_per_s = "
        "0.2\nvertex_radius_m = 0.003\n"
        "[[segment]]\nkind = \"arc\"\nfrom_m = [-0.04, 0.0]\nto_m = [0.0, 0.04]\ncurvature_per_m = "
        "{}\n"
        "[[segment]]\nkind = \"arc\"\nfrom_m = [0.0, 0.04]\nto_m = [0.04, 0.0]\ncurvature_per_m = "
        "{}\n"
        "[[segment]]\nkind = \"line\"\nfrom_m = [0.04, 0.0]\nto_m = [-0.04, 0.0]\n",
        law.word, law.keys, curvature, curvature);
}

using Rows = std::vector<Words>;

Rows asked(const std::string& file, const std::string& query) {
    return csv_body(sql_csv(file, query));
}

}  // namespace

TEST_CASE(
    "every law of friction runs in a session, is replayed to the bit, and renders the same from "
    "its path",
    "[friction][law]") {
    const std::size_t from = GENERATE(0U, 7U);
    const TemporaryFolder folder;
    const std::string file = folder.file("laws.toml");
    const std::string db = folder.file("laws.sqlite");
    std::ofstream(file) << protocol_of(from, from + 7);
    CHECK_THAT(ran(run_words(file, "P1", db, {"--headless"})).out,
               Has("14 answered, 0 of them do not count, 0 faulted"));
    CHECK_THAT(ran({"verify", db}).out, Has("ticks replayed, nothing differs"));

    for (std::size_t i = from; i < from + 7; ++i) {
        CAPTURE(kWords[i].word);
        const Rows trial = asked(
            db, fmt::format("SELECT trial_id, felt_object FROM presentation WHERE friction = '{}' "
                            "ORDER BY trial_id LIMIT 1",
                            kWords[i].word));
        REQUIRE(trial.size() == 1);
        const Rows ticks =
            asked(db, fmt::format("SELECT time_s, hip_x_m, hip_y_m, rendered_normal_n, "
                                  "rendered_tangential_n, mode FROM sample WHERE trial_id = {}",
                                  trial[0][0]));
        std::string path = "t_s,x_m,y_m\n";
        for (const auto& tick : ticks) {
            path += fmt::format("{},{},{}\n", tick[0], tick[1], tick[2]);
        }
        std::ofstream(folder.file("s.toml")) << scene_of(kWords[i], trial[0][1] == "convex");
        std::ofstream(folder.file("t.csv")) << path;
        ran({"render", folder.file("s.toml"), folder.file("t.csv"), "-o", folder.file("o.csv")});
        const Rows rendered = csv_body(slurp(folder.file("o.csv")));
        REQUIRE(rendered.size() == ticks.size());
        std::map<std::string, int> modes;
        double worst = 0.0;
        for (std::size_t k = 0; k < ticks.size(); ++k) {
            worst = std::max(worst, std::fabs(std::stod(ticks[k][3]) - std::stod(rendered[k][8])));
            worst = std::max(worst, std::fabs(std::stod(ticks[k][4]) - std::stod(rendered[k][9])));
            ++modes[ticks[k][5]];
        }
        CHECK(worst < 1e-9);
        CHECK(modes["slip"] + modes["transition"] > 100);
        CHECK(modes["stuck"] > 0);
    }
}

TEST_CASE("snags lie by the length of an edge, whatever its knots and weights", "[friction][law]") {
    const TemporaryFolder folder;
    std::string path = "t_s,x_m,y_m\n";
    for (int i = 0; i < 3000; ++i) {
        path += fmt::format("{},{},{}\n", 1e-3 * i, -0.1495 + 299e-3 / 3000 * i,
                            0.001 - std::min(5e-3, 1e-3 * i));
    }
    std::ofstream(folder.file("t.csv")) << path;
    const auto catches = [&](const std::string& segment) {
        std::ofstream(folder.file("s.toml"))
            << "[friction]\nlaw = \"snags\"\nmu_s = 0.11\nmu_d = 0.1\nsnag_spacing_m = "
               "0.01\nlaw_seed = 5\n[[segment]]\n"
            << segment;
        std::vector<std::string> at;
        std::string before = "STUCK";
        for (const Words& tick :
             csv_body(ran({"render", folder.file("s.toml"), folder.file("t.csv")}).out)) {
            if (tick[1] == "STUCK" && before != "STUCK") {
                at.push_back(tick[0]);
            }
            before = tick[1];
        }
        return at;
    };
    const auto line = catches("kind = \"line\"\nfrom_m = [-0.15, 0]\nto_m = [0.15, 0]\n");
    CHECK(line.size() >= 28);  // of 30, of which one may lie in the catch of another
    for (const char* const nurbs :
         {"degree = 3\nknots = [0, 0, 0, 0, 1, 1, 1, 1]\n"
          "points_m = [[-0.15, 0], [-0.14, 0], [-0.13, 0], [0.15, 0]]\n",
          "degree = 2\nknots = [0, 0, 0, 1, 1, 1]\nweights = [1, 0.05, 1]\n"
          "points_m = [[-0.15, 0], [0, 0], [0.15, 0]]\n",
          "degree = 1\nknots = [0, 0, 0.9, 1, 1]\npoints_m = [[-0.15, 0], [-0.1, 0], [0.15, "
          "0]]\n"}) {
        CAPTURE(nurbs);
        CHECK(catches(std::string("kind = \"nurbs\"\n") + nurbs) == line);
    }
}

TEST_CASE("under a vertex slew knots that change nothing change no force", "[friction][law]") {
    const TemporaryFolder folder;
    std::string path = "t_s,x_m,y_m\n";
    for (int i = 0; i < 300; ++i) {  // deep, about the centre of curvature: its god-object runs
        path += fmt::format("{},{},{}\n", 1e-3 * i, 0.007 * std::cos(0.1 * i),
                            0.0585 + 0.0015 * std::sin(0.2 * i));
    }
    std::ofstream(folder.file("t.csv")) << path;
    const auto rendered = [&](const std::string& nurbs) {
        std::ofstream(folder.file("s.toml"))
            << "[friction]\nlaw = \"frictionless\"\nvertex_slew_m_per_s = 0.2\n"
               "[[segment]]\nkind = \"nurbs\"\n"
            << (nurbs.starts_with("degree") ? "" : "degree = 3\n") << nurbs
            << "[[segment]]\nkind = \"line\"\nfrom_m = [0.03, 0]\nto_m = [-0.03, 0]\n";
        return csv_body(ran({"render", folder.file("s.toml"), folder.file("t.csv")}).out);
    };
    const Rows whole = rendered(
        "knots = [0, 0, 0, 0, 1, 1, 1, 1]\n"
        "points_m = [[-0.03, 0], [-0.03, 0.09], [0.03, 0.09], [0.03, 0]]\n");
    int slewed = 0;
    for (const Words& tick : whole) {
        slewed += tick[13] == "1" ? 1 : 0;
    }
    CHECK(slewed > 20);
    for (const char* const same :  // knots inserted, in halves and beside them; a degree more
         {"knots = [0, 0, 0, 0, 0.25, 0.5, 0.75, 1, 1, 1, 1]\n"
          "points_m = [[-0.03, 0], [-0.03, 0.0225], [-0.0225, 0.05625], [0, 0.073125], "
          "[0.0225, 0.05625], [0.03, 0.0225], [0.03, 0]]\n",
          "knots = [0, 0, 0, 0, 0.3, 1, 1, 1, 1]\n"
          "points_m = [[-0.03, 0], [-0.03, 0.027], [-0.012, 0.09], [0.03, 0.063], [0.03, 0]]\n",
          "degree = 4\nknots = [0, 0, 0, 0, 0, 1, 1, 1, 1, 1]\n"
          "points_m = [[-0.03, 0], [-0.03, 0.0675], [0, 0.09], [0.03, 0.0675], [0.03, 0]]\n"}) {
        const Rows other = rendered(same);
        REQUIRE(whole.size() == other.size());
        for (std::size_t i = 0; i < whole.size(); ++i) {
            CAPTURE(same, whole[i][0]);
            CHECK(whole[i][13] == other[i][13]);
            for (const std::size_t force : {10U, 11U}) {
                CHECK(std::stod(whole[i][force]) ==
                      Approx(std::stod(other[i][force])).margin(1e-9));
            }
        }
    }
}

TEST_CASE("check says which laws creep, chatter or are not passive, and refuses what diverges",
          "[friction][cli]") {
    const TemporaryFile file("laws.toml");
    std::ofstream(file) << protocol_of(5, 9);
    const Finished check = ran({"check", file});
    CHECK_THAT(check.out, Has("\"stribeck\": the law stribeck (Stribeck 1902) creeps "
                              "under a load that it should hold, chatters",
                              "\"dahl\": the law dahl (Dahl 1968) creeps", "is not passive") &&
                              !Has("friction \"bristle\""));
    std::ofstream(file)
        << kStudy << "[[friction]]\nname = \"a\"\nlaw = \"lugre_euler\"\nmu_s = 0.7\nmu_d = 0.5\n";
    CHECK_THAT(
        ran({"check", file}, 2).error,
        Has("diverges where sigma_0 |v| T / (mu_d F_N) > 2: at 1.5 m/s below a load of 1.5 N",
            "give \"lugre\""));
    std::ofstream(file) << kStudy
                        << "[[friction]]\nname = \"a\"\nlaw = \"dahl\"\nmu_d = "
                           "0.5\ntangential_stiffness_n_per_m = 2000\n";
    CHECK_THAT(ran({"check", file}, 2).error, Has("above stiffness_n_per_m = 1000"));
    std::ofstream(file) << kStudy
                        << "[[friction]]\nname = \"a\"\nlaw = \"dahl\"\nmu_d = "
                           "0.5\ntangential_stiffness_n_per_m = 100\n";
    const Finished soft = ran({"check", file});  // (0.5 x 10 N)^2 / (2 x 100 N/m)
    CHECK_THAT(soft.out, Has("of 100 N/m along the surface gives back up to 0.12 J"));
    std::ofstream(file)
        << kStudy
        << "[[friction]]\nname = \"a\"\nlaw = \"viscous\"\nmu_d = 0.5\nviscous_n_s_per_m = 5\n";
    CHECK_THAT(ran({"check", file}, 1).out, Has("with a damper of 5 N s/m"));
}
