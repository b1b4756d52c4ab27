#include <poll.h>
#include <termios.h>

#include "engine/base/descriptor.hpp"
#include "tests/support/free_board.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

// What a session takes for its rig, by the shipped program in a window: not what a slipped encoder
// says, not what stands at the port in its board's place.

namespace {

/// A port in front of another: for the kernel no emulator stands behind it, as behind a board.
class Relay {
public:
    /// @param link  a symbolic link to the port   @param target  the other one
    Relay(std::string link, const std::string& target) : link_(std::move(link)) {
        ports_[0] = Descriptor(open(target.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
        ports_[1] = Descriptor(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
        const int master = ports_[1].get();
        std::array<char, 128> name{};
        if (ports_[0].get() < 0 || master < 0 || grantpt(master) != 0 || unlockpt(master) != 0 ||
            ptsname_r(master, name.data(), name.size()) != 0) {
            throw std::runtime_error("there is no port to relay");
        }
        slave_ = Descriptor(open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
        for (const int port : {ports_[0].get(), slave_.get()}) {
            termios raw{};
            tcgetattr(port, &raw);
            cfmakeraw(&raw);
            tcsetattr(port, TCSANOW, &raw);
        }
        std::filesystem::create_symlink(name.data(), link_);
        thread_ = std::thread([this] { live(); });
    }
    Relay(const Relay&) = delete;
    Relay& operator=(const Relay&) = delete;
    ~Relay() {
        ends_.store(true);
        thread_.join();
        std::filesystem::remove(link_);
    }

private:
    void live() {
        while (!ends_.load()) {
            std::array<pollfd, 2> heard{{{.fd = ports_[0].get(), .events = POLLIN, .revents = 0},
                                         {.fd = ports_[1].get(), .events = POLLIN, .revents = 0}}};
            if (poll(heard.data(), heard.size(), 10) <= 0) {
                continue;
            }
            for (std::size_t i = 0; i < 2; ++i) {
                std::array<char, 4096> bytes{};
                const ssize_t got = read(ports_[i].get(), bytes.data(), bytes.size());
                if (got > 0 && ::write(ports_[1 - i].get(), bytes.data(),
                                       static_cast<std::size_t>(got)) != got) {
                    return;
                }
            }
        }
    }

    std::string link_;
    std::array<Descriptor, 2> ports_{Descriptor(), Descriptor()};
    Descriptor slave_{};  ///< held open, as an emulator does
    std::atomic<bool> ends_{false};
    std::thread thread_;
};

std::string number(const TemporaryFolder& folder, const std::string& what) {
    return sql_first(folder.file("d.sqlite"), "SELECT count(*) FROM " + what);
}

}  // namespace

TEST_CASE("an encoder that jumps at Ready is a fault, and a hand that brings the handle is none",
          "[haply][window][safety]") {
    const TemporaryFolder folder;
    FreeBoard board(folder);
    const std::string rig = commissioned_rig(folder, board.word());
    OpenedSession run(folder, board, real_words(folder, board, rig));
    run.press_up_to("ready");
    for (const char* place : {"30,70", "-30,60", "0,89.3"}) {
        board.bring(place);
    }
    CHECK(number(folder, "event WHERE event_kind = 'fault' AND value IN ('jump', 'over_speed')") ==
          "0");
    board.bring(fmt::format("turned {}", 180 * 360.0 / 4880.0));
    board.bring("delay 0");  // of its answers, not of its discs
    run.wait_for("trouble");
    CHECK(run.program().says("the handle jumped"));
    CHECK(run.program().says("one of them slipped"));  // nothing goes on by itself
    board.bring("turned 0");
    run.press_up_to("ready");
    CHECK(number(folder, "trial") == "0");
    CHECK(number(folder,
                 "event AS jump WHERE event_kind = 'fault' AND value = 'jump' AND text "
                 "LIKE 'before the trial at position 0:%' AND 2 = (SELECT count(DISTINCT "
                 "key) FROM event WHERE event_id > jump.event_id AND key IN ('start pose', "
                 "'rig check') AND value NOT LIKE 'refused%')") == "1");
    CHECK(run.end().code == 3);
    ran({"verify", folder.file("d.sqlite")});
}

TEST_CASE("a board in an emulator's place, or an emulator in a board's, is not the session's rig",
          "[haply][window][safety]") {
    const bool simulated = GENERATE(true, false);
    CAPTURE(simulated);
    const TemporaryFolder folder;
    const TemporaryFolder elsewhere;
    FreeBoard other(elsewhere);
    auto board = simulated ? std::make_unique<FreeBoard>(folder) : nullptr;
    auto relay = simulated ? nullptr
                           : std::make_unique<Relay>(folder.file("board"), elsewhere.file("board"));
    const std::string device = "haply:" + folder.file("board");
    const std::string record = commissioned_rig(folder, device);
    OpenedSession run(
        folder, simulated ? *board : other,
        ran_words(folder, device) + (simulated ? "" : " --calibration '" + record + "'"));
    run.press_up_to("ready");
    CHECK(number(folder, simulated ? "session WHERE session_kind = 'simulated'"
                                   : "session WHERE session_kind = 'real'") == "1");
    if (simulated) {
        unplug(folder, board);
        relay = std::make_unique<Relay>(folder.file("board"), elsewhere.file("board"));
        CHECK(run.program().says("is no longer palpate haply-emulator"));
    } else {
        relay.reset();
        board = std::make_unique<FreeBoard>(folder);
        CHECK(run.program().says("is now palpate haply-emulator, process "));
    }
    run.hand.chord("p");
    pause(1.0);
    CHECK(run.title() == "palpate: trouble");
    if (simulated) {  // what the session was begun with goes on
        relay.reset();
        board = std::make_unique<FreeBoard>(folder);
        CHECK(run.program().says("can go on"));
    }
    CHECK(number(folder, "trial") == "0");
    CHECK(run.end().code == 3);
}

TEST_CASE("another open board is not the one that was commissioned, and not the session's",
          "[open][window]") {
    const TemporaryFolder folder;
    auto board = std::make_unique<FreeBoard>(folder, "--open");
    const std::string rig = commissioned_rig(folder, board->word());
    const std::string words = real_words(folder, *board, rig);
    {
        OpenedSession run(folder, *board, words);
        run.press_up_to("question");
        CHECK(run.end().code == 3);
    }
    REQUIRE(number(folder, "trial") != "0");
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
