#include "engine/base/clock.hpp"
#include "tests/support/pressed_desk.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

// What whoever runs a session meets: which sessions are real, what a press may do, and what the
// terminal says.

namespace {

constexpr double kGuard = 0.75;  // s, of the studies below

/// Two trials at a window: two objects without friction, answers to be confirmed.
std::string two_trials() {
    std::string text = four_trials();
    const std::size_t on = text.find("[[friction]]\nname = \"on\"");
    text.erase(on, text.find("[design]") - on);
    text = replaced(text, "gap_s = 0.1", "gap_s = 0.1\nguard_s = 0.75");
    return text + "\n[response]\nconfidence = true\nconfirm = true\n";
}

/// Does `act` until the window looks otherwise: what comes within the guard time changes nothing.
template <class Act>
void until_marked(WindowSession& session, const Act& act) {
    const auto window = session.wait_for_screen(session.screen_name());
    pause(0.1);
    const std::uint64_t before = session.hand().pixels(window);
    for (int tries = 0; tries < 12; ++tries) {
        act();
        for (int waited = 0; waited < 30; ++waited) {
            pause(0.05);
            if (session.hand().pixels(window) != before) {
                return;
            }
        }
    }
    FAIL("nothing was marked");
}

/// Somebody who presses what helps, whatever the screen shows, until the program ends.
void carry_on(Process& program, XHand& hand) {
    std::uint64_t focused = 0;
    for (int i = 0; i < 600 && program.running(); ++i) {
        const auto window = hand.find_window("palpate: ");
        if (window.id != 0 && window.id != focused) {
            focused = hand.wait_for_window("palpate: ", WindowSession::kPatience).id;
        }
        const bool asked =
            window.title.ends_with("question") || window.title.ends_with("confidence");
        if (window.id != 0) {
            hand.key(asked ? "1" : "space");
        }
        pause(0.2);
    }
}

}  // namespace

TEST_CASE(
    "a session on the pointer is a pilot, answers wait for the guard time and to be confirmed",
    "[long][window]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("it's study.sqlite");
    const std::string protocol = folder.file("p.toml");
    std::ofstream(protocol) << two_trials();
    WindowSession session(run_words(protocol, "P1", file, {"--device", "mouse"}));
    XHand& hand = session.hand();
    session.go_through({"welcome", "ready", "explore"});

    session.wait_for_screen("question");
    until_marked(session, [&] { hand.key("1"); });
    until_marked(session, [&] { hand.key("2"); });
    until_marked(session, [&] { hand.key("Left"); });
    CHECK(session.screen_name() == "question");
    CHECK(session.ask("SELECT count(*) FROM response") == "0");
    session.press_at("question", "Return");
    session.wait_for_screen("confidence");
    until_marked(session, [&] { hand.key("3"); });
    until_marked(session, [&] { hand.key("4"); });
    hand.press("Return");  // it is held on: the next screen begins nothing
    session.wait_for_screen("ready");
    pause(kGuard + 1.0);
    CHECK(session.screen_name() == "ready");
    CHECK(session.ask("SELECT count(*) FROM trial") == "1");
    hand.release("Return");
    session.go_through({"ready", "explore"});
    session.press_at("question",
                     "1");  // again and again: the first that is no longer early, and one more
    session.wait_for_screen("confidence");
    hand.chord("q");
    session.press_at("confidence", "y");
    const Finished end = ended(session.finish(), 3);

    check_truths(file, "confirmed_truths.tsv");
    CHECK_THAT(end.error, Has("--device mouse gives no force", "recorded as pilot"));
    CHECK_THAT(sql_lines(file, "SELECT protocol_toml FROM study"),
               Has("guard_s = 0.75\n", "confirm = true\n"));

    CHECK_THAT(end.out, Has("Ctrl+Shift+Q then Y", "Ctrl+Shift+M then Y", "Ctrl+Shift+P", file,
                            "trial 1 of 2 ", "This run: 1 answered, 0 of them do not count",
                            "Stopped before trial 2 of 2"));
    CHECK_THAT(end.out, !Has("convex") && !Has("concave"));
    const Words goes_on = between(end.out, "goes on there: ", "\n");
    REQUIRE_FALSE(goes_on.empty());
    Process again({"sh", "-c", "exec " + goes_on.back()}, shown_on(session.screen().display()));
    carry_on(again, hand);
    const Finished rest = ended(again.wait());
    CHECK_THAT(rest.out, Has("Resuming at trial 2 of 2", "trial 2 of 2      attempt 2  ",
                             "none left", "Finished."));
    CHECK(sql_row(file,
                  "SELECT min(reaction_s) >= 0.75, min(confidence_reaction_s) >= 0.75, "
                  "sum(early_presses) > 0, sum(changes) >= 2, (SELECT sum(early_presses) > 0 FROM "
                  "analysis_trial WHERE counts) FROM response") == "1,1,1,1,1");
    CHECK_THAT(palpate_command({"verify", file}).out, Has("Nothing differs."));
}

