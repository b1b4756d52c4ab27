#include "tests/support/adaptive.hpp"
#include "tests/support/program.hpp"

namespace {

/// What SQL says, without its head.
std::string by_sql(const std::string& file, const std::string& query) {
    const std::string out = sql_csv(file, query);
    return out.substr(out.find('\n') + 1);
}

/// Two people of a study.
std::string two_people(const TemporaryFolder& folder, const std::string& study) {
    return run_by({"Ada", "Bob"}, write(folder.file("p.toml"), study), folder.file("a.sqlite"));
}

/// Two people of a small study without a rule: two shapes, names of frictions that do not sort as
/// their friction does.
std::string identified(const TemporaryFolder& folder) {
    return two_people(folder, edited(four_trials(), {{"repetitions = 1", "repetitions = 2"},
                                                     {"name = \"off\"", "name = \"smooth\""},
                                                     {"name = \"on\"", "name = \"rough\""}}));
}

}  // namespace

TEST_CASE("scripts to begin with load an export in R and Python, factors and levels set") {
    const TemporaryFolder folder;
    const std::string file = identified(folder);
    const std::string out = folder.file("shared");
    ran({"export", file, "--kind", "all", "-o", out});
    CHECK_THAT(ran({"analysis", "init", out}).out, Has("analysis.R\n", "analysis.py\n"));
    const std::string wanted =
        "smooth rough|concave convex|real pilot simulated|16|" +
        by_sql(file,
               "SELECT sum(correct) FROM analysis_trial WHERE counts AND phase = 'main' AND "
               "session_kind = 'simulated'");
    const std::string loads = "Rscript -e \"source('" + script("loads_export.R") + "')\"";
    if (const Finished r = shell("Rscript analysis.R && " + loads, out); r.code == 0) {
        CHECK(lines_in(r.out).back() + '\n' == wanted);
        CHECK_THAT(r.out, Has("smooth rough\n"));
    } else {
        CHECK_FALSE(has_r());  // else the script is wrong
    }
    bool pandas = false;
    for (const char* python : {"python3", "/usr/bin/python3"}) {
        if (pandas || Process({python, "-c", "import pandas"}).wait().code != 0) {
            continue;
        }
        pandas = true;
        const Finished py = ended(
            shell(fmt::format("PYTHONPATH=. {} '{}'", python, script("loads_export.py")), out));
        CHECK(lines_in(py.out).back() + '\n' == wanted);
    }
    if (!pandas) {
        WARN("pandas is not installed: skipped");
    }
    CHECK_THAT(ran({"analysis", "init", out}, 2).error,
               Has("analysis.R is there already, and stays as it is"));
    CHECK_THAT(ran({"analysis", "init", folder.path().string()}, 2).error,
               Has("is no export: it has no columns.csv"));
}

TEST_CASE("scripts to begin with keep studies apart, and say where nothing is right or wrong") {
    const TemporaryFolder folder;
    const std::string file = identified(folder);
    std::string asked = replaced(four_trials(), "id = \"four_trials\"", "id = \"asked\"");
    asked += "\n[response]\nkind = \"yes_no\"\nquestion = \"Was it convex?\"\n";
    run_by({"Cem"}, write(folder.file("asked.toml"), asked), file);
    const std::string out = folder.file("shared with you");  // R writes its blanks as ~+~
    ran({"export", file, "--kind", "all", "-o", out});
    ran({"analysis", "init", out});
    for (const char* run : {"Rscript analysis.R", "/usr/bin/python3 analysis.py"}) {
        CAPTURE(run);
        const bool r = std::string(run).starts_with("R");
        const auto has = r ? Process({"Rscript", "-e", "1"}).wait()
                           : Process({"/usr/bin/python3", "-c", "import pandas"}).wait();
        if (has.code != 0) {
            WARN("not installed: skipped");
            continue;
        }
        const Finished ran = ended(shell(replaced(run, "analysis", "'" + out + "'/analysis")));
        CHECK_THAT(ran.out,
                   Has("fourtrials, simulated:\n", "asked, simulated: no answer is right or wrong",
                       "mean answer_code", "concave") &&
                       !Has("NA") && !Has("NaN"));
        CHECK(lines_in(behind(ran.out, "fourtrials", "asked")).size() == (r ? 4 : 5));
        const std::string script = r ? "analysis.R" : "analysis.py";
        const Finished none = shell("sed 's/\"simulated\"/\"pilot\"/' " + script + " >o_" + script +
                                        " && " + replaced(run, script, "o_" + script),
                                    out);
        CHECK(none.code == 0);
        CHECK(none.out == "pilot: no answer of a main trial counts here\n");
    }
}

