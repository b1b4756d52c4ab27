#include "tests/support/free_board.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

// Sessions on a commissioned rig, by the shipped program in a window: what is proved before anybody
// feels a force, at the opening, after a replug and in breaks, and who may be run.

TEST_CASE(
    "a real session opens with a rest, weak pulses and the second mark, and keeps them as events",
    "[haply][window]") {
    const TemporaryFolder folder;
    const bool open = GENERATE(false, true);
    FreeBoard board(folder, open ? "--open" : "");
    const std::string rig = commissioned_rig(folder, board.word());
    OpenedSession run(folder, board, real_words(folder, board, rig));
    run.wait_for("welcome");
    if (!open) {
        // A break asks for the handle, and by itself for no more than Space once it was proved.
        run.press_up_to("question");
        board.bring("20,89.3");
        run.press_up_to("break");
        pause(6.0);
        const auto window = run.hand.find_window("palpate: break");
        const std::uint64_t asks = run.hand.pixels(window);
        board.bring("0,89.3");
        const auto shown = [&] {  // seldom: pictures keep the server busy, and so the board
            pause(1.0);
            return run.hand.pixels(window);
        };
        CHECK(eventually([&] { return shown() != asks; }));
        CHECK(run.title() == "palpate: break");
        // A motor that becomes stronger is found in the next one.
        run.press_up_to("question");
        board.bring("0,89.3");
        board.bring(fmt::format("turned {}", 30 * 360.0 / 4880.0));  // its disc slips by 30 counts
        run.press_up_to("trouble");
        std::size_t heard = 0;
        const auto hears = [&](const Words& any) {
            CAPTURE(any);
            CHECK(eventually([&] {
                const std::string out = run.program().out();
                return std::ranges::any_of(any, [&](const std::string& what) {
                    return out.find(what, heard) != std::string::npos;
                });
            }));
            heard = run.program().out().size();
        };
        hears({"one of them slipped"});
        board.bring("old 20");  // right answers, in time, of where the handle was 20 ms ago
        board.bring("turned 0");
        hears({"are its answers old", "as where answers are old"});
        board.bring("gain 2");
        board.bring("old 0");
        board.bring("0,89.3");
        hears({"motor is too strong"});
        board.bring("gain 1");
        board.bring("motor 1 0.6");  // then a weaker one, of which alone
        hears({"too weak", "become weaker", "supply weak"});
        board.bring("motor 1 1");
        run.press_up_to("ready");
    } else {
        // It was silent, and has its counts: its plugs may be others, all the same.
        run.press_up_to("explore");
        const std::size_t from = run.program().out().size();
        board.signal(SIGSTOP);
        pause(0.15);
        board.signal(SIGCONT);
        const auto asks = [&](const char* what) {
            return eventually(
                [&] { return run.program().out().find(what, from) != std::string::npos; });
        };
        CHECK(asks("trouble: "));
        board.bring("0,89.3");
        CHECK(asks("Bring the handle to the second mark"));
    }
    const Finished end = ended(run.end(), 3);
    const std::string file = folder.file("d.sqlite");
    const Words proofs = lines_in(sql_lines(
        file, "SELECT key, value FROM event WHERE event_kind = 'provenance' ORDER BY event_id"));
    REQUIRE(proofs.size() >= 2);
    CHECK_THAT(proofs[0], StartsWith("start pose|") && Has("second mark met to "));
    CHECK_THAT(proofs[1], StartsWith("rig check|"));
    CHECK(count_of(proofs[1], " % at ") == 4);
    CHECK(sql_first(file, "SELECT value FROM session_provenance WHERE key = 'device watchdog'") ==
          (open ? "20 ms" : ""));
    if (!open) {  // in a break
        CHECK_THAT(proofs.at(2), StartsWith("start pose|"));
        CHECK(sql_first(file,
                        "SELECT count(*) >= 1 FROM event WHERE key = 'rig check' AND value = "
                        "'refused' AND text LIKE '%one of them slipped%Doubtful: the last 1 "
                        "attempt, %' AND count = 1") == "1");
    }
    const bool warned = (end.out + end.error).find("no watchdog of its own") != std::string::npos;
    CHECK(warned != open);
    ran({"verify", folder.file("d.sqlite")});
}