TEST_CASE("a real session on a device without force is refused unless the protocol asks for it",
          "[window]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    std::ofstream(folder.file("any.toml")) << two_trials();
    std::ofstream(folder.file("mouse.toml"))
        << replaced(two_trials(), "[apparatus]\n", "[apparatus]\ndevice = \"mouse\"\n");
    const auto words = [&](const std::string& protocol, const std::string& who) {
        return run_words(folder.file(protocol), who, file, {"--device", "mouse"});
    };
    const auto used = [&] {
        const Finished plan = palpate_command(
            {"sequence", folder.file("mouse.toml"), "--participant", "P2", "--db", file});
        CAPTURE(plan.out, plan.error);
        REQUIRE_THAT(plan.out, Has("used so far: "));
        return behind(plan.out, "used so far: ").substr(0, 3);
    };
    WindowSession session(words("mouse.toml", "P1"));
    {
        const Words refused = joined(command_of(words("any.toml", "P1")), {"--kind", "real"});
        check_end(Process(refused, shown_on(session.screen().display())).wait(), 2,
                  Has("gives no force", "device = \"mouse\"", "--kind pilot"));
    }
    // Whoever is at the welcome screen has taken a row of the pictures; whoever left there has not.
    session.wait_for_screen("welcome");
    session.wait_until("SELECT count(*) FROM session WHERE session_kind = 'real'", "1");
    const std::string taken = used();
    CHECK((taken == "0 1" || taken == "1 0"));
    session.program().signal(SIGTERM);
    const Finished end = ended(session.finish(), 3);
    CHECK(used() == "0 0");
    CHECK_THAT(end.out, Has("four_trials: REAL, participant P1, session 1, 2 trials",
                            "This run: 0 answered", "Stopped before trial 1 of 2"));
    CHECK_THAT(end.error, Has(" P1 --consent yes notes it"));  // as the session has them by now
    ran({"participant", file, "P1", "--consent", "yes"});
    CHECK(sql_lines(file, "SELECT count(*) FROM trial") == "0\n");
}

TEST_CASE(
    "practice is counted by itself, repeats never make a number jump, and three are an alarm") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    write(folder.file("p.toml"),
          edited(four_trials(), {{"practice_repetitions = 0", "practice_repetitions = 1"},
                                 {"contact_min_s = 0", "contact_min_s = 1000\nmax_requeues = 1"}}));
    const Finished end = ran(run_words(folder.file("p.toml"), "P1", file, {"--headless"}));
    Words numbers;
    std::size_t repeats = 0;
    std::size_t alarms = 0;
    for (const std::string& line : lines_in(end.out)) {
        if (line.starts_with("#")) {
            const std::string number = line.substr(line.find_first_of("pt"));
            numbers.push_back(number.substr(0, number.find("  ")));
            repeats += line.find("  attempt 2  ") != std::string::npos ? 1U : 0U;
        }
        alarms += line.starts_with("ATTENTION: ") ? 1U : 0U;
    }
    // Four of each are set back once; as many as are done by then are counted.
    REQUIRE(numbers.size() == 16);
    CHECK(numbers.front() == "practice 1 of 4");
    CHECK(numbers[7] == "practice 4 of 4");
    CHECK(numbers[8] == "trial 1 of 4");
    CHECK(numbers.back() == "trial 4 of 4");
    CHECK(std::is_sorted(numbers.begin(), numbers.end()));
    CHECK(repeats == 8);
    CHECK(alarms == 14);  // from the third on
    CHECK_THAT(end.out, Has("4 practice trials and 4 trials",
                            "ATTENTION: 3 of the last 3 trials do not count.\n"
                            "    3 x too little contact: explain again",
                            "ATTENTION: 6 of the last 6", "runs again later in its block  (8 left",
                            "is not run again  (none left)",
                            "This run: 16 answered, 16 of them do not count"));
}

