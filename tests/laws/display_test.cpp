#include <sys/resource.h>

#include "ui/subject/answer_row.hpp"
#include "ui/subject/font.hpp"
#include "ui/subject/picking.hpp"
#include "tests/support/child.hpp"
#include "tests/support/program.hpp"
#include "tests/support/window_session.hpp"

using engine::Vec2;

// The display of a session: one that a person sees, all of it in a real session, and what remains
// when it dies.

namespace {

Words words(const TemporaryFolder& folder,
            const std::string& protocol = kFourTrials,
            const std::string& device = "mouse") {
    return run_words(protocol, "P1", folder.file("d.sqlite"), {"--device", device});
}

Finished without_display(const Words& arguments) {
    // Leaks of the desktop libraries that SDL tries are not ours to judge.
    return Process(command_of(arguments), {"DISPLAY=:999", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER",
                                           "ASAN_OPTIONS=detect_leaks=0"})
        .wait();
}

Vec2 size_of(const XHand::Window& window) {
    return {static_cast<double>(window.width), static_cast<double>(window.height)};
}

void move(WindowSession& session, const XHand::Window& window, const Vec2& pixel) {
    session.hand().move(window.x + static_cast<int>(pixel.x), window.y + static_cast<int>(pixel.y));
}

}  // namespace

TEST_CASE("a display that cannot be opened is said before anything is made, and fails the doctor",
          "[window]") {
    const TemporaryFolder folder;
    const Words sim = words(folder, kFourTrials, "sim");
    for (const auto& arguments :
         {words(folder), sim, Words{"demo", "--db", folder.file("d.sqlite")}}) {
        const Finished run = without_display(arguments);
        check_end(run, 2, Has("DISPLAY is :999, and no display can be opened", "--headless"));
        CHECK(folder.names().empty());
    }
    const Finished doctor =
        without_display({"doctor", "--seconds", "0.05", "--db", folder.file("d.sqlite")});
    CHECK_THAT(doctor.out, Has("fail  display"));
    CHECK(doctor.code == 1);
    const Finished unseen =  // an empty driver is none, and not any
        Process(command_of(sim), {"DISPLAY=:999", "WAYLAND_DISPLAY",
                                  "SDL_VIDEODRIVER=", "ASAN_OPTIONS=detect_leaks=0"})
            .wait();
    check_end(unseen, 2, Has("DISPLAY is :999, and no display can be opened"));
    CHECK(folder.names().empty());
    CHECK(without_display(joined(sim, {"--headless"})).code == 0);
}

TEST_CASE("where SDL2 and libmicrohttpd are missing, windows and pages say so, and all else works",
          "[window]") {
    const TemporaryFolder folder;
    const TemporaryFolder broken;
    for (const char* name : {"libSDL2-2.0.so.0", "libSDL2_ttf-2.0.so.0", "libmicrohttpd.so.12"}) {
        std::ofstream(broken.file(name)) << "no library";
    }
    const auto without = [&](const Words& arguments) {
        return Process(command_of(arguments),
                       {"LD_LIBRARY_PATH=" + broken.file(""), "SDL_VIDEODRIVER=dummy"})
            .wait();
    };
    check_end(without(words(folder)), 1,
              Has("windows and sound need SDL2", "install libsdl2-2.0-0"));
    check_end(without({"preview", kFourTrials}), 1,
              Has("a page needs libmicrohttpd", "install libmicrohttpd12"));
    check_end(without({"check", kFourTrials, "--font", ui::find_font("")}), 1,
              Has("texts on a screen need SDL2_ttf", "install libsdl2-ttf-2.0-0"));
    CHECK(folder.names().empty());
    CHECK(without({"check", kFourTrials}).code == 0);
    CHECK(without(joined(words(folder, kFourTrials, "sim"), {"--headless"})).code == 0);
    for (const char* command : {"summary", "verify", "status"}) {
        CAPTURE(command);
        CHECK(without({command, folder.file("d.sqlite")}).code == 0);
    }
}

TEST_CASE("a monitor that is not there is refused with those that are, before anything is made",
          "[window]") {
    const TemporaryFolder folder;
    Xvfb screen(800, 600, true);
    for (const auto& [number, why] :
         {std::pair{"3", "there are 2 (1: "}, std::pair{"2", "monitor 1 is at the same place"}}) {
        const Words run = joined(command_of(words(folder)), {"--monitor", number});
        const Finished end = Process(run, shown_on(screen.display())).wait();
        check_end(end, 2, Has(why, "800 x 600 at (0, 0)"));
    }
    CHECK(folder.names().empty());
}

