#include "data/store/database.hpp"
#include "tests/support/json_of.hpp"
#include "tests/support/page_reader.hpp"
#include "tests/support/sql_first.hpp"

// Whom and what numbers are without: every command says the same of one file, in words and in JSON.

namespace {

/// Two versions of a protocol with a rule of exclusion; of the first, five simulated people: A does
/// not consent, an answer of B is marked, C broke the rule, D's only session was withdrawn, E; and
/// F, who is real. Of the second X and Y.
std::string mixed_study(const TemporaryFolder& folder) {
    const std::string text = four_trials() + "\n[exclusion]\nsessions_finished = true\n";
    write(folder.file("one.toml"), text);
    write(folder.file("two.toml"), replaced(text, "mu_d = 0.5", "mu_d = 0.1"));
    const std::string file = folder.file("s.sqlite");
    const auto run = [&](const char* protocol, const std::string& who) {
        ran(joined(run_words(folder.file(protocol), who, file, {"--headless"}),
                   who == "X" ? Words{"--new-version"} : Words{}));
    };
    for (const char* who : {"A", "B", "C", "D", "E", "F"}) {
        run("one.toml", who);
    }
    run("two.toml", "X");
    run("two.toml", "Y");
    ran({"participant", file, "A", "--consent", "no"});
    ran({"mark", file,
         sql_first(file, "SELECT min(trial_id) FROM analysis_trial WHERE participant_code = 'B'"),
         "--invalid", "moved"});
    ran({"session", file, "D", "1", "--withdraw", "was\nasleep"});
    sql_edit(file,
             "UPDATE session SET finished = 0 WHERE participant_id = (SELECT participant_id FROM "
             "participant WHERE participant_code = 'C')");
    sql_edit(file,
             "UPDATE session SET session_kind = 'real' WHERE participant_id = (SELECT "
             "participant_id FROM participant WHERE participant_code = 'F')");
    return file;
}

/// The account's lines of people and answers, wherever it stands.
std::set<std::string> account_in(const std::string& text) {
    std::set<std::string> lines;
    const std::string ends = all_replaced(text, "<", "\n") + '\n';
    for (const std::string begin : {"people: ", "answers of main trials: "}) {
        for (const std::string& rest : between(ends, begin, "\n")) {
            if (rest.find("in the file") != std::string::npos) {
                lines.insert(begin + rest);
            }
        }
    }
    return lines;
}

/// What a page says for programs.
Json page_account(const std::string& page) {
    return Json::parse(unescaped(behind(page, "data-left-out=\"", "\"")));
}

}  // namespace

