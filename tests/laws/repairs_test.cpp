#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

// What people set right afterwards, with the program itself: whose a session is, that it is left
// out, which of two notes is right, and what is destroyed on request.

namespace {

std::string said_no(const Words& words) {
    const Finished finished = palpate_command(words);
    CAPTURE(words, finished.out);
    CHECK(finished.code != 0);
    return finished.error;
}

void record(const std::string& file,
            const std::string& code,
            const std::string& number = "1",
            const std::string& protocol = "shape_friction_demo") {
    ran({"run", protocol, "--participant", code, "--session", number, "--elsewhere", "--db", file,
         "--headless"});
}

/// Each edit by hand is seen, of those that the table has after what was done.
void check_edits_after(const std::string& done, const std::string& file) {
    const TemporaryFile to("edited.sqlite");
    for (const auto& row : test_rows("edits/repairs.tsv")) {
        if (row.at(0) == done) {
            CAPTURE(row);
            sql_edit(copied(file, to), "PRAGMA foreign_keys = OFF;" + row.at(1));
            ran({"verify", to}, 1);
        }
    }
}

constexpr const char* kWhose =
    "SELECT participant_code, session_number, sum(counts) FROM analysis_trial GROUP BY "
    "session_id ORDER BY 1, 2";

constexpr const char* kNoted =
    "SELECT consent, handedness, (SELECT value FROM participant_detail) FROM participant";

}  // namespace

TEST_CASE("a session run under a wrong code is another's everywhere, and one can be withdrawn") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    ran({"participant", file, "P3", "--new", "--handedness", "80"});
    record(file, "P1");
    record(file, "P3");
    const std::string before = copied(file, folder.file("before.sqlite"));
    ran({"participant", file, "P2", "--new", "--handedness=-60"});
    CHECK_THAT(ran({"participant", file}).out,
               Has("1 session, consent not noted\n", "3 people in " + file));
    CHECK_THAT(said_no({"participant", file, "--consent", "yes"}), Has("nobody is named"));
    CHECK_THAT(said_no({"participant", file, "P3", "--is-really", "P9", "--reason", "typed"}),
               Has("nobody is called P9"));
    const Words really{"participant", file,         "P3",  "--is-really", "P2", "--reason",
                       "typed 3",     "--operator", "Ada", "--session",   "1"};
    CHECK_THAT(ran(really).out, Has("Session 1 of P3", "is session 1 of P2.\nSeal "));
    CHECK_THAT(said_no(really), Has("P3 has no such session"));
    ran({"verify", file});
    CHECK(sql_csv(file, kWhose) ==
          "participant_code,session_number,sum(counts)\nP1,1,10\nP2,1,10\n");
    CHECK(sql_csv(file, "SELECT text, value, count, operator FROM event WHERE key = 'is really'") ==
          "text,value,count,operator\ntyped 3,P2,1,Ada\n");
    check_edits_after("moved", file);

    // Who was taken for another begins with a first session; the move back makes it what it was.
    record(file, "P3");
    const std::string once = sql_csv(file, kWhose);
    CHECK(once == "participant_code,session_number,sum(counts)\nP1,1,10\nP2,1,10\nP3,1,10\n");
    ran({"participant", file, "P2", "--is-really", "P3", "--reason", "no"});
    CHECK(sql_csv(file, kWhose) ==
          "participant_code,session_number,sum(counts)\nP1,1,10\nP3,1,10\nP3,2,10\n");
    ran({"participant", file, "P3", "--is-really", "P2", "--reason", "yes", "--session", "2"});
    CHECK(sql_csv(file, kWhose) == once);
    ran({"verify", file});
    // A file from before follows, in any order; exports have the number of whose it is, and no
    // code.
    for (const auto& [one, other] : {std::pair(file, before), std::pair(before, file)}) {
        const std::string all = folder.file("all.sqlite");
        ran({"merge", all, one});
        ran({"merge", all, other});
        CHECK(sql_csv(all, kWhose) == once);
        ran({"verify", all});
        std::filesystem::remove(all);
    }
    const std::string shared = folder.file("shared");
    ran({"export", file, "--format", "csv", "-o", shared, "--kind", "simulated", "--with-details"});
    const std::string subject =
        "sub-" + behind(ran({"participant", file, "P2"}).out, "sub-").substr(0, 10);
    CHECK_THAT(slurp(shared + "/sessions.csv"), Has(subject));
    CHECK_THAT(slurp(shared + "/events.csv"), Has("is really") && !Has("P2"));

    // Withdrawn: in no number, named where it is left out, and not gone on with.
    CHECK_THAT(said_no({"session", file, "P1", "1", "--undo", "x"}), Has("is not withdrawn"));
    ran({"session", file, "P1", "1", "--withdraw", "was asleep", "--operator", "Bo"});
    CHECK_THAT(said_no({"session", file, "P1", "1", "--withdraw", "again"}),
               Has("is withdrawn already: was asleep"));
    ran({"verify", file});
    CHECK(sql_csv(file, kWhose) ==
          "participant_code,session_number,sum(counts)\nP1,1,0\nP2,1,10\nP3,1,10\n");
    CHECK(sql_csv(file, "SELECT DISTINCT exclusion FROM analysis_trial WHERE NOT counts") ==
          "exclusion\nwithdrawn\n");
    const std::string left_out = "withdrawn: P1 session 1  was asleep";
    CHECK_THAT(ran({"summary", file}).out, Has(left_out));
    CHECK_THAT(palpate_command({"stats", file, "--kind", "simulated", "--json", "--keep-codes",
                                "--permutations", "0", "--simulations", "0"})
                   .out,
               Has("\"P1 session 1\"", "\"P2\": {") && !Has("\"P1\": {"));
    CHECK_THAT(
        ran({"export", file, "--format", "csv", "-o", folder.file("less"), "--kind", "simulated"})
            .out,
        Has("2 sessions", "was asleep"));
    ran({"report", file, "--kind", "simulated", "-o", folder.file("r.html"), "--simulations", "0",
         "--bootstrap", "0"});
    CHECK_THAT(slurp(folder.file("r.html")), Has("sessions were withdrawn</span>"));
    check_edits_after("withdrawn", file);
    CHECK_THAT(said_no(run_words("shape_friction_demo", "P1", file, {"--headless"})),
               Has("--session 2"));
    ran({"session", file, "P1", "1", "--undo", "it was P4"});
    CHECK(sql_csv(file, kWhose) == once);
    ran({"verify", file});
}

