#include "data/store/database.hpp"
#include "data/store/session_lock.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

// What `palpate merge` makes of several versions of one session or person: the same in any order.

namespace {

/// A participant with one session, and what is noted of them.
struct Study {
    TemporaryFolder folder;
    std::string whole = folder.file("whole.sqlite");

    Study() {
        ran({"participant", whole, "P1", "--new", "--handedness", "73", "--consent", "yes"});
        ran({"run", "shape_friction_demo", "--participant", "P1", "--db", whole, "--headless"});
    }
    /// A copy of `from`, which another rig goes on with.
    [[nodiscard]] std::string copy(const std::string& name, const std::string& from) const {
        return copied(from, folder.file(name));
    }
    [[nodiscard]] std::string noted(const std::string& name, const std::string& from) const {
        const std::string file = copy(name, from);
        ran({"note", file, "in " + name, "--participant", "P1"});
        return file;
    }
};

/// All orders of `files` brought together in a new file; of each the finished command and the file.
template <class Check>
void in_all_orders(const Study& study, Words files, const std::string& prefer, const Check& check) {
    std::ranges::sort(files);
    do {
        Words words = joined({"merge", study.folder.file("all.sqlite")}, files);
        if (!prefer.empty()) {
            words.insert(words.end(), {"--prefer", prefer});
        }
        CAPTURE(words);
        std::filesystem::remove(words[1]);
        check(palpate_command(words), words[1]);
    } while (std::ranges::next_permutation(files).found);
}

constexpr const char* kLeft =
    "SELECT (SELECT count(*) FROM response), (SELECT count(*) FROM event WHERE event_kind = "
    "'note'), (SELECT group_concat(handedness) FROM participant)";

constexpr const char* kScores =
    "SELECT count(*) FROM event WHERE key = 'handedness' AND value = '73'";

std::string left_of(const std::string& file) {
    return sql_row(file, kLeft);
}

}  // namespace

TEST_CASE("what was destroyed in one of several versions is destroyed, in any order") {
    const Study study;
    const std::string x = study.noted("x.sqlite", study.whole);
    const std::string y = study.noted("y.sqlite", study.whole);
    const std::string gone = study.copy("gone.sqlite", study.whole);
    ran({"participant", gone, "P1", "--destroy", "everything", "--yes"});
    for (const std::string& prefer : {std::string(), y}) {
        in_all_orders(study, {x, y, gone}, prefer, [](const Finished& done, const auto& all) {
            CHECK(done.code == 0);
            CHECK(left_of(all) == "0,0,");
        });
    }
    // Of details only: who has more beside that is in conflict, whatever is preferred.
    const std::string less = study.copy("less.sqlite", study.whole);
    ran({"participant", less, "P1", "--destroy", "details", "--yes"});
    in_all_orders(study, {x, y, less}, y, [](const Finished& done, const auto& all) {
        CHECK(done.code == 1);
        CHECK_THAT(done.error, Has("--destroy details does it there, too"));
        CHECK(left_of(all) == "0,0,");
    });
    // A person without a session: nothing is noted of them since.
    const std::string person = study.folder.file("person.sqlite");
    ran({"participant", person, "P2", "--new", "--handedness", "80", "--set", "diagnosis=x"});
    const std::string forgot = study.copy("forgot.sqlite", person);
    ran({"participant", forgot, "P2", "--destroy", "details", "--yes"});
    in_all_orders(study, {person, forgot}, person, [](const Finished& done, const auto& all) {
        CHECK(done.code == 0);
        CHECK(left_of(all) == "0,0,");
        CHECK(sql_csv(all, "SELECT count(*) FROM participant_detail") == "count(*)\n0\n");
    });
}

TEST_CASE("details and then everything, or everything twice, is destroyed wherever copies came") {
    const Study study;
    ran({"participant", study.whole, "P1", "--destroy", "details", "--yes"});
    const std::string less = study.noted("less.sqlite", study.whole);
    ran({"participant", study.whole, "P1", "--destroy", "everything", "--yes"});
    const std::string early = study.copy("early.sqlite", less);
    ran({"merge", early, study.whole});
    CHECK(left_of(early) == "0,0,");
    ran({"verify", early});
    refused({"note", early, "x", "--participant", "P1"}, "was destroyed");
    ran({"participant", less, "P1", "--destroy", "everything", "--reason", "again", "--yes"});
    std::set<std::string> kept;
    in_all_orders(study, {study.whole, less}, "", [&](const Finished& done, const auto& all) {
        CHECK(done.code == 0);
        kept.insert(sql_csv(all, "SELECT withdrawn_reason, newest_seal FROM session"));
    });
    CHECK(kept.size() == 1);
}