TEST_CASE("weak pulses of a break end by Escape at the window, and prove nothing",
          "[haply][window][safety]") {
    const TemporaryFolder folder;
    FreeBoard board(folder);
    const std::string rig = commissioned_rig(folder, board.word());
    OpenedSession run(folder, board, real_words(folder, board, rig));
    run.wait_for("welcome");
    run.press_up_to("question");
    board.bring("0,89.3");
    run.press_up_to("break");
    CHECK(eventually([&] { return board.motors() != "0, 0"; }));
    run.hand.key("Escape");
    run.wait_for("trouble");
    CHECK(board.motors() == "0, 0");
    pause(3.0);  // longer than four pulses
    CHECK(board.motors() == "0, 0");
    CHECK(sql_lines(folder.file("d.sqlite"),
                    "SELECT sum(event_kind = 'stop' AND value = 'Escape'), sum(key IS 'rig check' "
                    "AND value != 'refused') FROM event WHERE event_id > (SELECT max(event_id) "
                    "FROM event WHERE event_kind = 'break')") == "1|0\n");
    CHECK(run.end().code == 3);
}

TEST_CASE("an opening whose board stalled says so, and blames no motor and no operator",
          "[haply]") {
    const TemporaryFolder folder;
    FreeBoard board(folder);
    const std::string rig = commissioned_rig(folder, board.word());
    /// @param brings  the operator does what is asked   @param stalls  the board, during a pulse
    const auto opened = [&](bool brings, bool stalls) {
        static int number = 0;
        board.bring("0,89.3");
        TypedTo run(folder, fmt::format("opening{}", ++number), real_words(folder, board, rig),
                    {"SDL_VIDEODRIVER=dummy"});
        static_cast<void>(run.says("Type yes:"));
        run.type("yes");
        if (run.says("Bring the handle to") && brings) {
            board.bring(last_place(run.program().out()));
        }
        run.type("");
        if (stalls) {
            CHECK(eventually([&] { return board.motors() != "0, 0" || !run.program().running(); }));
            board.signal(SIGSTOP);
            pause(0.15);
            board.signal(SIGCONT);
            static_cast<void>(run.says("If it ends early"));  // it stalled between pulses
            run.program().signal(SIGINT);
        }
        return run.program().wait().error;
    };
    std::string said;
    for (int i = 0; i < 8 && (i == 0 || starved(said)); ++i) {
        said = opened(false, false);
    }
    CHECK_THAT(said, Has("the encoders say that the handle is still at home, (0, 89.3) mm"));
    bool silent = false;
    for (int i = 0; i < 12 && !silent; ++i) {
        said = opened(true, true);
        CHECK_THAT(said, !Has("times what it did"));
        silent = said.find("the device stopped answering") != std::string::npos;
    }
    CHECK(silent);
}

TEST_CASE(
    "after a replug nothing is felt before home, second mark and pulses, and the experimenter's "
    "chord",
    "[haply][window]") {
    const TemporaryFolder folder;
    auto board = std::make_unique<FreeBoard>(folder);
    const std::string rig = commissioned_rig(folder, board->word());
    OpenedSession run(folder, *board, real_words(folder, *board, rig));
    auto said = [&, from = std::size_t{0}](const std::string& what) mutable {
        CAPTURE(what);
        CHECK(
            eventually([&] { return run.program().out().find(what, from) != std::string::npos; }));
        from = run.program().out().find(what, from) + what.size();
    };
    run.press_up_to("explore");
    const std::string out = run.program().out();
    const std::string mark = last_place(out.substr(out.rfind("Bring the handle to")));
    const auto replug = [&](const std::string& words) {
        unplug(folder, board);
        board = std::make_unique<FreeBoard>(folder, words);
    };
    replug("--at=12,89.3");  // another board, beside home
    said("trouble: ");
    board->bring("motor 1 -1");
    said("Bring the handle to the second mark ");
    board->bring(mark);
    said("neither home nor the second mark ");
    board->bring("0,89.3");
    said("Bring the handle to the second mark ");
    board->bring(mark);
    said("a motor or an encoder is reversed");
    board->bring("gain 2.5");
    said("a motor is too strong");
    CHECK(run.title() == "palpate: trouble");
    board->bring("gain 1");
    said("bring the handle home");  // who mends a motor may move an encoder
    board->bring("0,89.3");
    const auto goes_on = [&] {
        said("can go on: Ctrl+Shift+P");
        run.hand.focus(run.hand.find_window("palpate: "));
        run.hand.key("space");  // the participant's alone
        pause(0.5);
        CHECK(run.title() == "palpate: trouble");
        run.hand.chord("p");
        run.press_up_to("ready");
    };
    goes_on();

    // The same in a break, where nothing is felt and no fault is seen.
    run.press_up_to("break");
    replug("--at=0,89.3");
    run.press_up_to("trouble");
    said("Bring the handle to the second mark ");
    board->bring(mark);
    goes_on();

    // And while a trial waits to begin.
    replug("--at=0,89.3");
    said("Bring the handle to the second mark ");
    board->bring(mark);
    goes_on();
    CHECK(run.end().code == 3);
    const std::string course = sql_first(
        folder.file("d.sqlite"),
        "SELECT group_concat(word, '; ') FROM (SELECT coalesce(key, event_kind) || CASE WHEN value "
        "LIKE 'refused%' THEN ' refused' WHEN event_kind = "
        "'provenance' THEN '' ELSE ' ' || replace(coalesce(value, ''), 'device_silent', "
        "'device_lost') END AS word FROM event WHERE "
        "event_kind "
        "IN ('fault', 'reconnect', 'go on') OR key IN ('start pose', 'rig check') ORDER BY "
        "event_id)");
    CHECK_THAT(course,
               StartsWith("start pose; rig check; fault device_lost; ") &&
                   Has("reconnect anew; start pose; rig check refused; rig check; start pose; rig "
                       "check; go on "
                       "device_lost; ",
                       "reconnect anew; start pose; rig check; go on rig check; ") &&
                   EndsWith("fault device_lost; reconnect anew; start pose; rig check; "
                            "go on device_lost"));
    ran({"verify", folder.file("d.sqlite")});
}