TEST_CASE(
    "a session of two intervals and a rule, stopped and resumed, says its numbers and what it came "
    "to") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    write(folder.file("p.toml"),
          all_replaced(slurp(PALPATE_SOURCE_DIR "/protocols/library/friction_threshold.toml"),
                       "\ntrials = 40", "\ntrials = 8"));
    const Words words = run_words(folder.file("p.toml"), "P1", file, {"--headless", "--speed"});
    Process program(joined(command_of(words), {"40"}), kNoDisplay);
    CHECK(program.says("practice 2 of "));
    program.signal(SIGINT);
    CHECK_THAT(ended(program.wait(), 3).out, Has("Stopped before practice "));
    const Words redo = joined(words, {"0", "--resume", "redo-block"});
    CHECK_THAT(ran(redo).out, Has("Resuming at practice 1 of ", " trial 1 of ", "  attempt 2  ") &&
                                  !Has("--resume redo-block"));
}

TEST_CASE("one trial that takes long leaves alone how many minutes the terminal foretells",
          "[window]") {
    std::int64_t before = monotonic_ns();
    PointerSession session(edited(four_trials(), {{"repetitions = 1", "repetitions = 100"},
                                                  {"explore_min_s = 0.5", "explore_min_s = 0.1"}}));
    session.press_at("welcome", "space");
    std::vector<double> took;  // min
    for (int trial = 1; trial <= 5; ++trial) {
        session.go_through({"ready", "explore"});
        session.wait_for_screen("question");
        pause(trial == 2 ? 5.0 : 0.0);
        session.press_at("question", "1");
        session.wait_for_text(fmt::format("({} left", 400 - trial));
        const std::int64_t now = monotonic_ns();
        took.push_back(static_cast<double>(now - before) * 1e-9 / 60.0);
        before = now;
    }
    const std::string said = "(395 left, about ";
    REQUIRE_THAT(session.program().out(), Has(said));
    const double minutes = std::stod(behind(session.program().out(), said));
    const auto [shortest, longest] = std::minmax_element(took.begin() + 2, took.end());
    CAPTURE(took, minutes);
    CHECK(minutes <= 395.0 * *longest + 1.5);  // the third of five is between these three
    CHECK(minutes >= 395.0 * *shortest - 1.5);
    CHECK(session.program().ended_by(SIGTERM) == 3);
}

TEST_CASE("a person's line says the times of the file, and nothing that tells shape or friction",
          "[window][haply]") {
    PressedDesk desk(PressingHand::Does::presses);
    WindowSession& session = *desk.session;
    const auto answered = [&] {
        return session.ask("SELECT count(*) FROM response") == "1";
    };
    for (int tries = 0; tries < 20 && !answered(); ++tries) {  // a busy machine's faults
        REQUIRE(desk.feel());
        pause(0.6);
        session.hand().key("Return");
        eventually([&] { return session.screen_name() != "explore"; });
        session.hand().release("space");
        if (session.screen_name() == "question") {
            session.press_at("question", "1");
            eventually(answered);
        }
    }
    REQUIRE(answered());
    session.wait_for_text("answered in");
    CHECK(session.ask(
              "SELECT max_normal_force_n > 0.1 FROM trial JOIN response USING (trial_id)") == "1");
    CHECK_THAT(answered_line(session.program().out()),
               Has(session.ask("SELECT printf('  felt %.1f s, answered in %.1f s  ', done_s, "
                               "reaction_s) FROM trial JOIN response USING (trial_id)")) &&
                   !Has("in contact") && !Has(" N ") && !Has("touched"));
}