TEST_CASE("what was destroyed as one person's is nobody else's to lose") {
    const Study study;
    const std::string lab = study.copy("lab.sqlite", study.whole);
    ran({"participant", lab, "P2", "--new"});
    ran({"participant", lab, "P1", "--is-really", "P2", "--reason", "badge"});
    const std::string rig = study.copy("rig.sqlite", study.whole);
    ran({"participant", rig, "P1", "--destroy", "everything", "--yes"});
    for (const auto& [prefer, left] : {std::pair{std::string(), ""}, {lab, "10"}, {rig, "0"}}) {
        in_all_orders(study, {lab, rig}, prefer, [&](const Finished& done, const auto& all) {
            CHECK(done.code == (prefer.empty() ? 1 : 0));
            CHECK_THAT(done.error, Has(prefer.empty() ? "as P1's, of whom everything was" : ""));
            CHECK(left_of(all).starts_with(prefer.empty() ? "0," : left));
        });
    }
    // Of whom it is destroyed, no score stays in sessions that are another's now.
    CHECK(sql_row(lab, kScores) == "1");
    ran({"participant", lab, "P1", "--destroy", "details", "--yes"});
    CHECK(sql_row(lab, kScores) == "0");
    CHECK(left_of(lab).starts_with("10,"));
    ran({"verify", lab});
}

TEST_CASE("a file that heard of a destruction is not one where it was done") {
    const Study study;
    const std::string rig = study.folder.file("rig.sqlite");
    ran({"participant", rig, "P1", "--new", "--handedness", "20"});
    ran({"run", "shape_friction_demo", "--participant", "P1", "--session", "2", "--elsewhere",
         "--db", rig, "--headless"});
    const std::string before = study.copy("before.sqlite", rig);
    ran({"participant", study.whole, "P1", "--destroy", "everything", "--yes"});
    for (int i = 0; i < 2; ++i) {
        CHECK_THAT(palpate_command({"merge", rig, study.whole}).error,
                   Has("P1 --destroy everything does it there, too"));
        CHECK(left_of(rig) == "10,0,20");
        ran({"verify", rig});
    }
    in_all_orders(study, {study.whole, rig, before}, "", [](const Finished& done, const auto& all) {
        CHECK(done.code == 1);
        CHECK(left_of(all) == "0,0,");
    });
    ran({"participant", rig, "P1", "--destroy", "everything", "--yes"});
    ran({"merge", rig, study.whole});
    ran({"verify", rig});
}

TEST_CASE("an older copy takes what became of codes, whoever has which number since") {
    const Study study;
    const std::string older = study.copy("older.sqlite", study.whole);
    ran({"participant", study.whole, "P2", "--new"});
    ran({"participant", study.whole, "P1", "--is-really", "P2", "--reason", "typo"});
    ran({"run", "shape_friction_demo", "--participant", "P1", "--db", study.whole, "--headless"});
    ran({"merge", older, study.whole});
    CHECK(sql_csv(older,
                  "SELECT participant_code, session_number FROM session JOIN participant "
                  "USING (participant_id) ORDER BY 1") ==
          "participant_code,session_number\nP1,1\nP2,1\n");
    ran({"participant", study.whole, "P2", "--is-really", "P1", "--reason", "no typo"});
    ran({"merge", older, study.whole});
    ran({"verify", older});
}

TEST_CASE("an older copy decides nothing between those that went on from it") {
    const Study study;
    const std::string x = study.noted("x.sqlite", study.whole);
    const std::string y = study.noted("y.sqlite", study.whole);
    in_all_orders(study, {x, y, study.whole}, study.whole, [](const Finished& done, const auto&) {
        CHECK(done.code == 1);
        CHECK_THAT(done.error, Has("what was recorded differs"));
    });
    const std::string later = study.noted("later.sqlite", x);
    in_all_orders(study, {x, y, later}, x, [&](const Finished& done, const auto& all) {
        CHECK(done.code == 0);
        CHECK_THAT(done.out, Has("later.sqlite has it; what", "y.sqlite has beside that is left"));
        CHECK(left_of(all) == "10,2,73");
    });
    CHECK_THAT(ran({"merge", y, x, "--prefer", study.folder.file("./x.sqlite")}).out,
               Has("0 sessions new, 0 went on, 0 as before, 1 as ", "left out"));
    ran({"verify", y});
}

