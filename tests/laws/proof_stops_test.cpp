#include "tests/support/free_board.hpp"
#include "tests/support/program.hpp"
#include "tests/support/stop_ways.hpp"

// Weak pulses before there is a session, and whoever wants none any more: the shipped program, a
// board on a pseudo-terminal whose handle nobody holds, a terminal, another shell and a pipe in
// place of a button.

TEST_CASE("weak pulses of an opening and of commission end by every way to stop, nothing is made",
          "[haply][safety]") {
    EACH(opening, true, false);
    const TemporaryFolder folder;
    FreeBoard board(folder);
    const Terminal terminal;
    StopButton button(folder.file("button"));
    const std::string made = folder.file(opening ? "d.sqlite" : "new.toml");
    const Words begins = opening ? run_words(study_of_rig(folder), "P1", made,
                                             {"--kind", "real", "--windowed", "--calibration",
                                              commissioned_rig(folder, board.word())})
                                 : Words{"commission", "-o", made};
    const Words words = joined(command_of(begins), {"--device", board.word(), "--stop-button",
                                                    folder.file("button"), "--handle-free"});
    const auto ends = [&](const std::string& way, const std::function<bool(pid_t)>& act,
                          int code = 3) {
        CAPTURE(way);
        Finished end;
        bool acted = false;
        // A busy machine may leave the board without its turn before any pulse, or act after the
        // last one: then once more.
        for (int attempt = 0; attempt < 8 && !acted; ++attempt) {
            board.bring("0,89.3");
            Process program(
                words, {std::string(kTerminal) + "=" + terminal.name(), "SDL_VIDEODRIVER=dummy"});
            std::size_t asked = 0;
            bool pulsed = false;
            CHECK(eventually([&] {
                const std::string out = program.out();
                const std::size_t asks = out.rfind("Bring the handle to");
                if (asks != std::string::npos && asks >= asked) {
                    asked = out.size();
                    board.bring(last_place(out.substr(asks)));
                    terminal.type("\n");
                }
                pulsed = board.motors() != "0, 0";
                return pulsed || !program.running();
            }));
            acted = pulsed && act(program.id());
            end = program.wait();
        }
        REQUIRE(acted);
        CHECK(end.code == code);
        CHECK_THAT(end.error, Has(code == 3 ? "stopped" : ""));
        CHECK(eventually([&] { return board.motors() == "0, 0"; }));
        CHECK_FALSE(std::filesystem::exists(made));
        CHECK((code != 3 || terminal.as_before()));  // who is killed leaves Escape behind
    };
    const auto types = [&](pid_t) {
        terminal.type("\x1b");
        return true;
    };
    ends("terminal", types);
    for (const bool named : {false, true}) {  // its file is not there yet
        ends("palpate stop", [&](pid_t) {
            const Finished stop =
                named ? palpate_command({"stop", made}) : palpate_command({"stop"});
            CHECK_THAT(stop.code == 0 ? stop.out : stop.error,
                       Has(stop.code == 0 ? "weak pulses that prove a rig"
                           : named        ? "there is no such file"
                                          : "is yours"));
            return stop.code == 0;
        });
    }
    for (const int signal : {SIGINT, SIGHUP}) {
        ends(strsignal(signal), [&](pid_t program) { return kill(program, signal) == 0; });
    }
    ends("stop button", [&](pid_t) {
        button.send(1);
        button.send(0);
        return true;
    });
    ends("stop button gone", [&](pid_t) {
        button.unplug();
        return true;
    });
    button.plug_in();
    ends(
        "killed", [&](pid_t program) { return kill(program, SIGKILL) == 0; }, 128 + SIGKILL);
}

TEST_CASE("Escape at a question stops, and no pulse comes after it", "[haply]") {
    const TemporaryFolder folder;
    FreeBoard board(folder);
    const Terminal terminal;
    const std::string made = folder.file("new.toml");
    Process program(
        {palpate_program(), "commission", "--device", board.word(), "-o", made, "--handle-free"},
        {std::string(kTerminal) + "=" + terminal.name()});
    REQUIRE(program.says("Bring the handle to"));
    bool pulsed = false;
    std::int64_t typed_ns = 0;
    CHECK(eventually([&] {
        if (monotonic_ns() - typed_ns >
            1000 * kMillisecond) {  // before it listens it hears nothing
            terminal.type("\x1b");
            typed_ns = monotonic_ns();
        }
        pulsed = pulsed || board.motors() != "0, 0";
        return !program.running();
    }));
    check_end(program.wait(), 3, Has("stopped"));
    CHECK_FALSE(pulsed);
    CHECK_FALSE(std::filesystem::exists(made));
    CHECK(terminal.as_before());
}
