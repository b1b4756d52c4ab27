#include "data/store/database.hpp"
#include "tests/support/free_board.hpp"
#include "tests/support/program.hpp"

// What a session takes for its rig, by the shipped program in a window: not what a slipped encoder
// says.

namespace {

std::int64_t number(const TemporaryFolder& folder, const std::string& what) {
    data::Database database(folder.file("d.sqlite"), data::Access::read);
    return database.first("SELECT count(*) FROM " + what).integer(0);
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
