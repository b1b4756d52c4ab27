#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

namespace {

std::string hash_of(const std::string& protocol) {
    return behind(ran({"check", protocol}).out, "\nprotocol ").substr(0, 64);
}

}  // namespace

TEST_CASE("versions of a protocol in one file: asked about by what differs, and kept apart") {
    const TemporaryFolder folder;
    const std::string file = folder.file("s.sqlite");
    const std::string text = four_trials();
    const std::string first = write(folder.file("first.toml"), text);
    const std::string other_text =
        replaced(replaced(text, "mu_d = 0.5", "mu_d = 0.1"), "repetitions = 1", "repetitions = 2");
    std::string second = write(folder.file("second.toml"), other_text);
    for (int i = 0; hash_of(second) > hash_of(first); ++i) {  // by hash it would come first
        second = write(folder.file("second.toml"),
                       replaced(other_text, "title = \"", "title = \"" + std::to_string(i) + " "));
    }
    const auto run = [&](const std::string& protocol, const char* who, const Words& more = {}) {
        return palpate_command(joined(run_words(protocol, who, file, {"--headless"}), more));
    };
    REQUIRE(run(first, "R1").code == 0);
    REQUIRE(run(first, "R2").code == 0);

    // By accident.
    check_end(run(second, "R3"), 2,
              Has("2 people of this file ran another version of "
                  "four_trials",
                  "friction.on mu_d 0.5 there, 0.1 here", "design repetitions 1 there, 2 here",
                  "--new-version"));
    CHECK(sql_first(file,
                    "SELECT (SELECT count(*) FROM participant) || ' ' || count(*) FROM session") ==
          "2 2");

    CHECK_THAT(ran({"status", file}).out, !Has("four_trials@"));

    // Meant. From then on it is the version, and the old one is the other.
    REQUIRE(run(second, "R3", {"--new-version"}).code == 0);
    REQUIRE(run(second, "R4").code == 0);
    CHECK_THAT(ran({"status", file}).out,
               Has("finished, of four_trials@" + hash_of(first).substr(0, 8),
                   "finished, of four_trials@" + hash_of(second).substr(0, 8)));
    CHECK_THAT(run(first, "R5").error, Has("mu_d 0.1 there, 0.5 here"));
    ran({"verify", file});

    const Words hashes = lines_in(
        sql_lines(file,
                  "SELECT 'four_trials@' || substr(protocol_sha256, 1, 8) FROM study ORDER BY "
                  "study_id"));
    REQUIRE(hashes.size() == 2);
    const std::string one = hashes.front();
    const std::string other = hashes.back();
    const auto names_both = [&](const std::string& printed) {
        CAPTURE(printed);
        CHECK_THAT(printed, Has(one, other, "2 people (simulated)"));
    };
    const std::string summary = palpate_command({"summary", file}).out;
    names_both(summary);
    CHECK_THAT(summary, Has("Study " + one + ", simulated", "Study " + other + ", simulated"));
    CHECK(one > other);
    CHECK(summary.find("Study " + one) < summary.find("Study " + other));
    const std::string pooled = palpate_command({"summary", file, "--versions", "together"}).out;
    names_both(pooled);
    CHECK_THAT(pooled, Has("Study four_trials, simulated", "CAUTION"));
    for (const std::string command : {"stats", "fit", "audit", "report"}) {
        CAPTURE(command);
        Words words{command, file, "--kind", "simulated"};
        const auto with = [&](Words more) {
            Words all = joined(words, more);
            if (command == "report") {
                all.insert(all.end(), {"-o", folder.file(more.back() + ".html")});
            }
            Finished end = palpate_command(all);
            if (command == "report" && end.code == 0) {
                end.out = slurp(folder.file(more.back() + ".html"));
            }
            return end;
        };
        const auto which = with({"--versions", "apart"});
        CHECK(which.code == 2);
        names_both(which.error);
        CHECK_THAT(which.error, Has("give --study and one of"));
        CHECK(with({"--study", "four_trials"}).code == 2);
        check_end(with({"--study", "nope"}), 2,
                  Has("has no study nope: it has " + other + ", " + one));
        const auto apart = with({"--study", other});
        CAPTURE(apart.error);
        CHECK(apart.code == 0);
        CHECK_THAT(apart.out, Has(one, "kept apart"));
        const auto together = with({"--versions", "together"});
        CAPTURE(together.error);
        CHECK(together.code == 0);
        CHECK_THAT(together.out, Has("CAUTION", one, other));
        if (command == "stats" || command == "fit") {
            CHECK_THAT(with({"--json", "--study", one}).out,
                       Has("\"study\": \"" + other + "\"", "\"people\": 2"));
        }
    }
    const std::string names = "SELECT group_concat(DISTINCT study_name) FROM analysis_trial";
    CHECK_THAT(palpate_command({"sql", file, "--versions", "apart", "--csv", "-c", names}).out,
               Has(one, other));
    CHECK_THAT(sql_csv(file, names), !Has("@"));

    // Of a person of both, who has a session 1 of each, the version says which is meant.
    ran({"merge", file, run_by({"R1"}, second, folder.file("other.sqlite"))});
    Words leave{"session", file, "R1", "1", "--withdraw", "ill", "--study", "four_trials"};
    CHECK_THAT(ran(leave, 2).error, Has(one, other));
    leave.back() = one;
    ran(leave);
    CHECK(one == sql_first(file,
                           "SELECT study_name || '@' || substr(protocol_sha256, 1, 8) FROM session "
                           "JOIN study USING (study_id) WHERE withdrawn_reason = 'ill'"));

    // Who refuses later gives no version another name, and moves nobody into another one.
    for (const char* who : {"R1", "R3", "R4"}) {
        ran({"participant", file, who, "--consent", "no"});
    }
    CHECK_THAT(ran({"summary", file}).out,
               Has("Study " + one + ", simulated",
                   "people: 2 in the file; left out: 1 does not consent; analysed: 1",
                   "not in these numbers: " + other + ", simulated sessions: 3 people",
                   "3 people (simulated)"));
    check_end(palpate_command({"stats", file, "--kind", "simulated", "--study", other}), 2,
              Has("people: 3 in the file; left out: 3 do not consent; analysed: 0"));
}