TEST_CASE("every command says alike who and what was left out, in words and in JSON") {
    const TemporaryFolder folder;
    const std::string file = mixed_study(folder);
    sql_edit(file,
             "UPDATE session SET session_kind = 'pilot' WHERE participant_id = (SELECT "
             "participant_id FROM participant WHERE participant_code = 'Y')");
    const std::string name =
        "four_trials@" + sql_first(file,
                                   "SELECT substr(protocol_sha256, 1, 8) FROM study WHERE study_id "
                                   "= (SELECT min(study_id) FROM study)");
    const std::set<std::string> wanted{
        "people: 5 in the file; left out: 1 does not consent, 1 withdrawn, 1 by the rules of "
        "[exclusion]; analysed: 2",
        "answers of main trials: 20 in the file; left out: 4 of who does not consent, 4 of "
        "withdrawn sessions, 1 marked, 4 of who is left out by rule; analysed: 7"};
    const Words of{file, "--kind", "simulated", "--study", name};
    const auto with = [&](const char* command, Words more = {}) {
        return ran(joined(joined({command}, of), more));
    };
    const Words quick{"--permutations", "0", "--simulations", "0"};
    const Finished stats = with("stats", quick);
    const std::string page = folder.file("r.html");
    static_cast<void>(with("report", {"-o", page, "--simulations", "0", "--bootstrap", "0"}));
    for (const auto& [command, text] :
         {std::pair{"stats", stats.out}, std::pair{"fit", with("fit").out},
          std::pair{"audit", with("audit").out}, std::pair{"report", slurp(page)}}) {
        CAPTURE(command, text);
        CHECK(account_in(text) == wanted);
        CHECK_THAT(text,
                   Has(name + ", real sessions: 1 person", "sessions_finished: 1 is not",
                       std::string(command) == "report" ? "session 1:  the lab&#39;s file says why"
                                                        : "was asleep"));
        CHECK((std::string(command) != "report" || text.find("asleep") == std::string::npos));
    }
    CHECK_THAT(slurp(page),
               Has("<b>5</b> with a simulated", "less 1: noted as not consenting",
                   "less 1: all of whose", "<b>3</b> whose answers", "<b>2</b> analysed"));
    CHECK_THAT(stats.out,
               !Has("Nothing is excluded") && Has("Exclusions applied: 2 people, 7 answers"));
    // Of a whole file that account is among the others.
    const Finished asked =
        ran({"sql", file, "--versions", "apart", "--csv", "-c", "SELECT 1 AS one"});
    CHECK(asked.out == "one\n1\n");
    for (const std::string& text :
         {ran({"summary", file}).out, asked.error,
          ran({"export", file, "--kind", "simulated", "-o", folder.file("out")}).out}) {
        CAPTURE(text);
        CHECK(std::ranges::includes(account_in(text), wanted));
    }
    const auto json = [&](const char* command, Words more) {
        more.emplace_back("--json");
        return Json::parse(with(command, more).out)["left_out"];
    };
    const Json account = json("stats", quick);
    CHECK(account == json("fit", {}));
    CHECK(account["people"] == Json{{"in_file", 5},
                                    {"no_consent", 1},
                                    {"withdrawn", 1},
                                    {"by_rule", 1},
                                    {"no_answer", 0},
                                    {"analysed", 2}});
    CHECK(account["answers"] == Json{{"in_file", 20},
                                     {"no_consent", 4},
                                     {"withdrawn", 4},
                                     {"marked", 1},
                                     {"invalid", 0},
                                     {"by_rule", 4},
                                     {"analysed", 7}});
    CHECK(account["elsewhere"].size() == 3);
    CHECK(account == json("audit", {}));
    const auto of_study = [&](const Json& all) {
        for (const Json& one : all) {
            if (one["study"] == name && one["kind"] == "simulated") {
                return one;
            }
        }
        return Json();
    };
    const std::string json_folder = folder.file("json");
    const Json made =
        Json::parse(ran({"export", file, "--kind", "simulated", "-o", json_folder, "--json"}).out);
    CHECK(made["sessions"] == 4);  // of B, C, E and X
    CHECK(of_study(made["left_out"]) == account);
    const Json summed = of_study(Json::parse(ran({"summary", file, "--json"}).out)["studies"]);
    const Json shown = page_account(slurp(page));
    for (const char* part : {"people", "answers", "elsewhere", "study", "kind"}) {
        CAPTURE(part);
        CHECK(summed["left_out"][part] == account[part]);
        CHECK(shown[part] == account[part]);
    }
    // Of the summary's own numbers: 7 answers of two people with the rules applied, 11 of three
    // without.
    for (const auto& [part, people, answers] :
         {std::tuple{"applied", 2, 7}, std::tuple{"not_applied", 3, 11}}) {
        CAPTURE(part);
        const Json& table = summed[part].at(0);
        std::int64_t n = 0;
        for (const auto& [person, frictions] : table["people"].items()) {
            for (const auto& [friction, own] : frictions.items()) {
                n += own["n"].get<std::int64_t>();
            }
        }
        CHECK(table["people"].size() == static_cast<std::size_t>(people));
        CHECK(n == answers);
    }
    // What is handed on says it too, without a word of the lab's.
    for (const auto& [format, readme] :
         {std::pair{"csv", "README.txt"}, std::pair{"bids", "README"},
          std::pair{"psych-ds", "README.md"}, std::pair{"psychopy", "README.txt"}}) {
        const std::string out = folder.file(format);
        ran({"export", file, "--kind", "simulated", "--as", format, "-o", out});
        const std::string text = slurp(out + '/' + readme);
        CAPTURE(format, text);
        CHECK(std::ranges::includes(account_in(text), wanted));
        CHECK_THAT(text, Has("sessions_finished: 1 is not") && !Has("asleep"));
    }
    ran({"analysis", "init", folder.file("csv")});
    static_cast<void>(with(
        "stats", {"--permutations", "0", "--simulations", "0", "--emit-r", folder.file("s.R")}));
    for (const std::string& script :
         {folder.file("csv/analysis.R"), folder.file("csv/analysis.py"), folder.file("s.R")}) {
        const std::string text = slurp(script);
        CAPTURE(script, text);
        CHECK(std::ranges::includes(account_in(text), wanted));
        CHECK_THAT(text, Has("\n#     people: ") && !Has("asleep"));
    }
    // The audit's and the fit's people are those of stats; who refuses has no page of a trial.
    CHECK_THAT(with("audit").out, Has("start, to the right             rig   on - off         2 "));
    const std::string theirs =
        sql_first(file, "SELECT min(trial_id) FROM analysis_trial WHERE participant_code = 'D'");
    CHECK_THAT(
        palpate_command({"report", file, "--trial", theirs, "-o", folder.file("t.html")}).error,
        Has("withdrawn (was asleep)"));
    CHECK_THAT(ran({"trace", file, theirs}, 2).error,
               Has("of a session that was withdrawn: its ticks are not shown"));
    const std::string refused =
        sql_first(file, "SELECT min(trial_id) FROM analysis_trial WHERE participant_code = 'A'");
    CHECK_THAT(ran({"trace", file, refused}, 2).error, Has("not consenting"));
    const auto replayed = [&](const std::string& trial) {
        return palpate_command(run_words(folder.file("one.toml"), "P1", folder.file("r.sqlite"),
                                         {"--headless", "--device", "replay:" + file + trial}));
    };
    for (const std::string& trial : {theirs, refused}) {
        check_end(replayed(":" + trial), 2, Has("trial " + trial + " is of ", "are not shown"));
    }
    CHECK(!std::filesystem::exists(folder.file("r.sqlite")));
    check_end(replayed(""), 0, Has("8 trials of who does not consent or of withdrawn sessions"));
    // The command that lists what is invalid gives as many as are said: none of who refuses.
    ran({"mark", file, refused, "--invalid", "moved"});
    const std::string summary = ran({"summary", file}).out;
    const std::string said =
        behind(summary, "1 answered trial is invalid and left out:\n    palpate ");
    CAPTURE(summary);
    REQUIRE_FALSE(said.empty());
    const Finished listed = ended(shell("\"$0\" " + said + " --csv"));
    CHECK(std::ranges::count(listed.out, '\n') == 2);
    // Where nobody is left it is said why.
    sql_edit(file, "UPDATE participant SET consent = 0 WHERE participant_code = 'F'");
    for (const Words& words :
         {Words{"stats", file}, {"report", file, "-o", folder.file("f.html")}}) {
        CAPTURE(words.front());
        CHECK_THAT(ran(words, 2).error, Has("people: 1 in the file; left out: 1 does not "
                                            "consent; analysed: 0"));
    }
    CHECK(!std::filesystem::exists(folder.file("f.html")));
}

