#include <sys/stat.h>

#include "data/store/reader.hpp"
#include "tests/support/child.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"
#include "tests/support/studies.hpp"

namespace {

std::unique_ptr<Process> started(const std::string& file, const std::string& speed) {
    return std::make_unique<Process>(command_of(demo_words(file, "P1", speed)), kNoDisplay);
}

/// Starts a slowed-down session and waits until trial `position` has stored some of its ticks.
std::unique_ptr<Process> run_into_trial(const std::string& file,
                                        int position,
                                        const std::string& speed = "40") {
    auto process = started(file, speed);
    eventually([&] {
        return !process->running() ||
               sql_now(file, fmt::format("SELECT sum(trace_chunk.ticks) >= 512 FROM trace_chunk "
                                         "JOIN trial USING (trial_id) WHERE plan_position = {} AND "
                                         "outcome = 'running'",
                                         position)) == "1";
    });
    return process;
}

std::vector<data::Ticks> answered_traces(const std::string& file) {
    data::Database database(file, data::Access::read);
    std::vector<data::Ticks> traces;
    for (const std::int64_t trial : data::answered_trials(database)) {
        traces.push_back(data::TraceReader(database).read(trial));
    }
    return traces;
}

std::string answers(const std::string& file) {
    return sql_lines(file,
                     "SELECT plan_position, planned_object, friction, chosen_object, reaction_s "
                     "FROM analysis_trial WHERE counts ORDER BY plan_position");
}

/// A pipe with a name and no room left: whoever writes to it waits.
class FullPipe {
public:
    explicit FullPipe(std::string name) : name_(std::move(name)) {
        REQUIRE(mkfifo(name_.c_str(), 0600) == 0);
        fd_ = open(name_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
        REQUIRE(fd_ >= 0);
        const std::string bytes(4096, '.');
        while (write(fd_, bytes.data(), bytes.size()) > 0) {
        }
    }
    FullPipe(const FullPipe&) = delete;
    FullPipe& operator=(const FullPipe&) = delete;
    ~FullPipe() { close(fd_); }

    [[nodiscard]] const std::string& name() const { return name_; }
    /// All that is in it now.
    [[nodiscard]] std::string taken() const {
        std::string text;
        std::string bytes(4096, '.');
        for (ssize_t got = 0; (got = read(fd_, bytes.data(), bytes.size())) > 0;) {
            text.append(bytes, 0, static_cast<std::size_t>(got));
        }
        return text;
    }

private:
    std::string name_;
    int fd_ = -1;
};

/// A session with its standard output in the file `out`.
std::unique_ptr<Process> run_into(const std::string& out,
                                  const std::string& file,
                                  const std::string& speed = "0") {
    return std::make_unique<Process>(
        joined({"sh", "-c", "out=$1; shift; exec \"$@\" >\"$out\"", "sh", out},
               command_of(demo_words(file, "P1", speed))),
        kNoDisplay);
}

/// How many trials.
std::string answered(const std::string& file) {
    return sql_now(file, "SELECT count(*) FROM response");
}

}  // namespace

TEST_CASE(
    "kill -9 in the middle of a trial: sound file, finished trials there, the same order goes on") {
    const TemporaryFolder folder;
    ran(demo_words(folder.file("unbroken.sqlite")));
    const std::string file = folder.file("killed.sqlite");
    for (const int position : {2, 6}) {
        const auto process = run_into_trial(file, position);
        REQUIRE(process->running());
        process->signal(SIGKILL);
        CHECK(process->wait().code == 128 + SIGKILL);
        CHECK(sql_first(file, "PRAGMA integrity_check") == "ok");
        CHECK(answered_traces(file).size() == static_cast<std::size_t>(position));
    }
    CHECK_THAT(ran(demo_words(file)).out, Has("Resuming at trial 7", "kept as interrupted"));
    // What was answered and felt is that of the unbroken session, to the bit.
    CHECK(answers(file) == answers(folder.file("unbroken.sqlite")));
    const auto broken = answered_traces(file);
    const auto unbroken = answered_traces(folder.file("unbroken.sqlite"));
    REQUIRE(broken.size() == unbroken.size());
    for (std::size_t i = 0; i < broken.size(); ++i) {
        REQUIRE(broken[i].size() == unbroken[i].size());
        for (std::size_t k = 0; k < broken[i].size(); ++k) {
            REQUIRE(same_bits(broken[i][k], unbroken[i][k]));
        }
    }
    CHECK(sql_first(file, "SELECT count(*) FROM trial WHERE outcome = 'interrupted'") == "2");
}

TEST_CASE("an interrupt ends the session cleanly: trial kept as aborted, exit code 3, resumable") {
    const TemporaryFile file("d.sqlite");
    const auto process = run_into_trial(file, 1);
    process->signal(SIGINT);
    CHECK_THAT(ended(process->wait(), 3).out, Has("goes on there"));
    {
        data::Database database(file, data::Access::read);
        auto row = database.first("SELECT trial_id, ticks FROM trial WHERE outcome = 'aborted'");
        const auto trace = data::TraceReader(database).read(row.integer(0));
        CHECK(glm::length(trace.back().command) < 1e-9);  // ramped out
    }
    ran(demo_words(file));
}

TEST_CASE(
    "a signal that comes again within a second is one wish, a later one ends the program at once") {
    const TemporaryFolder folder;
    const auto tidy = run_into_trial(folder.file("d.sqlite"), 1);
    for (int again = 0; again < 250 && tidy->running(); ++again) {  // timeout(1) says it twice
        tidy->signal(SIGTERM);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    CHECK_THAT(ended(tidy->wait(), 3).out, Has("Stopped before ", "Seal "));

    const std::string file = folder.file("e.sqlite");
    data::Database theirs(file, data::Access::write);
    const data::Transaction locked(theirs);  // for five seconds it waits to write
    Process stuck(command_of(demo_words(file)));
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
    for (const int wait_ms : {200, 1300}) {
        stuck.signal(SIGINT);
        CHECK(stuck.running());
        std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
    }
    CHECK(stuck.running());
    stuck.signal(SIGINT);
    CHECK(stuck.wait().code == 128 + SIGINT);
}

TEST_CASE("a file that something writes over while it is in use is not said to be finished") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    const std::string copy = folder.file("copy.sqlite");
    const auto session = run_into_trial(file, 1, "10");
    REQUIRE(Process({"sqlite3", file, ".backup '" + copy + "'"}).wait().code == 0);
    const std::string before = slurp(copy);
    eventually([&] {
        return !session->running() || sql_first(file, "SELECT count(*) >= 3 FROM response") == "1";
    });
    write(file, before);  // as cp does: the same file
    check_end(session->wait(), 1, Has("something wrote over it while it was in use"));
}

TEST_CASE("who deletes the log of a running session spoils nobody's session") {
    const TemporaryFile file("d.sqlite");
    const auto first = started(file, "10");
    // Not asked of the file: while somebody reads it, a part of an answer may stand in the log.
    REQUIRE(first->says("\n#2 "));
    std::filesystem::remove(file + "-wal");
    std::filesystem::remove(file + "-shm");
    first->signal(SIGSTOP);  // what both wrote would be in two files
    for (const auto& second : {demo_words(file), {"note", file, "rested", "--participant", "P1"}}) {
        check_end(palpate_command(second), 1, Has("d.sqlite-wal, was deleted", "end that program"));
    }
    first->signal(SIGCONT);
    check_end(first->wait(), 1, Has("d.sqlite.rescued: put that in the place of"));
    CHECK_THAT(ran({"verify", file}).out, Has("Nothing differs"));
    ran(demo_words(file));
    CHECK(std::filesystem::status(file + ".rescued").permissions() ==
          (std::filesystem::perms::owner_read | std::filesystem::perms::owner_write));
    ran({"verify", file + ".rescued"});
}

TEST_CASE("a database put in the place of a running session's is neither read nor written") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    const std::string other = folder.file("other.sqlite");
    ran(demo_words(other));
    const auto running = started(file, "10");
    REQUIRE(running->says("\n#2 "));
    running->signal(SIGSTOP);  // else it ends when it sees that its file was moved
    std::filesystem::rename(file, folder.file("moved.sqlite"));
    std::filesystem::copy_file(other, file);
    for (const auto& second :
         {demo_words(file), {"note", file, "rested", "--participant", "P1"}, {"status", file}}) {
        check_end(palpate_command(second), 1, Has("d.sqlite-wal, is of another database"));
    }
    CHECK(slurp(file) == slurp(other));
    std::filesystem::remove(file);
    std::filesystem::rename(folder.file("moved.sqlite"), file);
    CHECK(running->ended_by(SIGCONT) == 0);
    CHECK_THAT(ran({"verify", file}).out, Has("Nothing differs"));
}

