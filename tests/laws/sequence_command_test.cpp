#include "data/store/session_store.hpp"
#include "tests/support/program.hpp"

namespace {

/// The plan of a recorded session, as `palpate sequence --csv` writes it but for the block.
std::string recorded_plan(data::Database& database, std::int64_t session) {
    auto row = database.prepare(
        "SELECT plan_position, phase, planned_object, curvature_per_m, friction, mu_s, mu_d, "
        "break_before FROM plan WHERE session_id = ?1 ORDER BY plan_position",
        session);
    std::string text =
        "position,phase,block,object,curvature_per_m,friction,mu_s,mu_d,break_before\n";
    while (row.step()) {
        text += fmt::format("{},{},0,{},{},{},{},{},{}\n", row.integer(0), row.text(1), row.text(2),
                            row.real(3), row.text(4), row.real(5), row.real(6), row.integer(7));
    }
    return text;
}

std::string recorded_pictures(data::Database& database, std::int64_t session) {
    auto row = database.prepare(
        "SELECT picture_object FROM picture WHERE session_id = ?1 ORDER BY picture_place", session);
    std::string text = "pictures, left to right:";
    while (row.step()) {
        text += ' ' + row.text(0);
    }
    return text + '\n';
}

/// What sequence says of a session in a database, against what was run there.
void check_against(const std::string& file, std::int64_t session, const Words& words) {
    data::Database database(file, data::Access::read);
    const auto plan =
        database.first("SELECT plan_sha256 FROM session WHERE session_id = ?1", session);
    const Words command = joined({"sequence"}, words);
    CHECK_THAT(ran(command).out,
               Has("plan " + plan.text(0) + '\n', recorded_pictures(database, session)));
    CHECK(ran(joined(command, {"--csv"})).out == recorded_plan(database, session));
}

Words words_of_run(const std::string& participant, const std::string& file) {
    return run_words("shape_friction_demo", participant, file, {"--headless"});
}

}  // namespace

TEST_CASE("sequence prints exactly the plan that is run, before and after", "[sequence][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("demo.sqlite");
    ran({"sequence", "shape_friction_demo", "--participant", "demo"});
    CHECK(folder.names().empty());
    const Finished demo = ran({"demo", "--headless", "--db", file});
    check_against(file, 1, {"shape_friction_demo", "--participant", "demo", "--db", file});
}

TEST_CASE("sequence knows another seed, another session, and who already ran", "[sequence][law]") {
    const TemporaryFile file("d.sqlite");
    ran(words_of_run("P1", file));
    {  // as if a person had been there: the next row of pictures depends on it
        data::Database database(file, data::Access::write);
        database.execute("UPDATE session SET session_kind = 'real'");
    }
    const Words next = {"shape_friction_demo", "--participant", "P2", "--db", file, "--seed", "5"};
    const Words command = joined({"sequence"}, next);
    const Finished announced = palpate_command(command);
    const Words run = joined(words_of_run("P2", file), {"--seed", "5"});
    CHECK_THAT(ran(run).out, Has(announced.out.substr(announced.out.find("code "), 14)));
    check_against(file, 2, {"shape_friction_demo", "--participant", "P2", "--db", file});
    CHECK_THAT(announced.out, Has("used by 0 other participants"));

    const Words second = {
        "shape_friction_demo", "--participant", "P2", "--db", file, "--session", "2"};
    const Words again = joined(words_of_run("P2", file), {"--session", "2"});
    const std::string code = ran(joined(joined({"sequence"}, second), {"--kind", "simulated"})).out;
    CHECK_THAT(ran(again).out, Has(code.substr(code.find("code "), 14)));
    check_against(file, 3, second);
}

TEST_CASE("a session with a plan of another algorithm is refused, not mixed", "[sequence][law]") {
    const TemporaryFile file("d.sqlite");
    ran(words_of_run("P1", file));
    {
        data::Database database(file, data::Access::write);
        database.execute("UPDATE session SET finished = 0, plan_sha256 = lower(hex(zeroblob(32)))");
    }
    CHECK_THAT(ran(words_of_run("P1", file), 1).error, Has("begun with another plan"));
    CHECK_THAT(
        ran({"sequence", "shape_friction_demo", "--participant", "P1", "--db", file}, 2).error,
        Has("begun with another version", "table plan"));
}

TEST_CASE("the plan of a session that was run under another code is printed as it was run",
          "[sequence][law]") {
    const TemporaryFile file("d.sqlite");
    ran(words_of_run("P1", file));
    ran({"participant", file, "P5", "--new"});
    ran({"participant", file, "P1", "--is-really", "P5", "--reason", "mistyped"});
    check_against(file, 1, {"shape_friction_demo", "--participant", "P5", "--db", file});
}

TEST_CASE("sequence refuses what run refuses, and makes no file", "[sequence]") {
    const TemporaryFolder folder;
    ran({"sequence", "shape_friction_demo"}, 2);
    ran({"sequence", "shape_friction_demo", "--participant", "a b"}, 2);
    ran({"sequence", "no_such_study", "--participant", "P"}, 2);
    CHECK(palpate_command({"sequence", "shape_friction_demo", "--participant", "P", "--db",
                           folder.file("none.sqlite")})
              .code != 0);
    CHECK(folder.names().empty());
}

TEST_CASE("sequence prints the exact plan of a file, and an example without one", "[secret][law]") {
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
    data::Database database(file, data::Access::read);
    for (const auto& row : database.prepare("SELECT plan_position || ',' || phase || ',0,' || "
                                            "planned_object FROM plan WHERE session_id = 2")) {
        CHECK_THAT(next, Has('\n' + row.text(0)));
    }
    CHECK_THAT(palpate_command({"sequence", "shape_friction_demo", "--participant", "P02"}).out,
               Has("An example"));
}
