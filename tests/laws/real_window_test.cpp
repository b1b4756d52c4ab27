#include "data/store/reader.hpp"
#include "ui/subject/answer_row.hpp"
#include "ui/subject/picking.hpp"
#include "tests/support/arc_oracle.hpp"
#include "tests/support/child.hpp"
#include "tests/support/program.hpp"
#include "tests/support/window_session.hpp"

using engine::Vec2;

namespace {

constexpr std::size_t kClicked = 1;
/// Places on a keyboard: evdev's number and 8.
constexpr const char* kDigit2 = "#11";
constexpr const char* kLetterP = "#33";
constexpr const char* kLetterQ = "#24";
constexpr const char* kLetterY = "#29";
constexpr const char* kLetterZ = "#52";
/// Beside the window there is room.
constexpr WindowSession::Screen kWide{.width = 1920, .height = 1080};

ui::PointerMap map_of(const XHand::Window& window) {
    return {{static_cast<double>(window.width), static_cast<double>(window.height)}};
}

/// Moves the real pointer to a place of the object's frame.
void point_at(XHand& hand, const XHand::Window& window, const Vec2& object) {
    const Vec2 pixel = map_of(window).to_pixel(object);
    hand.move(window.x + static_cast<int>(pixel.x), window.y + static_cast<int>(pixel.y));
}

/// Strokes of the real pointer in the left side A-V, up and down, from the start pose and off
/// again.
void explore(XHand& hand, const XHand::Window& window) {
    const auto go = [&](const Vec2& object) {
        point_at(hand, window, object);
        pause(0.004);
    };
    const Vec2 a{-0.040, 0.0};
    const Vec2 v{0.0, 0.040};
    const Vec2 out = Vec2{-1.0, 1.0} / std::sqrt(2.0);
    for (int i = 0; i <= 40; ++i) {  // over to the side and in
        go(Vec2{0.0, 0.060} + (i / 40.0) * (0.5 * (a + v) + 0.012 * out - Vec2{0.0, 0.060}));
    }
    for (int i = 0; i <= 240; ++i) {
        const double t = i / 240.0;
        const double s = 0.5 + 0.22 * std::sin(2.0 * M_PI * 2.0 * t);
        const double depth =
            std::min({0.012 * 8.0 * t - 0.012, 0.0035, 0.012 * 8.0 * (1.0 - t) - 0.012});
        go(a + s * (v - a) - depth * out);
    }
}

/// Largest difference between the recorded forces and those of the exact object under the recorded
/// pointer, by an independent method.
double worst_difference(std::span<const engine::TickRecord> trace,
                        double curvature,
                        bool rubs,
                        int& touched) {
    const ArcOracle side{{-0.040, 0.0}, {0.0, 0.040}, curvature};
    GosOracle::Law law{.stiffness = 1000.0};
    if (rubs) {
        law = {.stiffness = 1000.0, .mu_s = 0.7, .mu_d = 0.5, .tau_slip = 0.02, .tau_heal = 0.1};
    }
    GosOracle oracle(side, law);
    double worst = 0.0;
    for (const engine::TickRecord& tick : trace) {
        worst = std::max(worst, glm::length(Vec2(tick.force) - oracle.tick(Vec2(tick.hip))));
        touched += tick.mode != engine::Mode::free ? 1 : 0;
    }
    return worst;
}

/// Between two ticks, m.
double longest_step(std::span<const engine::TickRecord> trace) {
    double longest = 0.0;
    for (std::size_t i = 1; i < trace.size(); ++i) {
        longest = std::max(longest, glm::length(trace[i].hip - trace[i - 1].hip));
    }
    return longest;
}

}  // namespace