TEST_CASE("a session changed by hand between its runs goes on, and both its ends say so") {
    const TemporaryFile file("d.sqlite");
    CHECK(run_into_trial(file, 3)->ended_by(SIGTERM) == 3);
    const std::string edit = GENERATE(as<std::string>{},
                                      "UPDATE response SET reaction_s = reaction_s + 1 WHERE "
                                      "trial_id = 2",
                                      "UPDATE plan SET mu_s = mu_s + 1 WHERE "
                                      "plan_position = 9");
    CAPTURE(edit);
    sql_edit(file, edit);
    const Finished end = ran(demo_words(file));
    CHECK_THAT(end.error, Has("changed by hand before it goes on here: 1 seal", "palpate verify"));
    CHECK_THAT(end.out, Has("changed before this run", "Finished."));
    CHECK_THAT(ran({"verify", file}, 1).out, Has("differ"));
}

TEST_CASE("two programs cannot run one session at once") {
    const TemporaryFile file("d.sqlite");
    const auto process = run_into_trial(file, 1);
    REQUIRE(process->running());
    CHECK_THAT(ran(demo_words(file), 1).error, Has("another palpate"));
    CHECK(process->wait().code == 0);  // and the first does not notice
    CHECK(sql_lines(file,
                    "SELECT count(*), sum(outcome <> 'complete'), (SELECT count(*) FROM event "
                    "WHERE event_kind = 'interrupted') FROM trial") == "10|0|0\n");
}

