#include "protocols/file/protocol_file.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/slurp.hpp"

using namespace palpate::protocols;
using namespace palpate::tests;

namespace {

std::string default_study() {
    return slurp(std::filesystem::path(PALPATE_SOURCE_DIR) /
                 "protocols/library/shape_friction.toml");
}

/// One change to the default study, and what must be said about it. `at` marks, in the changed
/// text, where the message must point.
struct Change {
    const char* from;
    const char* to;
    const char* at;
    const char* says;
};

std::string place_of(const std::string& text, const std::string& at) {
    const std::size_t offset = text.find(at);
    REQUIRE(offset != std::string::npos);
    const auto before = text.begin() + static_cast<std::ptrdiff_t>(offset);
    const auto line = 1 + std::count(text.begin(), before, '\n');
    const std::size_t start = text.rfind('\n', offset);
    const std::size_t column = start == std::string::npos ? offset + 1 : offset - start;
    return "p.toml:" + std::to_string(line) + ":" + std::to_string(column) + ": ";
}

const Change kChanges[] = {
    // Keys.
    {"mu_s =", "mu_z = 1\nmu_s =", "mu_z",
     "unknown key \"mu_z\" in [[friction]] 2: did you mean mu_"},
    {"stiffness_n_per_m =", "stiffness =", "stiffness =", "did you mean stiffness_n_per_m?"},
    {"[timing]", "[timings]", "timings]", "unknown key or table \"timings\": did you mean timing?"},
    {"[observer]", "[zzzzzzzzzz]", "zzzzzzzzzz", "\"zzzzzzzzzz\": delete it"},
    {"title =", "#", "study]", "[study] lacks the key title: add it"},
    {"repetitions = 10 ", "#", "design]", "lacks the key repetitions"},
    {"name = \"convex_5\"\n", "", "[[object]]\ncurvature_per_m = 5",
     "[[object]] 4 lacks the key name"},
    {"format = 1", "format = 2", "2", "this program reads format = 1"},
    {"format = 1", "", "# Felt", "begin it with format = 1"},
    // Types.
    {"repetitions = 10 ", "repetitions = 10.0 ", "10.0",
     "repetitions is 10 (a number): give an integer"},
    {"repetitions = 10 ", "repetitions = \"ten\" ", "\"ten\"", "give an integer"},
    {"gap_s = 1.5", "gap_s = true", "true", "gap_s is true (true or false): give a number"},
    {"gap_s = 1.5", "gap_s = 07:32:00", "07:32", "a date or time"},
    {"start_mm = [0, 60]", "start_mm = [0, 60, 1]", "[0, 60, 1]", "give two numbers as [x, y]"},
    {"start_mm = [0, 60]", "start_mm = 60", "60 ", "give two numbers as [x, y]"},
    {"pictured = false", "pictured = 0", "0\n\n[[object]]\nname = \"convex_20\"",
     "give true or false"},
    {"id = \"shape_friction\"", "id = \"Shape friction\"", "\"Shape", "letters a-z, digits and _"},
    {"title = \"Felt shape,", "title = \"Felt\\nshape,", "\"Felt\\n", "on one line"},
    {"[timing]", "[[timing]]", "timing]]", "write it as a table, [timing]"},
    // Ranges.
    {"rate_hz = 1000", "rate_hz = 999", "999", "rate_hz is 999: give 1000 to 10000"},
    {"stiffness_n_per_m = 1000", "stiffness_n_per_m = 0", "0\nforce_limit",
     "give above 0, at most 20000"},
    {"gap_s = 1.5", "gap_s = nan", "nan", "gap_s is nan: give 0 to 60"},
    {"gap_s = 1.5", "gap_s = inf", "inf", "gap_s is inf"},
    {"gap_s = 1.5", "gap_s = -0.1", "-0.1", "gap_s is -0.1"},
    {"seed = 20260114", "seed = -1", "-1", "seed is -1: give 0 to 9223372036854775807"},
    {"lapse = 0.02", "lapse = 1.01", "1.01", "lapse is 1.01: give 0 to 1"},
    {"start_mm = [0, 60]", "start_mm = [0, 6000]", "[0, 6000]", "start_mm is 6000"},
    {"slew_limit_n_per_ms = 2", "slew_limit_n_per_ms = 0", "0  # stiff", "above 0, at most 500"},
    {"speed_limit_m_per_s = 1.5", "speed_limit_m_per_s = 10.5", "10.5", "above 0, at most 10"},
    {"late_in_a_row = 20", "late_in_a_row = 101", "101", "late_in_a_row is 101: give 0 to 100"},
    {"late_of_100 = 50", "late_of_100 = -1", "-1\nenergy", "late_of_100 is -1: give 0 to 100"},
    {"energy_limit_j = 0.1", "energy_limit_j = inf", "inf", "energy_limit_j is inf"},
    {"dead_man = false", "dead_man = 0", "0         # or", "give true or false"},
    {"dead_man = false", "deadman = true", "deadman", "did you mean dead_man?"},
    {"damping_n_s_per_m = 0 ", "damping_n_s_per_m = -1 ", "-1 ", "give 0 to 100"},
    {"damping_n_s_per_m = 0 ", "damping = 0 ", "damping = 0", "did you mean damping_n_s_per_m?"},
    {"blocks = 1 ", "blocks = 0 ", "0               # more", "blocks is 0: give 1 to 1000"},
    {"blocks = 1 ", "blocks = \"one\" ", "\"one\"", "give an integer"},
    {"order = \"random\"", "order = \"randm\"", "\"randm\"",
     "order is \"randm\", give \"random\" or \"first_order\": did you mean random?"},
    {"friction_blocks = \"interleaved\"", "friction_blocks = \"abab\"", "\"abab\"",
     "give \"interleaved\", \"abba\" or \"blocked\""},
    {"friction_blocks = \"interleaved\"", "friction_blocks = \"abba\"", "\"abba\"",
     "there and back, and blocks is 1: give an even number"},
    {"catch_correct_min = 0 ", "catch_correct_min = 1.5 ", "1.5    # share", "give 0 to 1"},
    {"sessions_finished = false", "sessions_finished = 1", "1\n\n[design]", "give true or false"},
    {"timed_out_share_max", "time_out_share_max", "time_out_share_max",
     "in [exclusion]: did you mean timed_out_share_max?"},
    {"order = \"random\"", "order = true", "true         # or", "give \"random\" or"},
    {"language = \"en\"", "language = \"de\"", "\"de\"", "give \"en\" or \"tr\""},
    {"handedness = \"right\"", "handedness = \"lft\"", "\"lft\"",
     "give \"right\", \"left\" or \"any\": did you mean left?"},
    // Rules.
    {"name = \"convex_5\"", "name = \"convex_10\"", "\"convex_10\"\ncurvature_per_m = 10",
     "as in [[object]] 4"},
    {"name = \"on\"", "name = \"off\"", "\"off\"\nlaw = \"gos\"", "as in [[friction]] 1"},
    {"curvature_per_m = 5", "curvature_per_m = 10", "10\n\n# Catch",
     "pictured objects need curvatures of their own"},
    {"mu_d = 0.5", "mu_d = 0.8", "0.8", "mu_d is 0.8, above mu_s = 0.7"},
    {"mu_s = 0.7", "mu_s = 0", "0\nmu_d", "give above 0"},
    {"mu_s = 0.7\n", "", "[[friction]]\nname = \"on\"", "law \"gos\" needs the key mu_s"},
    {"law = \"gos\"", "law = \"goss\"", "\"goss\"", "give one of frictionless, gos, coulomb, "},
    {"law = \"frictionless\"", "law = \"frictionless\"\nmu_d = 0", "0\n\n[[friction]]",
     "law is \"frictionless\", which does not read it: delete it, or give another law"},
    {"law = \"gos\"", "law = \"dahl\"", "0.7\nmu_d", "mu_s is given, but law is \"dahl\""},
    {"law = \"gos\"", "law = \"viscous\"", "[[friction]]\nname = \"on\"",
     "law \"viscous\" needs the key viscous_n_s_per_m"},
    {"law = \"gos\"", "law = \"bristle\"\nbristles = 65", "65\nmu_s",
     "bristles is 65: give 1 to 64"},
    {"explore_min_s = 2", "explore_min_s = 45", "45\nexplore_prompt", "nobody could answer"},
    {"explore_prompt_s = 30", "explore_prompt_s = 46", "46", "after explore_timeout_s = 45"},
    {"start_mm = [0, 60]", "start_mm = [0, 20]", "[0, 20]", "inside the object"},
    {"curvature_per_m = 20", "curvature_per_m = 34", "34",
     "too strong for a chord of 56.6 mm: stay below 33.6"},
    {"curvature_per_m = -20", "curvature_per_m = -26", "-26", "hollow"},
    {"vertex_mm = [0, 40]", "vertex_mm = [41, 40]", "[41, 40]", "from left to right"},
    {"vertex_mm = [0, 40]", "vertex_mm = [0, -40]", "[0, -40]", "above the base line"},
    {"repetitions = 10 ", "repetitions = 1000 ", "1000 ", "ask for 10000 or fewer"},
    {"blocks = 1 ", "blocks = 3 ", "3               # more",
     "blocks is 3, but 10 repetitions cannot be divided evenly into them: give a divisor"},
    {"order = \"random\"", "order = \"first_order\"", "4         # both",
     "catch_trials is 4: order = \"first_order\" has no room for catch trials: give 0"},
    // Syntax.
    {"rate_hz = 1000", "rate_hz = ", "\nstiffness", "not TOML"},
    {"rate_hz = 1000", "rate_hz = 1000\nrate_hz = 1000", "rate_hz = 1000\nstiffness", "not TOML"},
};

}  // namespace