TEST_CASE(
    "a real pointer in a real window: start, choice, reaction time and exact forces are in the "
    "database",
    "[long][window]") {
    PointerSession session(four_trials(), {"--windowed"}, kWide);
    XHand& hand = session.hand();
    std::set<std::uint64_t> explore_screens;
    session.press_at("welcome", "space");
    for (int trial = 0; trial < 4; ++trial) {
        const XHand::Window before = session.wait_for_screen("ready");
        const int beside = before.x + before.width + 5;
        REQUIRE(beside < kWide.width);
        if (trial % 2 == 0) {
            hand.move(beside, before.y + before.height / 2);
        } else {
            hand.move(before.x + before.width / 2, before.y + 2 * before.height / 3);  // inside
        }
        session.press_at("ready", "space");
        const XHand::Window window = session.wait_for_screen("explore");
        const Vec2 start = map_of(window).to_pixel({0.0, 0.060});
        CHECK(eventually([&] {
            const auto [x, y] = hand.place();
            return glm::length(Vec2{x - window.x, y - window.y} - start) < 2.0;
        }));
        explore(hand, window);
        explore_screens.insert(hand.pixels(window));
        session.press_at("explore", "space");
        session.wait_for_screen("question");
        const Vec2 size{static_cast<double>(window.width), static_cast<double>(window.height)};
        const Vec2 card = ui::lay_out_cards(2, size)[kClicked].centre();
        hand.move(window.x + static_cast<int>(card.x), window.y + static_cast<int>(card.y));
        while (session.screen_name() == "question") {  // a click within the guard time is none
            pause(0.4);
            hand.click();
        }
    }
    session.press_at("end", "space");
    ended(session.finish());
    CHECK(explore_screens.size() == 4);  // they differ in the trial's number only

    data::Database database(session.database(), data::Access::read);
    auto row = database.prepare(
        "SELECT trial_id, curvature_per_m, friction, analysis_trial.chosen_object, "
        "analysis_trial.reaction_s, response.reaction_uncertainty_s, session_kind, input, done_s "
        "FROM analysis_trial JOIN response USING (trial_id) WHERE counts ORDER BY plan_position");
    auto picture = database.first("SELECT picture_object FROM picture WHERE picture_place = 1");
    int trials = 0;
    while (row.step()) {
        ++trials;
        CAPTURE(row.integer(0), row.real(1), row.text(2));
        CHECK(row.text(3) == picture.text(0));
        CHECK(row.real(4) > 0.2);
        CHECK(row.real(4) < WindowSession::kPatience);
        CHECK(row.real(5) >= 0.0);
        CHECK(row.text(6) == "pilot");
        CHECK(row.text(7) == "mouse");
        CHECK(row.real(8) > 1.0);
        int touched = 0;
        const auto trace = data::TraceReader(database).read(row.integer(0));
        CHECK(glm::length(Vec2(trace.front().hip) - Vec2{0.0, 0.060}) < 1e-7);
        CHECK(longest_step(trace) < 0.02);  // nor did it come from where it had been
        CHECK(worst_difference(trace, row.real(1), row.text(2) == "on", touched) <= 1e-9);
        CHECK(touched > 200);
    }
    CHECK(trials == 4);
}

TEST_CASE("of a contact on the pointer no force is kept or said, for nobody felt one", "[window]") {
    PointerSession session;
    session.go_through({"welcome", "ready"});
    explore(session.hand(), session.wait_for_screen("explore"));
    session.press_at("explore", "space");
    session.press_at("question", "1");
    session.wait_for_text("answered in");
    session.program().signal(SIGTERM);
    CHECK_THAT(answered_line(session.finish().out),
               Has("felt ") && !Has("contact") && !Has(" N ") && !Has("touched"));
    CHECK(session.ask("SELECT contact_ticks > 0 FROM trial") == "1");
    for (const std::string column :
         {"trial.mean_normal_force_n", "trial.max_normal_force_n", "trial.energy_j",
          "presentation.mean_normal_force_n", "presentation.normal_force_p50_n"}) {
        CAPTURE(column);
        CHECK(session.ask("SELECT count(*) FROM trial JOIN presentation USING (trial_id) WHERE " +
                          column + " IS NULL") == "1");
    }
}

TEST_CASE(
    "a session on surfaces in a real window, broken off at the choice, is what verify recomputes",
    "[window]") {
    const TemporaryFile file("d.sqlite");
    WindowSession session(run_words("patch_friction", "P1", file,
                                    {"--device", "sim", "--windowed", "--speed", "20"}));
    session.go_through({"welcome", "ready", "explore"});
    session.press_at("question", "2");
    session.go_through({"ready", "explore"});
    session.wait_for_screen("question");
    CHECK(session.program().ended_by(SIGTERM) == 3);
    CHECK(session.ask("SELECT group_concat(outcome) FROM trial") == "complete,aborted");
    CHECK(session.ask("SELECT input FROM response") == "key");
    ran({"verify", file});
}

TEST_CASE("of an object that was never touched the person's line says so", "[window]") {
    PointerSession session;
    session.press_at("welcome", "space");
    point_at(session.hand(), session.wait_for_screen("ready"), {0.0, 0.060});
    session.go_through({"ready", "explore"});
    session.press_at("question", "1");
    session.wait_for_text("answered in");
    session.program().signal(SIGTERM);
    CHECK_THAT(answered_line(session.finish().out), Has(" s, never touched, answered in "));
    CHECK(session.ask("SELECT contact_ticks FROM trial") == "0");
}

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