TEST_CASE(
    "a session that is over is refused by what ended it, and a moved one goes on moved back") {
    const TemporaryFile file("a.sqlite");
    const auto run = [&] {
        return palpate_command(run_words("shape_friction_demo", "F", file, {"--headless"}));
    };
    const auto refused = [&](const std::string& what) {
        check_end(run(), 2,
                  Has(": session 1 of F in ", what, "; for another one give --session 2"));
    };
    ran({"participant", file, "F", "--new"});
    ran({"participant", file, "G", "--new"});
    record(file, "F");
    refused("is finished");
    sql_edit(file, "UPDATE session SET finished = 0");
    ran({"session", file, "F", "1", "--withdraw", "oops"});
    refused("was withdrawn");
    ran({"session", file, "F", "1", "--undo", "no"});
    const auto moved = [&](const char* from, const char* to) {
        return ran({"participant", file, from, "--is-really", to, "--reason", "typed"}).out;
    };
    const std::string over = "does not go on unless it is moved back";
    CHECK_THAT(moved("F", "G"), Has(over));
    check_end(palpate_command(run_words("shape_friction_demo", "G", file, {"--headless"})), 2,
              Has("was run under another code"));
    CHECK_THAT(moved("G", "F"), !Has(over));
    CHECK(run().code == 0);
    refused("is finished");
}

TEST_CASE("what has a word of its own is no detail of a participant") {
    const TemporaryFile file("a.sqlite");
    ran({"participant", file, "P1", "--new"});
    for (const auto& [key, value] : {std::pair{"consent", "no"}, std::pair{"handedness", "-100"}}) {
        check_end(
            palpate_command({"participant", file, "P1", "--set", fmt::format("{}={}", key, value)}),
            2, Has(fmt::format("give --{} ", key)));
    }
    CHECK_THAT(ran({"participant", file, "P1"}).out,
               Has("consent      not noted\n") && !Has("consent      no\n"));
}

TEST_CASE("of two notes the newest is kept with a notice, and --prefer settles what differs") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    ran({"participant", file, "P1", "--new", "--handedness", "80", "--consent", "yes", "--set",
         "age=31"});
    record(file, "P1");
    const std::string other = copied(file, folder.file("b.sqlite"));
    ran({"note", other, "hand rested", "--participant", "P1"});
    ran({"participant", file, "P1", "--set", "age=32", "--handedness=-80"});
    const std::string all = folder.file("all.sqlite");
    const std::string conflict = said_no({"merge", all, other, file});
    CHECK_THAT(conflict, Has("what was recorded differs", "not merged; --prefer FILE takes"));
    const std::string age = "SELECT value FROM participant_detail";
    CHECK(sql_csv(all, age) == "value\n32\n");
    for (const std::string& wanted : {other, file}) {
        std::filesystem::remove(all);
        CHECK_THAT(ran({"merge", all, other, file, "--prefer", wanted}).out,
                   Has("participant P1: detail age is 32 (noted ", "no longer 31 ("));
        CHECK(sql_csv(all, age) == "value\n32\n");
        CHECK(sql_csv(all, "SELECT handedness FROM participant") == "handedness\n-80\n");
        CHECK(sql_csv(all, "SELECT count(*) FROM event WHERE event_kind = 'note'") ==
              (wanted == other ? "count(*)\n1\n" : "count(*)\n0\n"));
        ran({"verify", all});
        ran({"merge", all, file, "--prefer", all});  // again it is as it was
    }
    CHECK_THAT(said_no({"merge", all, file, "--prefer", folder.file("c.sqlite")}),
               Has("none of the files"));
}

