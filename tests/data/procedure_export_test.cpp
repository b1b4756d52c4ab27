#include "tests/support/adaptive.hpp"
#include "tests/support/program.hpp"

using namespace palpate::data;

TEST_CASE("palpate procedure prints the stored states of every exported run",
          "[export][adaptive][law]") {
    const std::string rule = GENERATE(kQuestPlusRule, kStaircaseRule);
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    Database database(file, Access::write);
    for (const char* who : {"P01", "P02"}) {
        const auto spec = session_spec(adaptive_protocol(rule), who);
        REQUIRE(run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
    }
    ran({"export", file, "--format", "procedure", "--kind", "all", "-o", folder.file("out")});
    std::size_t replayed = 0;
    for (const auto& run : std::filesystem::directory_iterator(folder.file("out"))) {
        const std::string name = run.path().filename();
        CAPTURE(name);
        if (name == "README.txt") {
            continue;
        }
        const Finished shown = ran(
            {"procedure", run.path() / "CONFIG.toml", run.path() / "RESPONSES.csv", "--hashes"});
        CHECK_THAT(slurp(run.path() / "CONFIG.toml"), !Has("P0") && !Has(kSecret));
        data::Statement person = database.prepare(
            "SELECT participant_code FROM participant WHERE instr(?1, printf('subject-%010d_', "
            "subject))");
        REQUIRE(person.bind(1, std::string_view(name)).step());
        const std::string who = person.text(0);
        data::Statement row = database.prepare(
            "SELECT stimulus, rule_outcome, state_sha256 FROM analysis_trial WHERE "
            "run_trial_number IS NOT NULL AND participant_code = ?1 AND run_number = ?2 ORDER BY "
            "run_trial_number",
            who, name.back() - '0');
        const auto lines = lines_in(shown.out);
        REQUIRE(lines.size() == 8);
        CHECK_THAT(lines[0], Has("state_sha256"));
        std::size_t n = 0;
        for (; row.step(); ++n) {
            const std::string& line = lines.at(n + 1);
            CAPTURE(line);
            REQUIRE(line.starts_with(fmt::format("{},{},{},", n + 1, row.real(0), row.integer(1))));
            REQUIRE(line.ends_with("," + row.text(2)));
        }
        CHECK(n == 7);
        ++replayed;
    }
    CHECK(replayed == 4);
}

TEST_CASE("a file without a rule has no runs to export", "[export][adaptive]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    {
        Database database(file, Access::write);
        static_cast<void>(data::open_session(database, session_spec(small_protocol())));
    }
    const Finished refused = ran(
        {"export", file, "--format", "procedure", "--kind", "all", "-o", folder.file("out")}, 2);
    CHECK_THAT(refused.error, Has("no session"));
    CHECK_FALSE(std::filesystem::exists(folder.file("out")));
}
