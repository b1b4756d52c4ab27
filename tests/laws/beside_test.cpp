#include "tests/support/child.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

/// What lies beside a file, or under another name of it.
namespace {

/// A session, slowed down, up to its third trial, before which stands `said`.
std::unique_ptr<Process> run_to_third(const std::string& file,
                                      const std::string& participant = "P1",
                                      const std::string& said = "\n#2 ") {
    auto running =
        std::make_unique<Process>(command_of(demo_words(file, participant, "10")), kNoDisplay);
    REQUIRE(running->says(said));
    return running;
}

/// Until the log holds a part of a trial.
void await_log(const std::string& file) {
    REQUIRE(eventually([&] {
        std::error_code none;
        const auto size = std::filesystem::file_size(file + "-wal", none);
        return !none && size > 100'000;
    }));
}

/// Such a session, killed in that trial.
void killed_at_third(const std::string& file,
                     const std::string& participant = "P1",
                     const std::string& said = "\n#2 ") {
    const auto running = run_to_third(file, participant, said);
    await_log(file);
    running->ended_by(SIGKILL);
}

/// Nothing in it differs.
void check_clean(const std::string& file) {
    CHECK_THAT(ran({"verify", file}).out, Has("Nothing differs"));
}

std::string answers(const std::string& file) {
    return sql_lines(file, "SELECT count(*) FROM response");
}

}  // namespace

TEST_CASE("a file deleted in the midst of a trial is there again, and the same command goes on") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    ran(demo_words(file));
    const auto running = run_to_third(file, "P2", "\n#12 ");
    await_log(file);
    std::filesystem::remove(file);
    check_end(running->wait(), 1, Has("d.sqlite: it was deleted", "in it again: run again"));
    CHECK(folder.names() == Words{"d.sqlite"});
    check_clean(file);
    const int before = std::stoi(answers(file));
    CHECK(before >= 12);
    CHECK_THAT(ran(demo_words(file, "P2")).out, Has("Resuming at ", "Finished."));
    CHECK(answers(file) == "20\n");
    check_clean(file);
}

TEST_CASE("a copy put in the place of a file whose log a crash left is not mixed with that log") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    const std::string copy = folder.file("copy.sqlite");
    ran(demo_words(file));
    std::filesystem::copy_file(file, copy);
    killed_at_third(file, "P2", "\n#12 ");
    const std::string log = slurp(file + "-wal");
    std::filesystem::copy_file(copy, file, std::filesystem::copy_options::overwrite_existing);
    for (const auto& second :
         {demo_words(file, "P2"), {"status", file}, {"summary", file}, {"verify", file}}) {
        check_end(palpate_command(second), 1,
                  Has("d.sqlite-wal, goes with another state of it", "d.sqlite-shm away"));
    }
    CHECK(slurp(file) == slurp(copy));
    CHECK(slurp(file + "-wal") == log);
    std::filesystem::remove(file + "-wal");
    std::filesystem::remove(file + "-shm");
    check_clean(file);
    ran(demo_words(file, "P2"));
    CHECK(answers(file) == "20\n");
}

TEST_CASE("a file of two names is written under none of them, and no answer is lost") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    const std::string second = folder.file("second.sqlite");
    killed_at_third(file);
    std::filesystem::create_hard_link(file, second);
    for (const std::string& name : {file, second}) {
        check_end(palpate_command(demo_words(name)), 1, Has("has 2 names (hard links)"));
    }
    std::filesystem::remove(second);
    ran(demo_words(file));
    CHECK(answers(file) == "10\n");
    check_clean(file);
}

TEST_CASE("of a session's file nobody reads a second name, and is told which to use") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    const std::string second = folder.file("second.sqlite");
    const auto running = run_to_third(file);
    std::filesystem::create_hard_link(file, second);
    check_end(palpate_command({"status", second}), 1, Has("under another of its names"));
    CHECK(running->wait().code == 0);
    check_clean(file);
}

TEST_CASE("nothing begins beside what was rescued or where a link leads nowhere") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    std::filesystem::create_symlink("nowhere/x", file);
    check_end(palpate_command(demo_words(file)), 2, Has("a link to nowhere/x, which is not there"));
    std::filesystem::remove(file);
    write(file + ".rescued", "");
    check_end(palpate_command(demo_words(file)), 2, Has("d.sqlite.rescued beside it is what was"));
    CHECK(folder.names() == Words{"d.sqlite.rescued"});
    std::filesystem::remove(file + ".rescued");
    write(file, "");
    check_end(palpate_command({"verify", file}), 2, Has("nothing is in it", "killed"));
    ran(demo_words(file));
}

TEST_CASE("no new file begins beside the log of one that was moved away, and that log stays") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    const std::string moved = folder.file("moved.sqlite");
    killed_at_third(file);
    std::filesystem::rename(file, moved);
    std::filesystem::remove(file + "-shm");
    const std::string log = slurp(file + "-wal");
    REQUIRE_FALSE(log.empty());
    for (const Words& begins :
         {demo_words(file), Words{"verify", file}, Words{"participant", file, "P1", "--new"},
          Words{"merge", file, moved},
          Words{"simulate", "shape_friction_demo", "--participants", "1", "--db", file}}) {
        for (const bool empty : {false, true}) {
            if (empty && begins.front() == "simulate") {
                continue;  // it makes another file, and puts that in its place
            }
            CAPTURE(begins, empty);
            std::filesystem::remove(file);
            if (empty) {
                write(file, "");
            }
            check_end(palpate_command(begins), 2, Has("d.sqlite-wal beside it is the log"));
            CHECK(slurp(file + "-wal") == log);
            CHECK(std::filesystem::exists(file) == empty);
        }
    }
    std::filesystem::remove(file);
    std::filesystem::rename(moved, file);
    ran(demo_words(file));
    ran({"verify", file});
}

TEST_CASE("what a crash left is exported, with the log beside it") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    ran(demo_words(file));
    killed_at_third(file, "P2", "\n#12 ");
    ran({"export", file, "--kind", "all", "-o", folder.file("shared")});
    ran({"report", file, "--kind", "simulated", "-o", folder.file("report.html")});
}

TEST_CASE("rows deleted by hand are said in a sentence where new ones take their place") {
    const TemporaryFile file("d.sqlite");
    const auto running = run_to_third(file);
    CHECK(running->ended_by(SIGTERM) == 3);
    sql_edit(file,
             "PRAGMA foreign_keys = OFF; DELETE FROM trial WHERE trial_id = (SELECT max(trial_id) "
             "FROM trial)");
    const Finished end = palpate_command(demo_words(file));
    CHECK_THAT(end.error, Has("rows were changed or deleted by hand", "palpate verify"));
    CHECK_THAT(end.error, !Has("INSERT"));
}

TEST_CASE("where too few files may be open nobody is said to have written over one") {
    std::string said;
    for (const char* files : {"10", "11", "12", "13"}) {
        const TemporaryFolder folder;
        const Finished end = Process(joined({"sh", "-c", "ulimit -n $0; exec \"$@\"", files},
                                            command_of(demo_words(folder.file("d.sqlite")))),
                                     kNoDisplay)
                                 .wait();
        CHECK_THAT(end.error, !Has("something wrote over it"));
        said += end.error;
    }
    CHECK_THAT(said, Has("could not be looked at again"));
}
