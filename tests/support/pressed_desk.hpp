#pragma once

#include "engine/device/emulator/emulated_board.hpp"
#include "protocols/file/calibration_file.hpp"
#include "tests/support/child.hpp"
#include "tests/support/test_text.hpp"
#include "tests/support/window_session.hpp"

namespace palpate::tests {

/// A hand on an emulated board that no torque moves: it rests where the board is set up, then goes
/// to the left side of a straight object and does one thing there for ever.
class PressingHand : public engine::BoardHand {
public:
    enum class Does : std::uint8_t {
        presses,    ///< 5 mm inside, to and fro along it at 0.5 Hz
        buzzes,     ///< the same, with 3.5 mm of swing at 18 Hz
        runs_away,  ///< comes slowly, and at 8 mm goes deeper at 0.25 m/s; again and again
    };
    static constexpr double kRest = 3.0;  ///< s at home; a reconnection looks for one of rest

    PressingHand(const engine::Calibration& machine, Does does)
        : pantograph_(machine.pantograph), does_(does) {
        home_ =
            machine.home ? pantograph_.reach(*machine.home).value() : pantograph_.angles({0, 0});
        start_ = pantograph_.locate(home_).value().hip;
        angles_ = home_;
    }

    void begin(const engine::Exploration& /*plan*/) override {}
    [[nodiscard]] bool hand_is_done() const noexcept override { return false; }
    void set_torque(const engine::Vec3& /*newton_metres*/) noexcept override {}
    void before_set_up() noexcept override {
        angles_ = home_;
        time_ = 0.0;
    }
    void advance(double seconds) noexcept override {
        time_ += seconds;
        if (time_ > kRest) {
            angles_ = pantograph_.reach(place(time_ - kRest)).value_or(angles_);
        }
    }
    [[nodiscard]] double angle(std::size_t axis) const noexcept override { return angles_[axis]; }

private:
    /// @param t  s since it left its home
    [[nodiscard]] engine::Vec2 place(double t) const noexcept {
        constexpr double kGlide = 1.0;  // s
        const double along = 0.004 * std::sin(3.141592653589793 * t);
        const double s = std::sqrt(0.5);
        const engine::Vec2 inwards{s, -s};
        const engine::Vec2 there =
            engine::Vec2{-0.02, 0.02} + along * engine::Vec2{s, s} + depth(t) * inwards;
        const double share = std::fmin(t / kGlide, 1.0);
        return start_ + share * share * (3.0 - 2.0 * share) * (there - start_);
    }
    [[nodiscard]] double depth(double t) const noexcept {
        switch (does_) {
            case Does::presses:
                break;
            case Does::buzzes:
                return 0.003 + 0.00175 * std::sin(18.0 * 6.283185307179586 * t);
            case Does::runs_away: {
                const double round = std::fmod(t, 1.4);  // s
                const double in = std::fmin(0.04 * round, 0.028) +
                                  0.25 * std::fmin(std::fmax(0.0, round - 0.7), 0.06);
                return -0.020 + in - 0.086 * std::fmax(0.0, round - 0.9);
            }
        }
        return 0.005;
    }

    engine::Pantograph pantograph_;
    Does does_;
    engine::JointAngles home_{};
    engine::JointAngles angles_{};
    engine::Vec2 start_{};
    double time_ = 0.0;
};

inline std::string pressed_study() {
    return edited(four_trials(),
                  {{"stiffness_n_per_m = 1000", "stiffness_n_per_m = 200"},
                   {"force_limit_n = 10", "force_limit_n = 1.5"},
                   {"curvature_per_m = 8", "curvature_per_m = 0"},
                   // a hand that presses for ever
                   {"start_mm = [0, 60]", "start_mm = [0, 60]\nstart_radius_mm = 0"}}) +
           "\n[safety]\ndead_man = true\nlate_in_a_row = 0\nlate_of_100 = 0\n";
}

/// A session at a window, with a board that a hand presses on.
struct PressedDesk {
    /// @param open  an open board instead of a Haply board
    /// @param more  of the command's words
    explicit PressedDesk(PressingHand::Does does,
                         const Words& environment = {},
                         bool open = false,
                         const Words& more = {})
        : board(
              machine,
              [&] { return std::make_unique<PressingHand>(machine, does); },
              folder.file("board"),
              open ? engine::make_open_board : engine::make_haply_board) {
        const Words words =
            joined(run_words(write(folder.file("p.toml"), pressed_study()), "P1", file,
                             {"--device", (open ? "board:" : "haply:") + board.path(),
                              "--calibration", "2diy_gen3", "--kind", "pilot", "--windowed"}),
                   more);
        session = std::make_unique<WindowSession>(words, environment, WindowSession::Screen{});
        session->press_at("welcome", "space");
    }