TEST_CASE("no clock brings back consent that was withdrawn, nor notes that were destroyed") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const auto noted_in = [](const std::string& year, const std::string& of,
                             const std::string& session) {
        ran({"participant", of, "P1", "--new", "--handedness", "80", "--consent", "yes", "--set",
             "age=31"});
        sql_edit(of, fmt::format("UPDATE participant SET handedness_utc = '{0}', consent_utc = "
                                 "'{0}'; UPDATE participant_detail SET noted_utc = '{0}'",
                                 year + "-01-01T00:00:00.000Z"));
        record(of, "P1", session, kFourTrials);
    };
    noted_in("2099", file, "1");
    const std::string backup = copied(file, folder.file("backup.sqlite"));
    const std::string all = folder.file("all.sqlite");
    const auto merged = [&](Words files) {
        std::ranges::sort(files);
        std::set<std::string> said;
        int orders = 0;
        do {
            std::filesystem::remove(all);
            ran(joined({"merge", all}, files));
            const std::string once = sql_csv(all, kNoted);
            for (std::size_t i = 0; said.empty() && i < files.size(); ++i) {
                ran({"merge", all, files[i]});  // again, one by one: nothing changes
            }
            CHECK(sql_csv(all, kNoted) == once);
            said.insert(once.substr(once.find('\n') + 1));
        } while (std::ranges::next_permutation(files).found && ++orders < cases(24));
        ran({"verify", all});
        CHECK(said.size() == 1);
        return *said.begin();
    };
    const auto note = [&](const std::string& of, const std::string& consent) {
        check_end(palpate_command({"participant", of, "P1", "--consent", consent}), 0,
                  Has("warning: the clock says", "noted 2099-01-01"));
    };
    CHECK(merged({file, backup}) == "1,80,31\n");
    note(file, "no");
    CHECK(merged({file, backup}) == "0,80,31\n");
    const std::string refused = copied(file, folder.file("refused.sqlite"));
    note(file, "yes");  // after the refusal, in the file that has it
    CHECK(merged({file, backup, refused}) == "1,80,31\n");
    const std::string other = folder.file("other.sqlite");
    noted_in("2100", other, "2");  // of the refusal it does not know
    CHECK(merged({other, refused}) == "0,80,31\n");
    CHECK(merged({other, refused, file, backup}) == "1,80,31\n");
    ran({"participant", file, "P1", "--destroy", "everything", "--yes"});
    CHECK(merged({file, backup, refused}) == "0,,\n");
    // Sessions of theirs that another file has, moved to them or not, are named, in any order.
    const std::string moved = copied(other, folder.file("moved.sqlite"));
    ran({"participant", moved, "P9", "--new"});
    ran({"participant", moved, "P1", "--is-really", "P9", "--reason", "x"});
    ran({"merge", folder.file("others.sqlite"), file, moved});
    ran({"participant", moved, "P9", "--is-really", "P1", "--reason", "y"});
    for (const std::string& one : {other, moved}) {
        for (const auto& [first, second] : {std::pair(file, one), std::pair(one, file)}) {
            std::filesystem::remove(all);
            CHECK_THAT(said_no({"merge", all, first, second}),
                       Has("session 2", "does it there, too"));
            CHECK(sql_csv(all, "SELECT count(*) FROM trial") == "count(*)\n0\n");
            ran({"verify", all});
        }
    }
    ran({"merge", all, other, "--prefer", other});
    ran({"verify", all});
    CHECK(sql_csv(all, "SELECT count(*) > 0 FROM trial") == "count(*) > 0\n1\n");
    ran({"participant", other, "P1", "--destroy", "everything", "--yes"});
    CHECK(merged({file, other}) == "0,,\n");
    note(file, "yes");
    CHECK(merged({file, backup}) == "1,,\n");
}