TEST_CASE("a study whose rules leave out everybody is reported, and names nobody by order") {
    const TemporaryFolder folder;
    write(folder.file("p.toml"), four_trials() + "\n[exclusion]\nsessions_finished = true\n");
    const std::string file =
        run_by({"A", "B", "C", "D", "E"}, folder.file("p.toml"), folder.file("s.sqlite"));
    sql_edit(file, "UPDATE session SET finished = 0");
    const std::string account = "5 by the rules of [exclusion]; analysed: 0";
    for (const char* command : {"audit", "stats", "fit"}) {
        check_end(palpate_command({command, file, "--kind", "simulated"}), 2, Has(account));
    }
    const Finished audit = palpate_command({"audit", file, "--kind", "simulated"});
    CHECK_THAT(audit.error, Has("everybody is left out by the protocol's rules"));
    const Words people = between(audit.error, "by rule: ", "\n");
    CHECK(people.size() == 5);
    CHECK(std::ranges::is_sorted(people));
    CHECK_THAT(page_of(file, {"--kind", "simulated", "--simulations", "0"}),
               Has("Everybody is left out by the protocol&#39;s rules", account));
}

TEST_CASE("a study of which no curve can be fitted has its report all the same") {
    const TemporaryFolder folder;
    const std::string file = simulated_study(folder, test_text("one_level.toml"),
                                             {"--participants", "2", "--no-traces"});
    check_end(palpate_command({"fit", file, "--kind", "simulated"}), 2,
              Has("there is one stimulus with answers", "left out: nobody"));
    CHECK_THAT(page_of(file, {"--kind", "simulated"}),
               Has("Not fitted: 1, r: there is one stimulus", "Not fitted: 2, r: ", "id=\"tracks\"",
                   "in an order drawn for each run, whatever was answered, ") &&
                   HasNone("Adaptive tracks", "A rule chose"));
}

