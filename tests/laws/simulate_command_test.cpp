#include "protocols/file/observer_file.hpp"
#include "data/store/database.hpp"
#include "tests/support/json_of.hpp"
#include "tests/support/program.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/sql_first.hpp"
#include "tests/support/studies.hpp"

namespace fs = std::filesystem;

namespace {

/// Typical people with quick hands: a trial is simulated in a third of the time.
std::string people_file() {
    static const TemporaryFile file("people.toml");
    protocols::ObserverModel model = protocols::typical_observer();
    model.hand.speed = 2.5;
    write(file, protocols::observer_text(model));
    return file;
}

Words simulate(const Words& more, const std::string& people = "4") {
    return joined({"simulate", kFourTrials, "--participants", people, "--observer", people_file()},
                  more);
}

/// All that the rows say, names and seals of sessions too.
std::string content(const std::string& file) {
    data::Database database(file, data::Access::read);
    return content_hash(database) +
           lines(database,
                 "SELECT participant_code, uuid, newest_seal, started_utc, finished_utc FROM "
                 "session JOIN participant USING (participant_id) ORDER BY session_id");
}

}  // namespace

TEST_CASE("any number of threads simulates the same bytes, and shards merged are the same study") {
    const TemporaryFolder folder;
    const std::string one = folder.file("one.sqlite");
    ran(simulate({"--db", one, "--threads", "1"}));
    for (const char* threads : {"2", "5"}) {
        const std::string file = folder.file(std::string("t") + threads + ".sqlite");
        ran(simulate({"--db", file, "--threads", threads}));
        CHECK(slurp(file) == slurp(one));
    }
    Words merge{"merge", "--expect", "3", folder.file("all.sqlite")};
    for (const char* shard : {"2/3", "0/3"}) {
        ran(simulate({"-o", folder.file("shards"), "--shard", shard, "--threads", "1"}));
        merge.push_back(
            folder.file(fmt::format("shards/shard-00{}-of-003.sqlite", std::string(shard, 1))));
    }
    const Finished missing = ran(merge, 2);
    CHECK_THAT(missing.error, Has("one shard of 3 missing", "--array=1"));
    Words miscounted = merge;
    miscounted[2] = "2";
    CHECK_THAT(ran(miscounted, 2).error, Has("of-003.sqlite: it is one of 3 shards, not of 2"));
    // A shard is what it holds, whatever its name.
    const std::string third = folder.file("wrong/shard-001-of-003.sqlite");
    fs::create_directory(folder.file("wrong"));
    fs::copy_file(merge.back(), third);
    merge.push_back(third);
    CHECK_THAT(ran(merge, 2).error, Has("S000001 is none of shard 1/3"));
    for (const auto& [more, people, why] :
         {std::tuple("--seed=9", "4", "another seed"),
          std::tuple("--no-traces", "4", "another choice of --no-traces"),
          std::tuple("--threads=1", "11", "S000011"),
          std::tuple("--secret=00000000000000000000000000000001", "4", "another secret")}) {
        fs::remove(third);
        ran(simulate({"--db", third, "--shard", "1/3", more}, people));
        CHECK_THAT(ran(merge, 2).error, Has(why, "nothing was merged"));
    }
    merge.pop_back();
    CHECK_FALSE(fs::exists(folder.file("all.sqlite")));

    // The last one as Slurm would run its script.
    const Finished script =
        ran(simulate({"-o", folder.file("shards"), "--slurm", "3", "--threads", "2"}));
    CHECK_THAT(script.out, Has("#SBATCH --array=0-2\n", "#SBATCH --cpus-per-task=2\n",
                               "#SBATCH --signal=B:TERM@60\n", "#SBATCH --requeue\n", "\nexec "));
    write(folder.file("study.sbatch"), script.out);
    ended(Process({"sh", folder.file("study.sbatch")},
                  {"SLURM_ARRAY_TASK_ID=1", "SLURM_CPUS_PER_TASK=2",
                   "TMPDIR=" + folder.file("shards"), "SLURM_ARRAY_TASK_COUNT=1"})
              .wait());
    merge.push_back(folder.file("shards/shard-001-of-003.sqlite"));
    ran(merge);
    CHECK(content(folder.file("all.sqlite")) == content(one));
    CHECK_THAT(palpate_command({"merge", folder.file("all.sqlite"), one}).out,
               Has("0 sessions new, 0 went on, 4 as before"));

    CHECK_THAT(ran({"verify", one}).out, Has("Nothing differs."));

    // Somebody of them wanted to be destroyed, the first or another.
    for (const char* code : {"S000001", "S000003"}) {
        for (std::size_t i = 4; i < merge.size(); ++i) {
            if (sql_csv(merge[i], "SELECT participant_code FROM participant").find(code) !=
                std::string::npos) {
                ran({"participant", merge[i], code, "--destroy", "everything", "--yes"});
            }
        }
        fs::remove(folder.file("all.sqlite"));
        CHECK_THAT(ran(merge).out, Has("4 sessions new"));
    }
}

