#include "engine/base/clock.hpp"
#include "tests/support/pressed_desk.hpp"
#include "tests/support/program.hpp"

// What may go wrong around a person at the desk while a force is on, done to the program itself: a
// real window, a board on a pseudo-terminal with a hand on it, and the torques that the board gets.
// Nothing is asserted about time but that a force goes off within seconds that used to stay for
// ever.

namespace {

double locked_mb(pid_t process) {
    const std::string status = slurp("/proc/" + std::to_string(process) + "/status");
    const std::string locked = behind(status, "VmLck:");
    return locked.empty() ? -1.0 : std::stod(locked) / 1024.0;
}

}  // namespace

TEST_CASE("a screen that stands still ends the force, which a live one with the key held does not",
          "[window][haply][safety]") {
    std::optional<PressedDesk> lasting;
    // A machine that is too busy to draw for so long has a screen that stands still: then once
    // more.
    CHECK(tried(3, [&] {
        lasting.emplace(PressingHand::Does::presses);
        REQUIRE(lasting->feel());
        wait_a_little(600);
        return lasting->faults("screen_silent") == "0" && lasting->faults("let_go") == "0";
    }));
    PressedDesk& desk = *lasting;
    REQUIRE(desk.feel());
    const std::int64_t frozen = monotonic_ns();
    desk.session->screen().server().signal(SIGSTOP);
    CHECK(desk.force_ends());
    const double after = 1e-9 * static_cast<double>(desk.board.motors().since_ns - frozen);
    CAPTURE(after);
    CHECK(after < 5.0);  // 0.27 s on a quiet machine
    CHECK(desk.stays_off());
    CHECK(desk.waits_for_fault("screen_silent"));
    desk.session->screen().server().signal(SIGCONT);
    desk.session->wait_for_screen("trouble");
    REQUIRE(desk.feel());
    desk.session->screen().server().signal(SIGKILL);
    CHECK(desk.force_ends());
    CHECK(desk.stays_off());
    CHECK(desk.session->finish().code == 1);
}

TEST_CASE("a board that is kept from answering for 20 ms takes the force away, and ends no trial",
          "[window][haply][safety]") {
    PressedDesk desk(PressingHand::Does::presses);
    // Ticks of a contact without a force or a fault, and with a force again 0.1 s later in the same
    // trial.
    const auto gaps = [&] {
        const Finished finished = palpate_command(
            {"sql", desk.file, "--csv", "-c",
             "SELECT count(*) FROM sample AS gap WHERE gap.flags & 136 = 128 AND "
             "gap.rendered_normal_n > 0.1 AND gap.commanded_x_n = 0 AND gap.commanded_y_n = 0 AND "
             "EXISTS (SELECT 1 FROM sample AS then_ WHERE then_.trial_id = gap.trial_id AND "
             "then_.tick > gap.tick + 100 AND then_.commanded_y_n <> 0)"});
        return finished.code == 0 && finished.out.find("\n0") == std::string::npos;
    };
    CHECK(tried(12, [&] {  // a busy machine may stop it for longer
        REQUIRE(desk.feel());
        pause(0.3);
        kill(desk.board.id(), SIGSTOP);
        pause(0.020);
        kill(desk.board.id(), SIGCONT);
        pause(0.5);
        return gaps();
    }));
    // Nobody proved this rig: a pilot on it gives 0.3 N at most, as wide as a stored step, whatever
    // is rendered (a hand that rests against such a force has 0.37 N rendered).
    const auto reads = [&](const std::string& what) {
        return sql_csv(desk.file, "SELECT " + what +
                                      " FROM (SELECT max(rendered_normal_n) AS "
                                      "asked, max(commanded_x_n * commanded_x_n + commanded_y_n * "
                                      "commanded_y_n) AS given FROM sample)")
            .ends_with("\n1\n");
    };
    for (int attempt = 0; attempt < 12 && !reads("asked > 0.33 AND given > 0.08"); ++attempt) {
        REQUIRE(desk.feel());  // a busy machine may have ended each before the hand pressed so far
        pause(0.5);
    }
    CHECK(reads("asked > 0.33 AND given BETWEEN 0.08 AND 0.0902"));
}

