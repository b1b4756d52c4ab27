#include "tests/support/catch.hpp"
#include "tests/support/test_text.hpp"
#include "tests/support/window_session.hpp"

namespace {

/// Places on a keyboard: evdev's number and 8.
constexpr const char* kDigit2 = "#11";
constexpr const char* kLetterP = "#33";
constexpr const char* kLetterQ = "#24";
constexpr const char* kLetterY = "#29";
constexpr const char* kLetterZ = "#52";

}  // namespace

// The Czech layout has letters where others have digits and changes Y with Z, the Russian one has
// no Latin letter at all, the Greek one neither, and a sign at the place of Q.
TEST_CASE("answers and the experimenter's chords are heard on every keyboard layout", "[window]") {
    const char* layout = GENERATE("cz", "ru", "gr");
    CAPTURE(layout);
    PointerSession session;
    session.wait_for_screen("welcome");
    REQUIRE(Process({"setxkbmap", "-display", session.screen().display(), layout}).wait().code ==
            0);
    session.go_through({"welcome", "ready", "explore"});
    session.press_at("question", kDigit2);
    session.wait_until("SELECT chosen_place FROM response", "1");
    session.wait_for_screen("ready");
    session.hand().chord(kLetterP);
    session.wait_for_screen("pause");
    session.hand().chord(kLetterP);
    session.wait_for_screen("ready");
    session.hand().chord(kLetterQ);
    // Where there are Latin letters the one that the key shows is what counts.
    session.hand().key(std::string(layout) == "cz" ? kLetterZ : kLetterY);
    CHECK(session.finish().code == 3);
    CHECK(session.ask("SELECT count(*) FROM event WHERE event_kind = 'pause'") == "1");
}