    /// Holds Space until there is force. A busy machine may end it for another reason: then once
    /// more.
    /// @return false if there never was any
    [[nodiscard]] bool feel() {
        for (int tries = 0; tries < 80 && board.motors().off(); ++tries) {
            const std::string screen = session->screen_name();
            if (!went_on(screen, tries) && screen != "explore") {
                press_anew();
            }
            for (int i = 0; i < 500 && board.motors().off(); ++i) {
                wait_a_little();
            }
        }
        return !board.motors().off();
    }
    /// By the chord, every other try: a board that a busy machine lost is the experimenter's.
    [[nodiscard]] bool went_on(const std::string& screen, int tries) {
        const bool chord = screen == "pause" || (screen == "trouble" && tries % 2 == 1);
        if (chord) {
            session->hand().release("space");
            session->hand().focus(session->hand().find_window("palpate: "));
            session->hand().chord("p");
        }
        return chord;
    }
    /// Lets go of Space and presses it again: not at once, or SDL takes both for the key's own
    /// repetition.
    void press_anew() {
        session->hand().release("space");
        tests::pause(0.02);
        session->hand().press("space");
    }
    /// Goes on after faults of a busy machine until one has this cause.
    [[nodiscard]] bool faults_of(const std::string& cause) {
        for (int i = 0; i < 200 && faults(cause) != "1"; ++i) {
            tests::pause(0.1);
            const std::string screen = session->screen_name();
            if (went_on(screen, i)) {
                continue;
            }
            if (screen == "trouble" || screen == "ready") {
                press_anew();
            } else if (screen != "explore") {
                session->hand().key(screen == "question" ? "1" : "space");
            }
        }
        return faults(cause) == "1";
    }
    /// Looks at the file alone, ten times a second.
    [[nodiscard]] bool waits_for_fault(const std::string& cause) const {
        for (int i = 0; i < 200 && faults(cause) != "1"; ++i) {
            tests::pause(0.1);
        }
        return faults(cause) == "1";
    }
    /// Off for longer than a port whose answers a busy machine keeps back would have it; since when
    /// says the board.
    [[nodiscard]] bool force_ends() const {
        constexpr std::int64_t kBack = 100'000'000;  // ns
        return eventually([&] {
            const auto motors = board.motors();
            return motors.off() && monotonic_ns() - motors.since_ns > kBack;
        });
    }
    /// After a stop, by the experimenter's chord: until a trial may begin.
    void goes_on() const {
        session->wait_for_screen("trouble");
        leave_trouble(session->hand());
        session->wait_for_screen("ready");
    }
    [[nodiscard]] bool stays_off() const {
        for (int i = 0; i < 150; ++i) {
            if (!board.motors().off()) {
                return false;
            }
            wait_a_little();
        }
        return true;
    }
    /// The guard is the one that the program has started.
    [[nodiscard]] pid_t guard() const { return guard_of(session->program().id()); }
    [[nodiscard]] std::string faults(const std::string& cause) const {
        return session->ask("SELECT count(*) > 0 FROM trial WHERE fault_cause = '" + cause + "'");
    }

    engine::Calibration machine = protocols::load_calibration("2diy_gen3");
    TemporaryFolder folder;
    std::string file = folder.file("d.sqlite");
    engine::EmulatedBoard board;
    std::unique_ptr<WindowSession> session;
};

}  // namespace palpate::tests