TEST_CASE("a session is felt on the calibration that was checked, whatever its file becomes then",
          "[open][window]") {
    const TemporaryFolder folder;
    FreeBoard board(folder, "--open");
    const std::string rig = commissioned_rig(folder, board.word());
    const std::string other = protocols::to_toml(protocols::load_calibration("2diy_gen3"));
    const auto checked = protocols::calibration_id(protocols::load_calibration(rig));
    OpenedSession run(folder, board, real_words(folder, board, rig), "0,89.3", rig, other);
    CHECK_THAT(run.program().out(), Has(": REAL, "));
    CHECK(slurp(rig) == other);
    run.press_up_to("question");
    CHECK(run.end().code == 3);
    CHECK(sql_lines(folder.file("d.sqlite"),
                    "SELECT value, (SELECT max(calibration_sha256) FROM trial) FROM "
                    "session_provenance WHERE key = 'calibration sha256'") ==
          checked + "|" + checked + "\n");
    ran({"verify", folder.file("d.sqlite")});
}

TEST_CASE("who is noted as not consenting is never run, and no device is touched") {
    const TemporaryFolder folder;
    const std::string device = "haply:" + folder.file("none");
    const std::string rig = commissioned_rig(folder, device);
    const std::string file = folder.file("d.sqlite");
    ran({"participant", file, "P1", "--new", "--consent", "no"});
    const auto run = [&](const std::string& name) {
        TypedTo program(folder, name,
                        ran_words(folder, device) + " --kind real --handle-free" +
                            " --calibration '" + rig + "'",
                        {"SDL_VIDEODRIVER=dummy"});
        return program.program().wait();
    };
    check_end(run("refused"), 2, Has("P1 is noted as not consenting", "P1 --consent yes"));
    ran({"participant", file, "P1", "--consent", "yes"});
    CHECK_THAT(run("asked").error,
               !Has("not consenting") && Has(folder.file("none")));  // the device is next
}

TEST_CASE("what is noted or run while the rig's questions wait is asked for as the session begins",
          "[haply]") {
    // Before the rig's questions, which wait without limit, and again as the session begins.
    EACH(one, from_range(test_rows("meanwhile.tsv")));
    const std::string& before = one.at(1);
    const std::string& does = one.at(2);
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    FreeBoard board(folder);
    const std::string words = real_words(folder, board, commissioned_rig(folder, board.word()));
    const std::string study = slurp(folder.file("p.toml"));
    write(folder.file("p.toml"),
          replaced(study, "participants = 1", "participants = 1\nhandedness = \"right\""));
    Finished end;
    for (int tries = 0; tries < 8 && (tries == 0 || starved(end.error)); ++tries) {
        for (const char* more : {"", "-wal", "-shm"}) {
            std::filesystem::remove(file + more);
        }
        if (does.empty()) {
            write(folder.file("other.toml"),
                  replaced(study, "stiffness_n_per_m = 200", "stiffness_n_per_m = 250"));
            ran({"simulate", folder.file("other.toml"), "--participants", "1", "--db", file});
        }
        if (!before.empty()) {
            ran(joined({"participant"}, words_of(file, before)));
        }
        board.bring("0,89.3");
        TypedTo run(folder, fmt::format("run{}", tries), words, {"SDL_VIDEODRIVER=dummy"});
        REQUIRE(run.program().says("Type yes:"));
        if (does.empty()) {
            sql_edit(file, "UPDATE session SET session_kind = 'real'");
        } else {
            ran(joined({"participant"}, words_of(file, does)));
        }
        operate(run, board, "If it ends early");
        run.program().signal(SIGTERM);
        end = run.program().wait();
    }
    CAPTURE(end.out);
    check_end(end, 2, Has(one.at(3)));
    CHECK(sql_first(file,
                    "SELECT count(*) FROM session JOIN participant USING (participant_id) WHERE "
                    "participant_code = 'P1'") == "0");
}
