#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

// What the folder of an export, and a refused one, say of themselves.

namespace {

/// A yes-no study whose conditions are called by numbers.
std::string yes_no(const TemporaryFolder& folder, const std::string& gap = "gap_s = 0.1") {
    return write(
        folder.file("yes_no.toml"),
        edited(four_trials(),
               {{"name = \"off\"", "name = \"01\""},
                {"name = \"on\"", "name = \"1\""},
                {"[design]",
                 "[response]\nkind = \"yes_no\"\nquestion = \"Round?\"\nlow = \"no\"\nhigh = "
                 "\"yes\"\n\n[design]"},
                {"gap_s = 0.1", gap}}));
}

Finished exported(const std::string& file, const std::string& format, const std::string& to) {
    return palpate_command({"export", file, "--kind", "all", "--as", format, "-o", to});
}

}  // namespace

TEST_CASE("the label of a study means one version for ever, and says which by its hash") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    std::set<std::string> all{"fourtrials"};  // labels that meant something else before
    std::string alone;
    for (const std::string gap : {"0.1", "0.2", "0.3", "0.4"}) {
        Words run = run_words(yes_no(folder, "gap_s = " + gap), "P" + gap.substr(2), file,
                              {"--headless", "--new-version"});
        ran(run);
        std::map<std::string, std::string> hash_of;  // by label
        std::filesystem::remove_all(folder.file("csv"));
        ended(exported(file, "csv", folder.file("csv")));
        for (auto& session : csv_records(slurp(folder.file("csv/sessions.csv")))) {
            hash_of[session.at("study_label")] = session.at("protocol_sha256");
        }
        if (gap == "0.1") {
            REQUIRE(hash_of.size() == 1);
            CHECK(hash_of.begin()->first == "fourtrials");
            continue;
        }
        for (const auto& [label, hash] : hash_of) {
            CHECK(label == "fourtrialsx" + hash.substr(0, 8));
        }
        for (const std::string format : {"quickpsy", "psignifit", "psychopy"}) {
            const std::string to = folder.file(format);
            std::filesystem::remove_all(to);
            ended(exported(file, format, to));
            const std::string text = everything(to);
            CAPTURE(format, text);
            for (const auto& [label, hash] : hash_of) {
                CHECK_THAT(text, Has("," + label, "four_trials@" + hash.substr(0, 8)));
            }
            CHECK_THAT(text, !Has(",fourtrials,"));
        }
    }
    // Two ids with the same letters and digits.
    write(folder.file("other.toml"), replaced(slurp(yes_no(folder)), "four_trials", "fourtrials"));
    const std::string two = run_by({"P1"}, yes_no(folder), folder.file("two.sqlite"));
    run_by({"P1"}, folder.file("other.toml"), two);
    ended(exported(two, "csv", folder.file("two")));
    CHECK_THAT(slurp(folder.file("two/sessions.csv")), !Has(",fourtrials,1,"));
}

TEST_CASE("R reads conditions that are called by numbers as a quickpsy export has them") {
    const TemporaryFolder folder;
    const std::string file = run_by({"P1"}, yes_no(folder), folder.file("a.sqlite"));
    ended(exported(file, "quickpsy", folder.file("q")));
    const std::string readme = slurp(folder.file("q/README.txt"));
    write(folder.file("q/read.R"), "d <- " + behind(readme, "d <- ", "quickpsy::") +
                                       "cat(unique(d$condition), class(d$x), class(d$k))\n");
    if (has_r()) {
        const Finished r = shell("Rscript read.R", folder.file("q"));
        CAPTURE(r.error);
        CHECK(r.out == "01 1 integer integer");
    }
}

TEST_CASE("an export without a session, or without ticks, says why there are none") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const std::string out = folder.file("out");
    ran({"simulate", yes_no(folder), "--participants", "2", "--no-traces", "--db", file});
    check_end(palpate_command({"export", file, "--kind", "all", "--traces", "-o", out}), 2,
              Has("no session here has ticks", "export without --traces"));
    ran({"session", file, "S000001", "1", "--withdraw", "ill"});
    ran({"participant", file, "S000002", "--consent", "no"});
    check_end(exported(file, "csv", out), 2,
              Has("no session to export: of 2 sessions 1 is withdrawn, and 1 is of who does not "
                  "consent\n"));
    check_end(palpate_command({"export", file, "--kind", "real", "-o", out}), 2,
              Has("no real session to export: of 0 real sessions 0 are withdrawn",
                  "0 real, 0 pilot and 2 simulated: --kind chooses"));
    CHECK_FALSE(std::filesystem::exists(out));
}

TEST_CASE("the folder of an export says first what it is") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    ran({"simulate", "friction_threshold", "--participants", "1", "--no-traces", "--db", file});
    for (const std::string format :
         {"csv", "bids", "psych-ds", "procedure", "quickpsy", "psignifit", "psychopy"}) {
        CAPTURE(format);
        ended(exported(file, format, folder.file(format)));
        const std::string readme = format == "bids"     ? "README"
                                 : format == "psych-ds" ? "README.md"
                                                        : "README.txt";
        const Words lines = lines_in(slurp(folder.file(format + "/" + readme)));
        CHECK_FALSE(lines.front().empty());
    }
    CHECK_THAT(slurp(folder.file("procedure/README.txt")), Has("CONFIG.toml", "palpate procedure"));
}
