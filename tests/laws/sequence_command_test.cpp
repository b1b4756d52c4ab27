#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

namespace {

/// What sequence says of a session in a database, against what was run there.
void check_against(const std::string& file, std::int64_t session, const Words& words) {
    const std::string of = fmt::format(" WHERE session_id = {}", session);
    const Words command = joined({"sequence"}, words);
    CHECK_THAT(ran(command).out,
               Has("plan " + sql_first(file, "SELECT plan_sha256 FROM session" + of) + '\n',
                   "pictures, left to right: " +
                       sql_first(file,
                                 "SELECT group_concat(picture_object, ' ') FROM (SELECT "
                                 "picture_object FROM picture" +
                                     of + " ORDER BY picture_place)") +
                       '\n'));
    CHECK(ran(joined(command, {"--csv"})).out ==
          sql_csv(file,
                  "SELECT plan_position AS position, phase, 0 AS block, planned_object AS "
                  "object, curvature_per_m, friction, mu_s, mu_d, break_before FROM plan" +
                      of + " ORDER BY 1"));
}

Words words_of_run(const std::string& participant, const std::string& file) {
    return run_words("shape_friction_demo", participant, file, {"--headless"});
}

}  // namespace

TEST_CASE("sequence prints exactly the plan that is run, before and after") {
    const TemporaryFolder folder;
    const std::string file = folder.file("demo.sqlite");
    ran({"sequence", "shape_friction_demo", "--participant", "demo"});
    CHECK(folder.names().empty());
    const Finished demo = ran({"demo", "--headless", "--db", file});
    check_against(file, 1, {"shape_friction_demo", "--participant", "demo", "--db", file});
}

TEST_CASE("sequence knows another seed, another session, and who already ran") {
    const TemporaryFile file("d.sqlite");
    ran(words_of_run("P1", file));
    // As if a person had been there: the next row of pictures depends on it.
    sql_edit(file, "UPDATE session SET session_kind = 'real'");
    const Words next = {"shape_friction_demo", "--participant", "P2", "--db", file, "--seed", "5"};
    const Finished announced = palpate_command(joined({"sequence"}, next));
    const Words run = joined(words_of_run("P2", file), {"--seed", "5"});
    CHECK_THAT(ran(run).out, Has("code " + behind(announced.out, "code ").substr(0, 9)));
    check_against(file, 2, {"shape_friction_demo", "--participant", "P2", "--db", file});
    CHECK_THAT(announced.out, Has("used by 0 other participants"));

    const Words second = {
        "shape_friction_demo", "--participant", "P2", "--db", file, "--session", "2"};
    const Words again = joined(words_of_run("P2", file), {"--session", "2"});
    const std::string code = ran(joined(joined({"sequence"}, second), {"--kind", "simulated"})).out;
    CHECK_THAT(ran(again).out, Has("code " + behind(code, "code ").substr(0, 9)));
    check_against(file, 3, second);
}

TEST_CASE("a session with a plan of another algorithm is refused, not mixed") {
    const TemporaryFile file("d.sqlite");
    ran(words_of_run("P1", file));
    sql_edit(file, "UPDATE session SET finished = 0, plan_sha256 = lower(hex(zeroblob(32)))");
    CHECK_THAT(ran(words_of_run("P1", file), 1).error, Has("begun with another plan"));
    CHECK_THAT(
        ran({"sequence", "shape_friction_demo", "--participant", "P1", "--db", file}, 2).error,
        Has("begun with another version", "table plan"));
}

TEST_CASE("the plan of a session that was run under another code is printed as it was run") {
    const TemporaryFile file("d.sqlite");
    ran(words_of_run("P1", file));
    ran({"participant", file, "P5", "--new"});
    ran({"participant", file, "P1", "--is-really", "P5", "--reason", "mistyped"});
    check_against(file, 1, {"shape_friction_demo", "--participant", "P5", "--db", file});
}

TEST_CASE("sequence prints the exact plan of a file, and an example without one") {
    const TemporaryFile file("study.sqlite");
    const auto sequence = [&](const std::string& code, bool of_file) {
        return palpate_command(
            joined({"sequence", "shape_friction_demo", "--participant", code, "--csv"},
                   of_file ? Words{"--db", file} : Words{}));
    };
    const auto run = [&](const std::string& code) {
        return palpate_command(run_words("shape_friction_demo", code, file, {"--headless"})).code;
    };
    REQUIRE(run("P01") == 0);
    const std::string next = sequence("P02", true).out;  // of the session that is not there yet
    const Finished example = sequence("P02", false);
    CHECK_THAT(example.error, Has("example"));
    CHECK(example.out != next);
    CHECK(sequence("P02", true).error.empty());
    REQUIRE(run("P02") == 0);
    CHECK(sequence("P02", true).out == next);
    for (const std::string& row : lines_in(
             sql_lines(file,
                       "SELECT plan_position || ',' || phase || ',0,' || planned_object FROM plan "
                       "WHERE session_id = 2"))) {
        CHECK_THAT(next, Has('\n' + row));
    }
    CHECK_THAT(palpate_command({"sequence", "shape_friction_demo", "--participant", "P02"}).out,
               Has("An example"));
}
