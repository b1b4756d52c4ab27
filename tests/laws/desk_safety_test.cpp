#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/base/clock.hpp"
#include "protocols/file/calibration_file.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/pressing_hand.hpp"
#include "tests/support/window_session.hpp"

// What may go wrong around a person at the desk while a force is on, done to the program itself: a real window, a
// board on a pseudo-terminal with a hand on it, and the torques that the board gets. Nothing is asserted about
// time but that a force goes off within seconds that used to stay for ever.

using namespace palpate;
using tests::eventually;
using tests::PressingHand;
using tests::TemporaryFolder;
using tests::WindowSession;

namespace {

std::string study() {
    std::ifstream file(PALPATE_SOURCE_DIR "/tests/golden/four_trials.toml");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto put = [&](const std::string& from, const std::string& to) {
        const std::size_t at = text.find(from);
        REQUIRE(at != std::string::npos);
        text.replace(at, from.size(), to);
    };
    put("stiffness_n_per_m = 1000", "stiffness_n_per_m = 200");
    put("force_limit_n = 10", "force_limit_n = 1.5");
    put("curvature_per_m = 8", "curvature_per_m = 0");
    return text + "\n[safety]\ndead_man = true\nlate_in_a_row = 0\nlate_of_100 = 0\n";
}

/// A session at a window, with a board that a hand presses on.
struct Desk {
    explicit Desk(PressingHand::Does does)
        : board(machine, [&] { return std::make_unique<PressingHand>(machine, does); }) {
        std::ofstream(folder.file("p.toml")) << study();
        session = std::make_unique<WindowSession>(
            std::vector<std::string>{"run", folder.file("p.toml"), "--participant", "P1", "--db",
                                     file, "--device", "haply:" + board.path(), "--calibration",
                                     "2diy_gen3", "--kind", "pilot", "--windowed"},
            file);
        session->press_at("welcome", "space");
    }

    /// Holds Space until there is force. A busy machine may end it for another reason: then once more.
    void feel() {
        REQUIRE(eventually([&] {
            const std::string screen = session->screen_name();
            if (screen != "explore") {
                session->hand().release("space");
                session->hand().press("space");
                tests::wait_a_little();
            }
            for (int i = 0; i < 500 && board.motors().off(); ++i) {
                tests::wait_a_little();
            }
            return !board.motors().off();
        }));
    }
    /// Goes on after faults of a busy machine until one has this cause.
    [[nodiscard]] bool faults_of(const std::string& cause) {
        for (int i = 0; i < 200 && faults(cause) != "1"; ++i) {
            for (int k = 0; k < 100; ++k) {
                tests::wait_a_little();
            }
            const std::string screen = session->screen_name();
            if (screen == "trouble" || screen == "ready") {
                session->hand().release("space");
                session->hand().press("space");
            } else if (screen != "explore") {
                session->hand().key(screen == "question" ? "1" : "space");
            }
        }
        return faults(cause) == "1";
    }
    /// Looks at the file alone, ten times a second.
    [[nodiscard]] bool waits_for_fault(const std::string& cause) const {
        for (int i = 0; i < 200 && faults(cause) != "1"; ++i) {
            for (int k = 0; k < 100; ++k) {
                tests::wait_a_little();
            }
        }
        return faults(cause) == "1";
    }
    [[nodiscard]] bool force_ends() const {
        return eventually([&] { return board.motors().off(); });
    }
    [[nodiscard]] bool stays_off() const {
        for (int i = 0; i < 150; ++i) {
            if (!board.motors().off()) {
                return false;
            }
            tests::wait_a_little();
        }
        return true;
    }
    /// The guard is the one that the program has started.
    [[nodiscard]] pid_t guard() const {
        for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
            std::ifstream stat(entry.path() / "stat");
            std::string line;
            std::getline(stat, line);
            std::istringstream rest(line.substr(line.rfind(')') + 1));
            char state = ' ';
            pid_t parent = 0;
            rest >> state >> parent;
            if (parent == session->program().id() && state != 'Z') {
                return static_cast<pid_t>(std::stol(entry.path().filename().string()));
            }
        }
        return -1;
    }
    [[nodiscard]] std::string faults(const std::string& cause) const {
        return session->ask("SELECT count(*) > 0 FROM trial WHERE fault_cause = '" + cause + "'");
    }

    engine::Calibration machine = protocols::load_calibration("2diy_gen3");
    TemporaryFolder folder;
    std::string file = folder.file("d.sqlite");
    engine::EmulatedBoard board;
    std::unique_ptr<WindowSession> session;
};

}  // namespace

TEST_CASE("a screen that stands still ends the force, which a live one with the key held does not",
          "[window][safety][law]") {
    Desk desk(PressingHand::Does::presses);
    desk.feel();
    for (int i = 0; i < 600; ++i) {
        tests::wait_a_little();
    }
    CHECK(desk.faults("screen_silent") == "0");
    CHECK(desk.faults("let_go") == "0");
    desk.feel();
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
}

TEST_CASE("a contact that buzzes or a handle that runs away ends the force, with its cause",
          "[window][safety][law]") {
    const bool buzzes = GENERATE(true, false);
    Desk desk(buzzes ? PressingHand::Does::buzzes : PressingHand::Does::runs_away);
    desk.feel();
    CHECK(desk.faults_of(buzzes ? "buzz" : "runaway"));
    CHECK(desk.force_ends());
    CHECK(desk.stays_off());
}

TEST_CASE(
    "in its window the program's guard ends the force when it dies, and it when its guard does",
    "[window][guard][law]") {
    Desk desk(PressingHand::Does::presses);
    desk.feel();
    kill(desk.guard(), SIGKILL);
    CHECK(desk.force_ends());
    CHECK(desk.waits_for_fault("device_lost"));
    desk.session->press_at("trouble", "space");
    desk.feel();
    const std::int64_t killed = monotonic_ns();
    desk.session->program().signal(SIGKILL);
    CHECK(desk.force_ends());
    const double after = 1e-9 * static_cast<double>(desk.board.motors().since_ns - killed);
    CAPTURE(after);
    CHECK(after < 2.0);  // 2 ms on a quiet machine
    CHECK(desk.stays_off());
}
