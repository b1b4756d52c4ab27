#include "tests/support/free_board.hpp"
#include "tests/support/json_of.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"
#include "tests/support/stop_ways.hpp"

namespace {

Words words(const std::string& file, const std::string& device, Words more = {}) {
    return joined(run_words("shape_friction_demo", "P1", file, {"--headless", "--device", device}),
                  more);
}

/// On a board that was commissioned, with more words: refused before anybody looks for its home, or
/// a pulse is given. @return the sentence
std::string refused_at_a_board(const TemporaryFolder& folder,
                               const std::string& file,
                               const Words& more) {
    const TemporaryFolder rig;
    FreeBoard board(rig);
    Words command =
        joined(command_of(words(file, board.word(), more)),
               {"--handle-free", "--calibration", commissioned_rig(folder, board.word())});
    std::erase(command, "--headless");
    Process program(command, {"SDL_VIDEODRIVER=dummy"});
    bool still = true;
    while (program.running()) {
        still = still && board.motors() == "0, 0";
    }
    const Finished end = program.wait();
    CAPTURE(end.out, end.error);
    CHECK(still);
    CHECK(end.code != 0);
    CHECK(end.out.empty());  // not even the word that nobody holds the handle is noted
    return end.error;
}

/// With what was typed at its terminal beforehand.
Finished typed(const Words& words, const char* keys) {
    const Terminal terminal;
    terminal.type(keys);
    return Process(command_of(words),
                   {std::string(kTerminal) + "=" + terminal.name(), "DISPLAY", "WAYLAND_DISPLAY"})
        .wait();
}

/// A session on a device that is broken off after its first answer.
void break_off(const std::string& file, const std::string& device) {
    Process process(command_of(words(file, device, {"--speed", "10"})), kNoDisplay);
    CHECK(eventually([&] {
        return !process.running() || sql_now(file, "SELECT count(*) > 0 FROM response") == "1";
    }));
    CHECK(process.ended_by(SIGINT) == 3);
}

}  // namespace

TEST_CASE(
    "each trial has its own device: another one is meant or refused, kept, said and verified") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    break_off(file, "sim");
    const std::string before = sql_first(file, "SELECT count(*) FROM trial");
    const std::string events = sql_first(file, "SELECT count(*) FROM event");

    // By accident: refused by name, and nothing is written.
    CHECK_THAT(ran(words(file, "haply-emulator"), 2).error,
               Has("session 1 of P1", "was felt on simulated pantograph", "would go on with",
                   "--other-device"));
    CHECK(sql_first(file, "SELECT count(*) FROM trial") == before);
    CHECK(sql_first(file, "SELECT count(*) FROM event") == events);

    // With a rig at hand, too, before it is opened; and so is all else that does not go on.
    CHECK_THAT(refused_at_a_board(folder, file, {}),
               Has("would go on with Haply 2diy_gen3 at ", "--other-device"));
    CHECK_THAT(refused_at_a_board(folder, file, {"--seed", "7", "--other-device"}),
               Has("was begun with another plan"));
    CHECK(sql_first(file, "SELECT count(*) FROM event") == events);

    // Another calibration is another rig; this one is meant. The next resumption knows the last,
    // not the first.
    const Words another = words(file, "sim", {"--calibration", "haplet"});
    ran(another, 2);
    const auto wrong = ended(typed(another, "P2\n"), 1);  // at a terminal it is asked for
    CHECK_THAT(wrong.out, Has("type the participant's code"));
    CHECK_THAT(wrong.error, Has("the session goes on with its own device"));
    CHECK(sql_first(file, "SELECT count(*) FROM event") == events);
    ended(typed(another, "P1\n"));
    CHECK(sql_first(file, "SELECT count(DISTINCT calibration_sha256) FROM analysis_trial") == "2");
    CHECK(sql_first(file,
                    "SELECT count(*) FROM trial JOIN session_provenance AS made ON made.value = "
                    "calibration_sha256 AND key = 'calibration sha256'") == before);
    CHECK(sql_first(file,
                    "SELECT count(*) FROM trial JOIN event ON event.value = calibration_sha256 "
                    "AND key = 'calibration sha256' AND trials_begun < trial.trial_id") ==
          sql_first(file, "SELECT count(*) - " + before + " FROM trial"));
    ran({"verify", file});

    CHECK_THAT(palpate_command({"summary", file}).out,
               Has("felt on more than one device or calibration"));
    const Json devices = json_of({"summary", file})["studies"][0]["devices"];
    REQUIRE(devices.size() == 2);
    CHECK(devices.at(0).at("attempts").dump() == before);
    ran({"report", file, "--kind", "simulated", "--simulations", "0", "-o", folder.file("r.html")});
    CHECK_THAT(slurp(folder.file("r.html")), Has("sessions felt on more than one device"));

    // Who says otherwise of one trial is found out, the seal left aside.
    sql_edit(file,
             "UPDATE trial SET device = 'mouse', calibration_sha256 = NULL WHERE trial_id = 1");
    const Finished found = ran({"verify", file}, 1);
    CHECK_THAT(found.out + found.error, Has("trial.device", "trial.calibration_sha256"));
}