TEST_CASE("a contact that buzzes or a handle that runs away ends the force, with its cause",
          "[window][haply][safety]") {
    const bool buzzes = GENERATE(true, false);
    // A machine too busy for the emulated board's motion, as under sanitizers, gets another hand.
    CHECK(tried(4, [&] {
        PressedDesk desk(buzzes ? PressingHand::Does::buzzes : PressingHand::Does::runs_away);
        REQUIRE(desk.feel());
        const bool seen = desk.faults_of(buzzes ? "buzz" : "runaway");
        CHECK((!seen || desk.force_ends()));
        CHECK((!seen || desk.stays_off()));
        return seen;
    }));
}

TEST_CASE(
    "however a session's program ends under a force, the guard ends the force, and it stays off",
    "[window][haply]") {
    PressedDesk desk(PressingHand::Does::presses);
    REQUIRE(desk.feel());
    desk.session->program().signal(GENERATE(SIGHUP, SIGQUIT, SIGSEGV, SIGABRT));
    CHECK(desk.force_ends());
    CHECK(desk.stays_off());
}

TEST_CASE(
    "in its window the program's guard ends the force when it dies, and it when its guard does",
    "[window][haply]") {
    const TemporaryFolder path;  // a system that can be asked to stay awake
    const std::string asked = path.file("asked");
    const std::string tool = path.file("systemd-inhibit");
    std::ofstream(tool) << "#!/bin/sh\necho \"$1 $4\" >> " << asked
                        << "\nshift 4\n\"$@\"\necho over >> " << asked << "\n";
    std::filesystem::permissions(tool, std::filesystem::perms::owner_all);
    PressedDesk desk(PressingHand::Does::presses,
                     {"PATH=" + path.path().string() + ":" + std::getenv("PATH")});
    CHECK(desk.session->ask("SELECT value FROM session_provenance WHERE key = 'sleep'") ==
          "held off (systemd-inhibit)");
    CHECK_THAT(desk.session->program().error(), Has("has no watchdog of its own"));
    REQUIRE(desk.feel());
    const bool spared = desk.session->ask(
                            "SELECT value LIKE 'spared%' FROM session_provenance WHERE key = "
                            "'realtime out of memory'") == "1";
    for (const pid_t process : {desk.session->program().id(), desk.guard()}) {
        const std::string score = slurp("/proc/" + std::to_string(process) + "/oom_score_adj");
        CHECK((score == "-1000\n") == spared);
    }
    CHECK(locked_mb(desk.session->program().id()) < 200.0);  // 707 when all of it was
    kill(desk.guard(), SIGKILL);
    CHECK(desk.force_ends());
    {
        const bool lost = desk.waits_for_fault("device_lost");
        CAPTURE(desk.session->ask("SELECT group_concat(fault_cause) FROM trial"),
                desk.session->screen_name(), desk.session->program().error());
        CHECK(lost);
    }
    desk.session->hand().release("space");
    desk.goes_on();
    REQUIRE(desk.feel());
    const std::int64_t killed = monotonic_ns();
    desk.session->program().signal(SIGKILL);
    CHECK(desk.force_ends());
    const double after = 1e-9 * static_cast<double>(desk.board.motors().since_ns - killed);
    CAPTURE(after);
    CHECK(after < 2.0);  // 2 ms on a quiet machine
    CHECK(desk.stays_off());
    CHECK(eventually([&] {
        return slurp(asked) == "--what=sleep:idle:handle-lid-switch --mode=block\nover\n";
    }));
}

TEST_CASE("who lets go of the key goes on by it, and the terminal says that no chord is needed",
          "[window][haply][safety]") {
    CHECK(tried(4, [&] {  // a busy machine may end the force for another reason
        PressedDesk desk(PressingHand::Does::presses);
        REQUIRE(desk.feel());
        desk.session->hand().release("space");
        wait_a_little(60);
        desk.session->hand().press("space");  // who grabs it again has let go
        CHECK(desk.force_ends());
        const bool seen = desk.waits_for_fault("let_go");
        if (seen) {
            desk.session->wait_for_screen("trouble");
            CHECK(desk.stays_off());
            desk.session->hand().release("space");
            desk.session->wait_for_text("the session can go on: the participant presses Space");
            desk.session->press_at("trouble", "space");
            CHECK(desk.feel());
        }
        return seen;
    }));
}