TEST_CASE("a real session fills every screen, a window stays inside it, answers are clicked",
          "[long][window]") {
    const TemporaryFolder folder;
    write(folder.file("p.toml"),
          replaced(four_trials(), "[apparatus]\n", "[apparatus]\ndevice = \"mouse\"\n"));
    struct Place {
        WindowSession::Screen screen;
        bool windowed = false;
        std::vector<int> window{};  ///< x, y, width, height
    };
    const Place place = GENERATE(Place{{800, 600}, false, {0, 0, 800, 600}},
                                 Place{{800, 600}, true, {0, 0, 800, 600}},
                                 Place{{800, 600, true}, false, {0, 0, 1024, 768}},
                                 Place{{3840, 2160}, false, {0, 0, 3840, 2160}},
                                 Place{{3840, 2160}, true, {480, 270, 2880, 1620}});
    const Words run = joined(words(folder, folder.file("p.toml")), {"--kind", "real"});
    WindowSession session(joined(run, place.windowed ? Words{"--windowed"} : Words{}), {},
                          place.screen);
    session.go_through({"welcome", "ready", "explore"});
    const XHand::Window window = session.wait_for_screen("question");
    CHECK(std::vector<int>{window.x, window.y, window.width, window.height} == place.window);
    const ui::Card card = ui::lay_out_cards(2, size_of(window)).back();
    pause(0.4);
    if (place.screen.second) {  // a pointer that jumps from screen to screen is no hand's
        session.press_at("question", "2");
    } else {
        move(session, window, card.corner + card.size - Vec2{3.0, 3.0});
        session.hand().click();
    }
    session.wait_until("SELECT input || chosen_place FROM response",
                       place.screen.second ? "key1" : "mouse1");
    CHECK(session.program().ended_by(SIGTERM) == 3);
}

TEST_CASE(
    "a frame that comes after its window has its place on the screen, and then people move it",
    "[window]") {
    const TemporaryFolder folder;
    const WindowSession::Screen screen =
        GENERATE(WindowSession::Screen{1280, 800}, WindowSession::Screen{800, 600});
    WindowSession session(words(folder), {}, screen);
    // Where it stands is the window manager's, and there is none here.
    const auto is = [&](int width, int height) {
        return eventually([&] {
            const XHand::Window window = session.hand().find_window("palpate: ");
            return window.width == width && window.height == height;
        });
    };
    session.press_at("welcome", "space");
    const XHand::Window window = session.wait_for_screen("ready");
    CHECK(is(screen.width, screen.height));
    session.hand().frame(window, 1, 2, 20, 5);
    CHECK(is(screen.width - 3, screen.height - 25));
    session.hand().frame(window, 30, 30, 30, 30);
    pause(0.5);
    CHECK(is(screen.width - 3, screen.height - 25));
    CHECK(session.program().ended_by(SIGTERM) == 3);
}

TEST_CASE("when the display dies the force ends, the trial is kept, and the same command goes on",
          "[long][window]") {
    EACH(where, as<std::string>{}, "explore", "question", "break");
    const TemporaryFolder folder;
    write(folder.file("p.toml"), replaced(four_trials(), "break_every = 0", "break_every = 1"));
    const Words run = joined(words(folder, folder.file("p.toml")), {"--kind", "pilot"});
    const std::string file = folder.file("d.sqlite");
    {
        WindowSession session(run);
        session.go_through({"welcome", "ready"});
        const XHand::Window window = session.wait_for_screen("explore");
        pause(0.3);
        for (const double y : {0.050, 0.045, 0.041, 0.039, 0.0385, 0.038}) {  // onto the vertex
            move(session, window, ui::PointerMap{size_of(window)}.to_pixel({0.0, y}));
            pause(0.06);
        }
        pause(0.3);
        if (where != "explore") {
            session.press_at("explore", "space");
        }
        if (where == "break") {
            session.press_at("question", "1");
        }
        session.wait_for_screen(where);
        session.screen().server().signal(SIGKILL);
        check_end(
            session.finish(), 1,
            Has("the display is gone. The force is off", "the same command goes on at trial"));
        CHECK(session.ask("SELECT outcome FROM trial") ==
              (where == "break" ? "complete" : "aborted"));
        CHECK(session.ask("SELECT count(*) FROM event WHERE event_kind = 'display lost'") == "1");
    }
    CHECK(
        sql_row(file,
                "SELECT max(abs(commanded_y_n)) > 0.5, (SELECT commanded_x_n = 0 AND commanded_y_n "
                "= 0 FROM sample WHERE trial_id = 1 ORDER BY tick DESC LIMIT 1) FROM sample WHERE "
                "trial_id = 1") == "1,1");
    ran({"verify", file});
    WindowSession again(run);
    again.wait_for_text("Resuming at trial");
    again.press_at("welcome", "space");
    again.wait_for_screen("ready");
    CHECK(again.program().ended_by(SIGTERM) == 3);
}

TEST_CASE(
    "after a disk that fails the participant is asked for a moment, until the experimenter has "
    "come",
    "[window]") {
    const TemporaryFolder folder;
    const Words run = joined(words(folder), {"--kind", "pilot"});
    std::signal(SIGXFSZ, SIG_IGN);  // the program inherits it
    WindowSession session(run);
    std::signal(SIGXFSZ, SIG_DFL);
    session.press_at("welcome", "space");
    session.wait_for_screen("ready");
    constexpr rlim_t kFull = 4096;  // bytes of a file: less than the database and its log have
    const rlimit full{.rlim_cur = kFull, .rlim_max = kFull};
    REQUIRE(prlimit(session.program().id(), RLIMIT_FSIZE, &full, nullptr) == 0);
    session.press_at("ready", "space");
    session.wait_for_screen("trouble");
    session.wait_for_text("The participant's screen says \"one moment\"");
    session.hand().key("space");
    session.hand().key("Escape");  // the participant's
    pause(0.5);
    CHECK(session.screen_name() == "trouble");
    session.hand().chord("q");
    session.press_at("trouble", "y");
    check_end(session.finish(), 1, Has("what was recorded is kept"));
}