TEST_CASE("what is destroyed where the file cannot be written anew is said to be, and done again") {
    const TemporaryFile file("a.sqlite");
    for (const char* person : {"P1", "P2", "P3"}) {
        record(file, person);
    }
    const auto half = std::filesystem::file_size(file) / 2 / 512;  // as ulimit counts, in blocks
    const Words destroy{"participant", file, "P3", "--destroy", "everything", "--yes"};
    check_end(Process(joined({"sh", "-c", "trap '' XFSZ; ulimit -f $0; exec \"$@\"",
                              fmt::format("{}", half)},
                             command_of(destroy)))
                  .wait(),
              1, Has("of P3 is gone from", "could not be written anew", "run this again"));
    CHECK(sql_csv(file,
                  "SELECT count(*) FROM trial JOIN session USING (session_id) JOIN "
                  "participant USING (participant_id) WHERE participant_code = 'P3'") ==
          "count(*)\n0\n");
    const auto before = std::filesystem::file_size(file);
    ran(destroy);
    CHECK(std::filesystem::file_size(file) < before);
    CHECK_THAT(ran({"verify", file}).out, Has("Nothing differs"));
}

TEST_CASE("what a participant wants destroyed is gone from the file, and its event is sealed") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    ran({"participant", file, "P1", "--new", "--handedness", "73", "--set", "diagnosis=anosmia"});
    record(file, "P1");
    record(file, "P2");
    const std::string before = copied(file, folder.file("before.sqlite"));
    REQUIRE_THAT(slurp(before), Has("anosmia"));
    const std::string seal = sql_csv(file, "SELECT newest_seal FROM session WHERE session_id = 1");
    CHECK_THAT(said_no({"participant", file, "P1", "--destroy", "details"}),
               Has("nothing was destroyed"));

    ran({"participant", file, "P1", "--destroy", "details", "--yes", "--operator", "Ada"});
    ran({"verify", file});
    CHECK_THAT(slurp(file), !Has("anosmia") && !Has("handedness 73"));
    CHECK(sql_csv(file, kWhose) ==
          "participant_code,session_number,sum(counts)\nP1,1,10\nP2,1,10\n");
    CHECK("newest_seal\n" +
              sql_csv(file, "SELECT value FROM event WHERE key = 'destroyed'").substr(6) ==
          seal);
    check_edits_after("details destroyed", file);

    // The copy with the destruction is the later one, in any order, whatever is preferred.
    for (const auto& [one, other] : {std::pair(file, before), std::pair(before, file)}) {
        const std::string out = folder.file("out.sqlite");
        ran({"merge", out, one});
        ran({"merge", out, other, "--prefer", other == before ? before : out});
        ran({"verify", out});
        CHECK_THAT(slurp(out), !Has("anosmia") && !Has("handedness 73"));
        std::filesystem::remove(out);
    }
    // One that went on without it is in conflict, and stays as it was until it is done there, too.
    const std::string went_on = copied(before, folder.file("went_on.sqlite"));
    ran({"note", went_on, "tired", "--participant", "P1"});
    const std::string person = ran({"participant", went_on, "P1"}).out;
    CHECK_THAT(said_no({"merge", went_on, file, "--prefer", went_on}),
               Has("P1 --destroy details does it there, too"));
    ran({"verify", went_on});
    CHECK(ran({"participant", went_on, "P1"}).out == person);
    ran({"participant", went_on, "P1", "--destroy", "details", "--yes"});
    ran({"merge", went_on, file, "--prefer", went_on});
    ran({"verify", went_on});

    const std::string all = copied(before, folder.file("all.sqlite"));
    ran({"participant", file, "P1", "--destroy", "everything", "--yes", "--reason", "letter"});
    CHECK_THAT(ran({"participant", file, "P1"}).out,
               Has("destroyed    on request", "consent      no"));
    CHECK_THAT(said_no({"session", file, "P1", "1", "--undo", "x"}), Has("was destroyed"));
    const std::string left =
        "SELECT (SELECT count(*) FROM event WHERE session_id = 1), (SELECT count(*) FROM trial "
        "WHERE session_id = 1), (SELECT count(*) FROM trace_chunk), (SELECT count(*) FROM plan "
        "WHERE session_id = 1)";
    // Neither an older copy nor a file of all that has them brings them back.
    ran({"merge", file, before});
    ran({"merge", all, file});
    for (const std::string& one : {file, all}) {
        ran({"verify", one});
        CHECK(sql_csv(one, kWhose) == "participant_code,session_number,sum(counts)\nP2,1,10\n");
        CHECK_THAT(sql_csv(one,
                           "SELECT count(*) FROM event JOIN session USING (session_id) JOIN "
                           "participant USING (participant_id) WHERE participant_code = 'P1'"),
                   Has("\n1\n"));
        CHECK_THAT(slurp(one), !Has("anosmia"));
        CHECK_THAT(ran({"summary", one}).out, Has("1 does not consent"));
    }
    CHECK_THAT(sql_csv(file, left), Has("\n1,0,"));
    check_edits_after("all destroyed", file);
}