TEST_CASE("of notes of several times the newest is kept, in any order") {
    const Study study;
    const std::string person = study.folder.file("person.sqlite");
    ran({"participant", person, "P2", "--new", "--set", "age=30"});
    Words files;
    for (const auto& [age, hour] : {std::pair(31, 10), std::pair(32, 10), std::pair(33, 11)}) {
        const std::string file = study.copy(fmt::format("{}.sqlite", age), person);
        ran({"participant", file, "P2", "--set", fmt::format("age={}", age)});
        sql_edit(file, fmt::format("UPDATE participant_detail SET noted_utc = "
                                   "'2026-05-05T{}:00:00.000Z'",
                                   hour));
        files.push_back(file);
    }
    in_all_orders(study, files, "", [](const Finished& done, const auto& all) {
        CHECK(done.code == 0);
        CHECK(sql_csv(all, "SELECT value FROM participant_detail") == "value\n33\n");
    });
    files.pop_back();
    in_all_orders(study, files, "", [](const Finished& done, const auto&) {
        CHECK(done.code == 1);
        CHECK_THAT(done.error, Has("noted at one time"));
    });
}

TEST_CASE("a session that runs is not changed by a merge") {
    const Study study;
    const std::string later = study.noted("later.sqlite", study.whole);
    {
        data::Database database(study.whole, data::Access::write);
        const data::SessionLock runs(database, 1);
        CHECK_THAT(ran({"merge", study.whole, later}, 1).error,
                   Has("it runs now", "end it, and merge again"));
    }
    CHECK(left_of(study.whole) == "10,0,73");
    ran({"merge", study.whole, later});
    CHECK(left_of(study.whole) == "10,1,73");
}

TEST_CASE("simulated people of one code and two secrets are two people, and a merge says so") {
    const TemporaryFolder folder;
    const auto simulated = [&](const char* name, const std::string& protocol,
                               const std::string& secret) {
        std::string file = folder.file(name);
        ran({"simulate", protocol, "--participants", "1", "--db", file, "--secret", secret});
        return file;
    };
    const std::string demo = "shape_friction_demo";
    const std::string one = simulated("one.sqlite", kFourTrials, kRunSecret);
    const std::string other = simulated("other.sqlite", demo, std::string(32, 'a'));
    const std::string both = folder.file("both.sqlite");
    ran({"merge", both, one, simulated("same.sqlite", demo, kRunSecret)});
    const std::string all = folder.file("all.sqlite");
    CHECK_THAT(ran({"merge", all, one, other}, 1).error,
               Has("they are two people of one code", one, other, "not merged"));
    CHECK(left_of(all) == "0,0,");
    CHECK_THAT(ran({"merge", both, other}, 1).error, Has("two people of one code"));
    CHECK(left_of(both) == "14,0,");
}

TEST_CASE("a yes after a refusal stands against copies from between, whoever had a session then") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    ran({"participant", file, "P1", "--new"});
    const auto note = [&](const std::string& consent) {
        ran({"participant", file, "P1", "--consent", consent});
    };
    const auto now = [](const std::string& of) {
        return sql_lines(of, "SELECT consent FROM participant");
    };
    Words copies;
    for (int i = 0; i < 3; ++i) {
        note("no");
        copies.push_back(copied(file, folder.file(fmt::format("no{}.sqlite", i))));
        note("yes");
        if (i == 1) {  // of whom everything is destroyed refuses, too
            ran({"run", kFourTrials, "--participant", "P1", "--db", file, "--headless"});
            ran({"participant", file, "P1", "--destroy", "everything", "--yes"});
            copies.push_back(copied(file, folder.file("destroyed.sqlite")));
            note("yes");
        }
    }
    for (const std::string& copy : copies) {
        CAPTURE(copy);
        ran({"merge", file, copy});
        CHECK(now(file) == "1\n");
        const std::string other = folder.file("other.sqlite");
        ran({"merge", other, copy});
        CHECK(now(other) == "0\n");
        ran({"merge", other, file});
        CHECK(now(other) == "1\n");
        ran({"merge", other, copy});  // what it heard of, it goes on to know
        CHECK(now(other) == "1\n");
        ran({"verify", other});
        std::filesystem::remove(other);
    }
    // A refusal that the file has not heard of stands, whenever it was.
    const std::string rig = folder.file("rig.sqlite");
    ran({"participant", rig, "P1", "--new", "--consent", "no"});
    sql_edit(rig,
             "UPDATE participant SET consent_utc = '2000-01-01T00:00:00.000Z', refusals_utc = "
             "'2000-01-01T00:00:00.000Z'");
    ran({"merge", file, rig});
    CHECK(now(file) == "0\n");
}