TEST_CASE("answers of more than two kinds are no psychometric function, whatever was answered") {
    const TemporaryFolder folder;
    const std::string file = simulated_study(
        folder,
        edited(test_text("one_level.toml"),
               {{"kind = \"two_interval\"", "kind = \"rating\"\nquestion = \"Round?\"\nlevels = 3"},
                {"stimuli = [7]", "stimuli = [0, 3, 7]\noutcomes = 3"}}),
        {"--participants", "2", "--no-traces"});
    sql_edit(file,
             "UPDATE adaptive_step SET rule_outcome = rule_outcome > 0");  // nobody gave the last
    refused({"fit", file, "--kind", "simulated"}, "has no answer to fit");
    ran({"export", file, "--kind", "simulated", "--format", "quickpsy", "-o", folder.file("q")}, 2);
    CHECK_THAT(ran({"summary", file}).out, Has("more than two answers"));
    CHECK_THAT(page_of(file, {"--kind", "simulated"}),
               Has("id=\"tracks\"") && !Has("share of yes"));
}

TEST_CASE("main_trial is one kind, of who consents, and no study shares a row with another") {
    const TemporaryFolder folder;
    const std::string file = mixed_study(folder);
    const std::string who =
        "SELECT study_name, session_kind, group_concat(DISTINCT participant_code) AS who, count(*) "
        "AS n FROM main_trial GROUP BY 1, 2";
    CHECK(sql_csv(file, who) == "study_name,session_kind,who,n\nfour_trials,real,F,4\n");
    sql_edit(file, "UPDATE session SET session_kind = 'simulated'");
    CHECK(sql_csv(file, who) ==
          "study_name,session_kind,who,n\nfour_trials,simulated,\"B,C,E,F,X,Y\",23\n");
    CHECK(sql_csv(file, "SELECT sum(n) AS n FROM confusion") == "n\n23\n");
    // Another study in the same file: a row of its own. A catch trial's object is in no picture: no
    // answer is right.
    run_by({"G"}, PALPATE_SOURCE_DIR "/tests/golden/free_forms.toml", file);
    CHECK(sql_csv(file, "SELECT count(DISTINCT study_name) AS n FROM main_trial") == "n\n2\n");
    CHECK(sql_csv(file,
                  "SELECT phase, count(*) > 0 AS n, count(correct) > 0 AS judged FROM "
                  "analysis_trial WHERE counts AND phase <> 'practice' GROUP BY 1") ==
          "phase,n,judged\ncatch,1,0\nmain,1,1\n");
    CHECK(palpate_command({"verify", file}).out.find("correct") == std::string::npos);
    ran({"export", file, "--kind", "all", "-o", folder.file("out")});
    // The same places since the last break in the export as in the view.
    const auto places_in = [](const std::string& csv) {
        std::multiset<std::string> places;
        for (const auto& row : csv_records(csv)) {
            places.insert(row.at("trials_since_break"));
        }
        return places;
    };
    const auto places = places_in(slurp(folder.file("out") + "/trials.csv"));
    CHECK(places == places_in(sql_csv(file,
                                      "SELECT trials_since_break FROM analysis_trial JOIN "
                                      "participant USING (participant_code) WHERE consent IS NOT "
                                      "0 AND exclusion IS NOT 'withdrawn'")));
    CHECK(places.size() > 20);
}

TEST_CASE("a file is read where no disk has room for an index of its log, or it is said") {
    const TemporaryFolder folder;
    const std::string file = run_by({"P"}, kFourTrials, folder.file("a.sqlite"));
    // As on a full disk: no file may grow.
    const auto piped = [](const std::string& of) {  // standard output is a file too
        return shell("(trap '' XFSZ; ulimit -f 0; \"$0\" summary \"$1\" 2>&1; echo code $?) | cat",
                     "/", {of});
    };
    CHECK_THAT(piped(file).out, Has("people: 1 in the file", "code 0"));
    // A log that was left by a crash, without its index.
    {
        data::Database open(file, data::Access::write);
        open.execute("UPDATE study SET study_title = 'another'");
        for (const char* end : {"", "-wal"}) {
            std::filesystem::copy_file(file + end, folder.file("b.sqlite") + end);
        }
    }
    CHECK_THAT(piped(folder.file("b.sqlite")).out,
               Has("the disk is full, and reading needs 32 kB"));
    CHECK_THAT(ran({"summary", folder.file("b.sqlite")}).out, Has("people: 1 in the file"));
}