TEST_CASE("what runs in another container is not run again, and nobody is told that nothing runs",
          "[safety]") {
    const auto elsewhere = [](const Words& command) {
        return Process(joined({"unshare", "--user", "--map-root-user", "--net"}, command),
                       kNoDisplay)
            .wait();
    };
    if (elsewhere({"true"}).code != 0) {
        WARN("this kernel gives no namespace of networks: not tried");
        return;
    }
    const TemporaryFile file("d.sqlite");
    const std::string palpate = palpate_program();
    const Words run = command_of(demo_words(file));
    const auto first = run_into_trial(file, 1, "2");
    check_end(elsewhere(run), 1, Has("another palpate"));
    check_end(elsewhere({palpate, "stop", file}), 1,
              Has("cannot be called from here", "the switch of its motors"));
    const Finished status = elsewhere({palpate, "status", file});
    CHECK(status.code == 1);
    CHECK_THAT(status.out, Has("running: P1", "another container") && !Has("Nothing runs"));
    CHECK_THAT(elsewhere({palpate, "sql", file, "-c", "SELECT 1"}).error,
               Has("a session runs on it"));
    {  // one that can be called hides none that cannot
        const Process other(joined({"unshare", "--user", "--map-root-user", "--net"},
                                   command_of(demo_words(file, "P2", "2"))),
                            kNoDisplay);
        REQUIRE(eventually(
            [&] { return sql_now(file, "SELECT 1 FROM trial WHERE session_id = 2") == "1"; }));
        const Finished stop = ran({"stop", file}, 1);
        CHECK_THAT(stop.out, Has("No force any more in 1 session", "participant P1"));
        CHECK_THAT(stop.error, Has("1 session on it cannot be called from here"));
    }

    first->signal(SIGKILL);
    static_cast<void>(first->wait());
    check_end(elsewhere({palpate, "stop", file}), 1, Has("no session runs on it"));
    CHECK_THAT(elsewhere({palpate, "status", file}).out, Has("Nothing runs on it now"));
    CHECK(elsewhere(run).code == 0);
    CHECK(sql_first(file,
                    "SELECT sum(answered) FROM session_health WHERE participant_code = "
                    "'P1'") == "10");
}

TEST_CASE("a session that was stopped from a shell keeps its log, whoever else writes the file") {
    const TemporaryFile file("d.sqlite");
    const auto process = run_into_trial(file, 1, "2");
    ran({"stop", file});
    ran({"participant", file, "P1", "--set", "age=31"});
    CHECK(process->running());
    CHECK(std::filesystem::exists(file + "-wal"));  // else what it goes on to write is lost
}

TEST_CASE("a program that is held up before its first answer keeps its session") {
    const TemporaryFile file("d.sqlite");
    const auto first = started(file, "0");
    REQUIRE(eventually([&] { return sql_now(file, "SELECT count(*) FROM session") == "1"; }));
    first->signal(SIGSTOP);
    CHECK_THAT(ran(demo_words(file), 1).error, Has("another palpate"));
    CHECK(first->ended_by(SIGCONT) == 0);
    CHECK(sql_lines(file,
                    "SELECT (SELECT count(*) FROM response), count(DISTINCT plan_position) "
                    "FROM trial") == "10|10\n");
}

TEST_CASE("a session goes on while nobody reads what it says, and who reads late reads all of it") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    const FullPipe pipe(folder.file("pipe"));
    const auto session = run_into(pipe.name(), file);
    REQUIRE(eventually([&] { return answered(file) == "10"; }));
    CHECK_THAT(ran({"status", file}).out, Has("10 of 10 answered"));
    std::string read;
    CHECK(eventually([&] {
        read += pipe.taken();
        return !session->running();
    }));
    read += pipe.taken();
    CHECK(session->wait().code == 0);
    CHECK_THAT(read, Has("10 trials", "\n#1 ", "\n#10 ", "Seal ", "Finished."));
}

TEST_CASE("a session ends as it does, and is stopped, whether or not anybody reads what it says") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    const FullPipe pipe(folder.file("pipe"));
    const auto session = run_into(pipe.name(), file, "10");
    REQUIRE(eventually([&] { return answered(file) == "2"; }));
    CHECK_THAT(ran({"stop", file}).out, Has("force"));
    session->signal(SIGTERM);
    const std::int64_t asked = monotonic_ns();
    check_end(session->wait(), 3, Has("nobody read standard output", "are lost"));
    CHECK(monotonic_ns() - asked < 5000 * kMillisecond);
    CHECK_THAT(ran({"verify", file}).out, Has("Nothing differs"));
}