TEST_CASE(
    "a simulation follows no link that somebody laid beside its file, and removes no other's") {
    const TemporaryFolder folder;
    const std::string file = folder.file("s.sqlite");
    const std::string mine = folder.file("mine");
    std::ofstream(mine) << "a diary";
    std::ofstream(file + ".new") << "a letter";
    fs::create_symlink(mine, file + ".partial.new");
    ran(simulate({"--db", file, "--scratch", folder.file("scratch")}, "2"));
    CHECK(slurp(mine) == "a diary");
    CHECK(slurp(file + ".new") == "a letter");
    CHECK(fs::is_symlink(file + ".partial.new"));
    CHECK(fs::is_regular_file(fs::symlink_status(file)));
    CHECK(fs::status(file).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("a simulation that was killed or stopped goes on, and gives the same bytes") {
    const TemporaryFolder folder;
    const std::string whole = folder.file("whole.sqlite");
    const std::string people = "8";
    ran(simulate({"--db", whole}, people));
    /// Begins it, and sends the signal when the second participant is kept. @return the exit code
    const auto broken_off = [&](const std::string& file, int signal, const Words& more) {
        for (int tries = 0; tries < 5; ++tries) {
            fs::remove(file);
            Words words = joined(simulate({"--db", file, "--threads", "1"}, people), more);
            Process run(command_of(words));
            while (run.running() && run.out().find("S000002") == std::string::npos) {
                pause(0.001);
            }
            run.signal(signal);
            const int code = run.wait().code;
            if (!fs::exists(file)) {
                return code;
            }
        }
        return -1;
    };
    const std::string killed = folder.file("killed.sqlite");
    CHECK(broken_off(killed, SIGKILL, {}) == 128 + SIGKILL);
    CHECK(fs::exists(killed + ".partial"));
    CHECK_THAT(ran(simulate({"--db", killed}, people)).out, !Has("S000001"));
    CHECK(slurp(killed) == slurp(whole));

    const std::string stopped = folder.file("stopped.sqlite");
    const Words scratch{"--scratch", folder.file("scratch")};
    CHECK(broken_off(stopped, SIGTERM, scratch) == 3);
    CHECK(fs::exists(stopped + ".partial"));
    CHECK(fs::is_empty(folder.file("scratch")));
    CHECK_THAT(ran(joined(simulate({"--db", stopped}, people), scratch)).out, !Has("S000001"));
    CHECK(slurp(stopped) == slurp(whole));
    CHECK(fs::is_empty(folder.file("scratch")));
    const Words left{"killed.sqlite", "scratch", "stopped.sqlite", "whole.sqlite"};
    CHECK(folder.names() == left);
}

TEST_CASE("a file that is whole is left, and one of something else is refused") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    const Words same = simulate({"--db", file, "--no-traces"}, "2");
    ran(same);
    const std::string bytes = slurp(file);
    CHECK_THAT(ran(same).out, Has("already done"));
    write(folder.file("bad.toml"), "format = 1\n[people]\nnoise_sd = 1\n");
    for (const auto& row : test_rows("simulate_refusals.tsv")) {
        refused(words_of("simulate", row.at(0),
                         {{"{study}", kFourTrials},
                          {"{quick}", people_file()},
                          {"{db}", file},
                          {"{new}", folder.file("n.sqlite")},
                          {"{bad}", folder.file("bad.toml")}}),
                row.at(1));
    }
    CHECK(slurp(file) == bytes);

    CHECK_THAT(ran({"verify", file}).out, Has("0 ticks replayed, nothing differs"));
    ran({"summary", file});

    // SQLite would take such a name for a URI, and write another file.
    ended(shell("\"$0\" simulate pilot --participants 1 --no-traces --db file:u.sqlite",
                folder.path()));
    CHECK(slurp(folder.file("file:u.sqlite")).starts_with("SQLite format 3"));
}

TEST_CASE("verify asks the drawn person again: an observer that was not the one is noticed") {
    const TemporaryFile file("d.sqlite");
    ran(simulate({"--db", file}, "2"));
    sql_edit(file,
             "UPDATE session_provenance SET value = replace(value, 'median_s = 1.5', 'median_s = "
             "2') "
             "WHERE key = 'observer'");
    CHECK_THAT(ran({"verify", file}, 1).out, Has("response.reaction_s"));
}

TEST_CASE("stats finds the effect of friction that an observer has, and none where there is none") {
    const TemporaryFolder folder;
    write(folder.file("study.toml"),
          edited(slurp(kFourTrials), {{"repetitions = 1", "repetitions = 5"},
                                      {"curvature_per_m = 8", "curvature_per_m = 4"},
                                      {"curvature_per_m = -8", "curvature_per_m = -4"}}));
    /// Of the share of right answers, friction on against off: mean difference and its interval.
    const auto difference = [&](const std::string& friction) {
        write(folder.file("observer.toml"),
              "format = 1\n[hand]\nspeed_factor = 2.5\n[observer]\nnoise_per_m = 2.5\nlapse "
              "= 0\n[people]\nnoise_sd_ln = 0.2\n[friction]\n" +
                  friction);
        const std::string file = folder.file("d.sqlite");
        fs::remove(file);
        ran({"simulate", folder.file("study.toml"), "--participants", "6", "--observer",
             folder.file("observer.toml"), "--db", file, "--no-traces"});
        return json_of({"stats", file, "--kind", "simulated", "--permutations", "0",
                        "--simulations", "0"})
            .at(Json::json_pointer("/applied/measures/d_prime/effects/on/interval_95"))
            .get<std::vector<double>>();
    };
    CHECK(difference("noise_factor_per_mu = 60\n").back() < 0.0);
    const std::vector<double> none = difference("");
    CHECK(none.front() < 0.0);
    CHECK(none.back() > 0.0);
}

TEST_CASE("a study whose ticks were not kept has none in sample, and is reported without maps") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    ran({"simulate", "shape_friction_demo", "--participants", "3", "--no-traces", "--db", file});
    CHECK(sql_csv(file, "SELECT count(*) AS n FROM sample") == "n\n0\n");
    for (const char* name : {"sample", "SAMPLE"}) {  // SQL takes names in any letters
        CHECK_THAT(palpate_command({"sql", file, "-c", std::string("SELECT 1 FROM ") + name}).error,
                   Has("no ticks are kept in this file: sample has no row"));
    }
    const std::string page = folder.file("a.html");
    ran({"report", file, "--kind", "simulated", "-o", page});
    CHECK_THAT(slurp(page), Has("No ticks are kept of these trials"));
    const Finished again = ran(run_words("shape_friction_demo", "S000001", folder.file("b.sqlite"),
                                         {"--headless", "--device", "replay:" + file}),
                               1);
    CHECK_THAT(again.error, Has("has no ticks: it was simulated with --no-traces"));
}

TEST_CASE("what simulate names as next looks at the answers of any protocol") {
    const TemporaryFolder folder;
    const std::string rating =
        "\n[response]\nkind = \"rating\"\nquestion = \"How convex?\"\nlevels = 5\n";
    const std::string rule = short_text("friction_threshold", {});
    for (const auto& [protocol, command] :
         {std::pair<std::string, std::string>{slurp(kFourTrials), "stats"},
          {slurp(kFourTrials) + rating, "summary"},
          {rule, "fit"}}) {
        write(folder.file("p.toml"), protocol);
        const std::string file = folder.file(command + ".sqlite");
        const Finished made = ran({"simulate", folder.file("p.toml"), "--participants", "2", "--db",
                                   file, "--no-traces"});
        const Words words = split(behind(made.out, "Next: palpate "), ' ');
        CHECK(words.front() == command);
        CHECK_THAT(ran(words).out, Has("simulated"));
    }
}