TEST_CASE("quickpsy and psignifit get the counts that palpate fit takes, and no name") {
    const TemporaryFolder folder;
    const std::string file = two_people(folder, adaptive_text(kQuestPlusRule));
    const std::string wanted = by_sql(
        file,
        "SELECT printf('sub-%010d', subject), 'adaptive', session_kind, run_name, stimulus, "
        "sum(comparison_chosen), count(*) FROM analysis_trial JOIN participant USING "
        "(participant_code) WHERE counts AND phase = 'main' GROUP BY 1, 3, 4, 5 ORDER BY 1, 3, 4, "
        "5");
    ran({"export", file, "--as", "quickpsy", "--kind", "all", "-o", folder.file("q")});
    const auto ours = lines_in(slurp(folder.file("q/quickpsy.csv")));
    const auto theirs = lines_in(wanted);
    REQUIRE(ours.size() == theirs.size() + 1);
    CHECK(ours[0] == "participant,study,kind,condition,x,k,n");
    CHECK_THAT(slurp(folder.file("q/README.txt")),
               Has("grouping = c('participant', 'study', 'kind', 'condition')"));
    ran({"export", file, "--as", "psignifit", "--kind", "all", "-o", folder.file("p")});
    std::map<std::string, std::string> files;  // by whose they are
    for (const std::string& line : lines_in(slurp(folder.file("p/index.csv")))) {
        files[behind(line, ",")] = behind(line, "", ",");
    }
    std::map<std::string, std::string> counts;
    for (std::size_t i = 0; i < theirs.size(); ++i) {
        const auto fields = split(theirs[i]);
        const auto printed = split(ours[i + 1]);
        REQUIRE(printed.size() == 7);
        for (const std::size_t same : {0U, 2U, 3U, 5U, 6U}) {
            CHECK(printed[same] == fields[same]);
        }
        CHECK(std::stod(printed[4]) == std::stod(fields[4]));
        counts[fmt::format("{},{},{},{}", printed[0], printed[1], printed[2], printed[3])] +=
            fmt::format("{},{},{}\n", printed[4], printed[5], printed[6]);
    }
    CHECK(files.size() == counts.size() + 1);
    for (const auto& [whose, text] : counts) {
        CAPTURE(whose);
        REQUIRE(files.contains(whose));
        CHECK(slurp(folder.file("p/" + files[whose])) == text);
    }
    for (const char* named : {"q/quickpsy.csv", "p/index.csv", "q/README.txt", "p/README.txt"}) {
        CHECK_THAT(slurp(folder.file(named)), !Has("Ada"));
    }
    const TemporaryFolder other;
    refused(
        {"export", identified(other), "--as", "quickpsy", "--kind", "all", "-o", other.file("q")},
        "no session has two-interval or yes-no answers");
    CHECK_FALSE(std::filesystem::exists(other.file("q")));
}

TEST_CASE("PsychoPy's wide CSV has a row an answer, in the order given") {
    const TemporaryFolder folder;
    const std::string file = identified(folder);
    ran({"export", file, "--as", "psychopy", "--kind", "all", "-o", folder.file("w")});
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.file("w"))) {
        const std::string name = entry.path().filename();
        if (name == "README.txt") {
            continue;
        }
        ++files;
        CAPTURE(name);
        const std::string subject = name.substr(0, name.find('_'));
        const auto rows = lines_in(slurp(entry.path()));
        const auto wanted = lines_in(by_sql(
            file,
            "SELECT row_number() OVER (ORDER BY trial_number) - 1, attempt - 1, plan_position, "
            "phase, planned_object, friction, CAST(curvature_per_m AS INTEGER), '', '', "
            "chosen_object, correct FROM analysis_trial JOIN participant USING (participant_code) "
            "WHERE printf('sub-%010d', subject) = '" +
                subject + "' ORDER BY trial_number"));
        CHECK(rows[0].starts_with("trials.thisN,trials.thisRepN,trials.thisIndex,phase,"));
        REQUIRE(rows.size() == wanted.size() + 1);
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            const std::string plain = all_replaced(wanted[i], "\"\"", "");
            CHECK_THAT(rows[i + 1], Has(plain + ',', "," + subject + ",1,simulated,fourtrials"));
        }
    }
    CHECK(files == 2);
    const Finished more = ran({"export", file, "--as", "psychopy", "--keep-codes", "--kind", "all",
                               "-o", folder.file("x")},
                              2);
    CHECK_THAT(more.error, Has("psychopy holds no more than answers"));
}