TEST_CASE("every wrong file is refused at the right place, with the value and a remedy",
          "[protocol]") {
    REQUIRE(refusal(default_study()) == "accepted");
    for (const Change& change : kChanges) {
        std::string text = default_study();
        const std::size_t found = text.find(change.from);
        REQUIRE(found != std::string::npos);
        text.replace(found, std::string(change.from).size(), change.to);
        CAPTURE(change.from, change.to);
        const std::string said = refusal(text);
        CHECK_THAT(said, Has(change.says));
        const bool syntax = std::string(change.says) == "not TOML";
        CHECK_THAT(said, StartsWith(syntax ? "p.toml:" : place_of(text, change.at)));
    }
}

TEST_CASE("run limits that no order can keep point at the limit", "[protocol]") {
    std::string text = default_study();
    const std::string second = "name = \"on\"";
    // Only one friction left: every trial has it.
    text.erase(text.find("[[friction]]\n" + second),
               text.find("[design]") - text.find("[[friction]]\n" + second));
    const std::string said = refusal(text);
    CHECK_THAT(said, StartsWith(place_of(text, "3     # two levels")));
    CHECK_THAT(said, Has("max_run_friction is 3", "0 for no limit"));
}

TEST_CASE("catch trials need an object that is not pictured", "[protocol]") {
    std::string text = default_study();
    for (std::size_t at = 0; (at = text.find("pictured = false\n")) != std::string::npos;) {
        text.erase(at, std::string("pictured = false\n").size());
    }
    CHECK_THAT(refusal(text),
               StartsWith(place_of(text, "4         # both")) && Has("every object is pictured"));
}

