#include "tests/support/free_board.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

// README's rehearsal by the shipped program: an emulated board, a hand that is typed to it, keys in
// a window.

namespace {

/// Two trials without friction, and a break.
std::string study(const TemporaryFolder& folder) {
    std::string text = replaced(four_trials(), "stiffness_n_per_m = 1000\nforce_limit_n = 10",
                                "stiffness_n_per_m = 200\nforce_limit_n = 1.5");
    text = replaced(text, "break_every = 0", "break_every = 1");
    const std::size_t from = text.rfind("[[friction]]");
    std::ofstream(folder.file("p.toml")) << text.erase(from, text.find("[design]") - from);
    return folder.file("p.toml");
}

/// Two trials, as rehearsed: a hand that is typed to the emulator explores, lets go in the
/// break, and the experimenter's keys do the rest. A busy machine makes troubles, and they take
/// their time: each screen has its own.
void rehearse(OpenedSession& run, FreeBoard& board) {
    bool explores = false;
    bool felt = false;
    std::size_t troubles = 0;
    std::string before;
    std::string course;
    bool goes_on = true;
    for (int screens = 0; goes_on && run.program().running() && screens < 80; ++screens) {
        goes_on = eventually([&] {
            const auto window = run.hand.find_window("palpate: ");
            const std::string& at = window.title;
            const std::size_t said = count_of(run.program().out(), "trouble: ");
            const bool another = at != before || said > troubles;
            if (at == "palpate: explore" && !felt) {
                felt = board.motors() != "0, 0";
            } else if (at == "palpate: ready" && !explores) {
                board.bring("explore");
                explores = true;
            } else if ((at == "palpate: break" || at == "palpate: trouble") && another) {
                const std::string out = run.program().out();
                const std::string last = out.substr(std::min(out.rfind("trouble: "), out.size()));
                const bool mark = last.find("to the second mark") != std::string::npos;
                board.bring(mark ? last_place(last) : "0,89.3");  // without a jump, let go
                explores = false;
            } else if (window.id != 0) {
                press_on(run.hand);
                felt = felt && at == "palpate: explore";
            }
            course += another ? "\n" + at : ".";
            before = at;
            troubles = said;
            pause(0.3);
            return another || !run.program().running();
        });
    }
    INFO(course << "\n" << run.program().out());
    CHECK(goes_on);
    CHECK_FALSE(run.program().running());
}

}  // namespace

TEST_CASE(
    "a commissioned session is rehearsed on the emulator to its end, and recorded as simulated",
    "[open][window]") {
    const TemporaryFolder folder;
    FreeBoard board(folder, "--open");
    const std::string rig = commissioned_rig(folder, board.word());
    const std::string words = "run '" + study(folder) + "' --participant P1 --db '" +
                              folder.file("d.sqlite") + "' --windowed --device " + board.word() +
                              " --calibration '" + rig + "'";
    OpenedSession run(folder, board, words);
    run.wait_for("welcome");
    rehearse(run, board);
    check_end(run.program().wait(), 0, Has("the session is recorded as simulated"));
    CHECK(sql_lines(folder.file("d.sqlite"),
                    "SELECT session_kind, (SELECT count(*) FROM analysis_trial WHERE counts AND "
                    "mean_normal_force_n > 0.1) FROM session") == "simulated|2\n");
    ran({"verify", folder.file("d.sqlite")});
    CHECK_THAT(palpate_command({"doctor", "--device", board.word(), "--calibration", rig, "--db",
                                folder.file("e.sqlite")})
                   .out,
               Has("haply-emulator, process "));
}

TEST_CASE("behind a port where nobody is seen a session has to say of which kind it is",
          "[haply]") {
    const TemporaryFolder folder;
    const FreeBoard board(folder);
    const std::string file = folder.file("d.sqlite");
    const auto elsewhere = [&](Words words) {  // where other processes are not
        words.insert(words.begin(),
                     {"unshare", "--user", "--map-root-user", "--pid", "--fork", "--mount-proc"});
        return Process(words, {"SDL_VIDEODRIVER=dummy", "PALPATE_WORD="}).wait();
    };
    if (elsewhere({"true"}).code != 0) {
        WARN("this kernel gives no namespace of processes: not tried");
        return;
    }
    const Words run{
        palpate_program(), "run",        study(folder),   "--participant", "P1", "--db", file,
        "--device",        board.word(), "--calibration", "2diy_gen3"};
    check_end(elsewhere(run), 2, Has("a program that this user cannot see", "--kind real"));
    CHECK_FALSE(std::filesystem::exists(file));
    const Finished doctor =
        elsewhere({palpate_program(), "doctor", "--device", board.word(), "--calibration",
                   "2diy_gen3", "--db", folder.file("e.sqlite"), "--seconds", "0.1"});
    CHECK_THAT(doctor.out, Has("run will ask for --kind"));
    const Words real = joined(run, {"--kind", "real"});
    CHECK_THAT(elsewhere(real).error,
               !Has("cannot see") && Has("no real session: "));  // what is next
}
