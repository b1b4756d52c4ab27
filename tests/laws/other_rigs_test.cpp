#include "data/store/database.hpp"
#include "tests/support/free_board.hpp"
#include "tests/support/program.hpp"
#include "tests/support/relay.hpp"

// What a session takes for its rig, by the shipped program in a window: not what a slipped encoder
// says, not what stands at the port in its board's place.

namespace {

std::int64_t number(const TemporaryFolder& folder, const std::string& what) {
    data::Database database(folder.file("d.sqlite"), data::Access::read);
    return database.first("SELECT count(*) FROM " + what).integer(0);
}

/// Pulled out; another may come in its place.
void unplug(const TemporaryFolder& folder, std::unique_ptr<FreeBoard>& board) {
    board.reset();
    std::filesystem::remove(folder.file("board"));
    std::filesystem::remove(folder.file("hand"));
}

}  // namespace

TEST_CASE("an encoder that jumps at Ready is a fault, and a hand that brings the handle is none",
          "[commission][haply][window][safety][law]") {
    const TemporaryFolder folder;
    FreeBoard board(folder);
    const std::string rig = commissioned_rig(folder, board.word());
    const Xvfb screen(1280, 800);
    XHand hand(screen.display());
    const auto typed = opened_session(folder, board, screen, real_words(folder, board, rig));
    TypedTo& run = *typed;
    INFO(run.program().error());
    press_up_to(hand, run, "ready");
    for (const char* place : {"30,70", "-30,60", "0,89.3"}) {
        board.bring(place);
    }
    CHECK(number(folder, "event WHERE event_kind = 'fault' AND value IN ('jump', 'over_speed')") ==
          0);
    board.bring(fmt::format("turned {}", 180 * 360.0 / 4880.0));
    board.bring("delay 0");  // of its answers, not of its discs
    hand.wait_for_window("palpate: trouble", WindowSession::kPatience);
    CHECK(run.program().says("the handle jumped"));
    CHECK(run.program().says("one of them slipped"));  // nothing goes on by itself
    board.bring("turned 0");
    press_up_to(hand, run, "ready");
    CHECK(number(folder, "trial") == 0);
    CHECK(number(folder,
                 "event AS jump WHERE event_kind = 'fault' AND value = 'jump' AND text "
                 "LIKE 'before the trial at position 0:%' AND 2 = (SELECT count(DISTINCT "
                 "key) FROM event WHERE event_id > jump.event_id AND key IN ('start pose', "
                 "'rig check') AND value NOT LIKE 'refused%')") == 1);
    end_session(hand, run);
    CHECK(run.program().wait().code == 3);
    ran({"verify", folder.file("d.sqlite")});
}

TEST_CASE("a board in an emulator's place, or an emulator in a board's, is not the session's rig",
          "[commission][haply][window][safety][law]") {
    const bool simulated = GENERATE(true, false);
    CAPTURE(simulated);
    const TemporaryFolder folder;
    const TemporaryFolder elsewhere;
    FreeBoard other(elsewhere);
    auto board = simulated ? std::make_unique<FreeBoard>(folder) : nullptr;
    auto relay = simulated ? nullptr
                           : std::make_unique<Relay>(folder.file("board"), elsewhere.file("board"));
    const std::string device = "haply:" + folder.file("board");
    const Xvfb screen(1280, 800);
    XHand hand(screen.display());
    const std::string record = commissioned_rig(folder, device);
    const auto typed = opened_session(
        folder, simulated ? *board : other, screen,
        ran_words(folder, device) + (simulated ? "" : " --calibration '" + record + "'"));
    TypedTo& run = *typed;
    INFO(run.program().error());
    press_up_to(hand, run, "ready");
    CHECK(number(folder, simulated ? "session WHERE session_kind = 'simulated'"
                                   : "session WHERE session_kind = 'real'") == 1);
    if (simulated) {
        unplug(folder, board);
        relay = std::make_unique<Relay>(folder.file("board"), elsewhere.file("board"));
        CHECK(run.program().says("is no longer palpate haply-emulator"));
    } else {
        relay.reset();
        board = std::make_unique<FreeBoard>(folder);
        CHECK(run.program().says("is now palpate haply-emulator, process "));
    }
    hand.chord("p");
    pause(1.0);
    CHECK(hand.find_window("palpate: ").title == "palpate: trouble");
    if (simulated) {  // what the session was begun with goes on
        relay.reset();
        board = std::make_unique<FreeBoard>(folder);
        CHECK(run.program().says("can go on"));
    }
    CHECK(number(folder, "trial") == 0);
    end_session(hand, run);
    CHECK(run.program().wait().code == 3);
}

TEST_CASE("another open board is not the one that was commissioned, and not the session's",
          "[commission][open][window][law]") {
    const TemporaryFolder folder;
    auto board = std::make_unique<FreeBoard>(folder, "--open");
    const std::string rig = commissioned_rig(folder, board->word());
    const std::string words = real_words(folder, *board, rig);
    {
        const Xvfb screen(1280, 800);
        XHand hand(screen.display());
        const auto typed = opened_session(folder, *board, screen, words);
        INFO(typed->program().error());
        press_up_to(hand, *typed, "question");
        end_session(hand, *typed);
        CHECK(typed->program().wait().code == 3);
    }
    REQUIRE(number(folder, "trial") > 0);
    engine::Calibration nine = protocols::load_calibration("2diy_gen3");
    nine.board->id = 9;
    write(folder.file("nine.toml"), protocols::to_toml(nine));
    unplug(folder, board);
    board =
        std::make_unique<FreeBoard>(folder, "--open --preset '" + folder.file("nine.toml") + "'");
    const Finished other = operated(folder, *board, words);
    check_end(other, 1,
              Has("was commissioned with the board with the id 0, and this is the board with the "
                  "id 9: plug that one in, or commission this one"));
    CHECK(count_of(other.out, "Bring the handle to") == 0);
    // Commissioned, it is still not what the session was felt on.
    static_cast<void>(commissioned_rig(folder, board->word(), "2diy_gen3", 9));
    const Finished goes_on = operated(folder, *board, words);
    check_end(goes_on, 2,
              Has(", the board with the id 0 so far, and would go on with ",
                  ", the board with the id 9; use the device it was felt on", "--other-device"));
    CHECK(count_of(goes_on.out, "Type yes:") == 0);
}