TEST_CASE("a first-order order says all that it needs, and then needs no run limit", "[protocol]") {
    const std::string text =
        replaced(default_study(), "order = \"random\"", "order = \"first_order\"");
    const std::string said = refusal(
        edited(text, {{"repetitions = 10 ", "repetitions = 9 "}, {"blocks = 1 ", "blocks = 3 "}}));
    CHECK(std::count(said.begin(), said.end(), '\n') == 2);
    CHECK_THAT(said, Has("lets each of 10 conditions follow each"));
    CHECK(refusal(edited(text, {{"catch_trials = 4", "catch_trials = 0"},
                                {"max_run_object = 2", "max_run_object = 1"}})) == "accepted");
}

TEST_CASE("fewer than two pictures are no choice", "[protocol]") {
    const std::string text =
        "format = 1\nstudy = {id = \"s\", title = \"t\", seed = 1}\ndesign = {repetitions = 1}\n"
        "object = [{name = \"a\", curvature_per_m = 1}]\nfriction = [{name = \"f\", law = "
        "\"frictionless\"}]\n";
    CHECK_THAT(refusal(text), Has("there are 1 pictured objects: give 2 to 9"));
    CHECK_THAT(refusal("format = 1\nobject = 3\nfriction = [3]\n"),
               Has("with two brackets", "friction 1 is 3"));
}

TEST_CASE("all problems of a stage are said at once, in the order of the file", "[protocol]") {
    const std::string said = refusal(edited(default_study(), {{"gap_s = 1.5", "gap_s = -1"},
                                                              {"rate_hz = 1000", "rate_hz = 10"},
                                                              {"mu_s = 0.7", "mu_s = \"much\""}}));
    CHECK(std::count(said.begin(), said.end(), '\n') == 2);
    CHECK(said.find("rate_hz") < said.find("mu_s"));
    CHECK(said.find("mu_s") < said.find("gap_s"));
}

TEST_CASE("a file that cannot be read says so in the same form", "[protocol]") {
    CHECK_THROWS_WITH(
        load_protocol("/nowhere/p.toml"),
        "/nowhere/p.toml:1:1: cannot be read: No such file or directory; check the path");
    CHECK_THROWS_WITH(load_protocol("/"), "/:1:1: cannot be read: it is a folder; check the path");
}
