#include "engine/device/emulator/emulated_board.hpp"

#include <array>
#include <atomic>
#include <exception>
#include <new>
#include <stdexcept>

#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/base/clock.hpp"
#include "engine/base/lock_free.hpp"
#include "engine/base/refuse.hpp"
#include "engine/device/drivers/haply_line.hpp"
#include "engine/device/drivers/serial_link.hpp"
#include "engine/device/drivers/udp_link.hpp"
#include "engine/device/emulator/open_board.hpp"
#include "engine/device/emulator/served_board.hpp"
#include "engine/device/open/open_line.hpp"

namespace palpate::engine {

struct EmulatedBoard::Shared {
    enum class Life : std::uint8_t { starting, running, failed };

    std::atomic<Life> life{Life::starting};
    std::array<char, 256> path{};
    std::atomic<bool> quit{false};

    LatestValue<Motors> motors;
    LatestValue<BoardLog> log;

    Exploration plan{};
    std::atomic<unsigned> ordered{0};  ///< explorations asked for
    std::atomic<unsigned> begun{0};
    std::atomic<bool> refused{false};
    std::atomic<bool> done{false};

    struct Switch {
        std::atomic<bool> wanted{false};
        std::atomic<bool> is{false};

        /// What was wanted is done.
        template <class Turn>
        void follow(Turn turn) {
            if (const bool now = wanted.load(); now != is.load()) {
                turn(now);
                is.store(now);
            }
        }
    };
    Switch unplugged, silent, stopped;
};

namespace {

using Shared = EmulatedBoard::Shared;

constexpr int kStepUs = 250;
constexpr int kPriority = 40;        ///< a real board is never busy with something else
constexpr int kPatienceMs = 20'000;  ///< for a process on a loaded machine

void obey(Shared& shared, BoardHand& hand, PortBoard& board, PtyBoard& terminal) {
    const unsigned ordered = shared.ordered.load();
    if (ordered != shared.begun.load()) {
        try {
            hand.begin(shared.plan);
            shared.refused.store(false);
        } catch (const std::exception&) {
            shared.refused.store(true);
        }
        shared.done.store(hand.hand_is_done());
        shared.begun.store(ordered);
    }
    shared.unplugged.follow([&](bool out) { terminal.plug(!out); });
    shared.silent.follow([&](bool on) { board.hush(on); });
    shared.stopped.follow([&](bool on) { board.press_stop(on); });
}

/// @param told  what the motors were said to get
void tell(Shared& shared,
          EmulatedBoard::Motors& told,
          const BoardHand& hand,
          const PortBoard& board) noexcept {
    if (const Vec2 torque(board.torque()); torque != told.torque) {
        told = {.torque = torque, .since_ns = monotonic_ns()};
        shared.motors.publish(told);
    }
    if (const auto* haply = dynamic_cast<const HaplyBoard*>(&board)) {
        shared.log.publish(haply->journal());
    }
    shared.done.store(hand.hand_is_done());
}

template <class T>
T newest(const LatestValue<T>& value) noexcept {
    while (true) {
        if (const auto now = value.read()) {
            return *now;
        }
    }
}

void live(Shared& shared,
          pid_t owner,
          const Calibration& machine,
          const MakeHand& make_hand,
          const std::string& link,
          MakeBoard make_board) {
    for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
        signal(number, SIG_IGN);  // a session that is interrupted still has to ramp its force out
    }
    run_like_a_board();
    const std::unique_ptr<BoardHand> hand = make_hand();
    const std::unique_ptr<PortBoard> board = make_board(*hand, machine);
    PtyBoard terminal(*board, link);
    terminal.path().copy(shared.path.data(), shared.path.size() - 1);
    shared.life.store(Shared::Life::running);
    EmulatedBoard::Motors told;
    while (!shared.quit.load() && getppid() == owner) {
        terminal.step(kStepUs);
        tell(shared, told, *hand, *board);
        obey(shared, *hand, *board, terminal);
    }
}

}  // namespace

void run_like_a_board() noexcept {
    prctl(PR_SET_NAME, "haply-emulator");
    prctl(PR_SET_TIMERSLACK, 1000UL);
    const sched_param board_like{.sched_priority = kPriority};
    sched_setscheduler(0, SCHED_FIFO, &board_like);  // where it is permitted
}

std::unique_ptr<PortBoard> make_haply_board(BoardPlant& plant, const Calibration& machine) {
    refuse_if(!machine.haply, "the emulated machine has no Haply board");
    return std::make_unique<HaplyBoard>(plant, machine.pantograph, *machine.haply);
}

std::unique_ptr<PortBoard> make_open_board(BoardPlant& plant, const Calibration& machine) {
    refuse_if(!machine.board, "the emulated machine has no open board");
    return std::make_unique<OpenBoard>(plant, machine, *machine.board);
}

EmulatedBoard::EmulatedBoard(const Calibration& machine,
                             const MakeHand& hand,
                             const std::string& link,
                             MakeBoard make_board) {
    void* memory =
        mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    refuse_if<std::runtime_error>(memory == MAP_FAILED,
                                  "no memory to share with the emulator: end some programs");
    shared_ = new (memory) Shared{};
    shared_->motors.publish({});
    shared_->log.publish({});
    const pid_t owner = getpid();
    pid_ = fork();
    if (pid_ == 0) {
        try {
            live(*shared_, owner, machine, hand, link, make_board);
        } catch (const std::exception&) {
            shared_->life.store(Shared::Life::failed);
        }
        _exit(0);
    }
    try {
        await([&] { return shared_->life.load() != Shared::Life::starting; }, "start");
        refuse_if<std::runtime_error>(shared_->life.load() == Shared::Life::failed,
                                      "the board emulator found no pseudo-terminal, cannot make "
                                      "{}, or the machine has no such board",
                                      link.empty() ? "one" : link);
    } catch (...) {
        end();
        throw;
    }
    path_ = shared_->path.data();
}

EmulatedBoard::~EmulatedBoard() {
    end();
}

void EmulatedBoard::end() noexcept {
    if (pid_ > 0) {
        shared_->quit.store(true);
        for (int waited = 0; waitpid(pid_, nullptr, WNOHANG) == 0; ++waited) {
            if (waited == 2000) {
                kill(pid_, SIGKILL);
            }
            poll(nullptr, 0, 1);
        }
    }
    munmap(shared_, sizeof(Shared));
}

void EmulatedBoard::await(const std::function<bool()>& done, const char* what) const {
    for (int waited = 0; !done(); ++waited) {
        refuse_if<std::runtime_error>(pid_ < 0 || waited == kPatienceMs || kill(pid_, 0) != 0,
                                      "the board emulator did not {}", what);
        poll(nullptr, 0, 1);
    }
}

EmulatedBoard::Motors EmulatedBoard::motors() const noexcept {
    return newest(shared_->motors);
}

BoardLog EmulatedBoard::journal() const noexcept {
    return newest(shared_->log);
}

void EmulatedBoard::begin(const Exploration& plan) {
    shared_->plan = plan;
    const unsigned order = shared_->ordered.load() + 1;
    shared_->ordered.store(order);
    await([&] { return shared_->begun.load() == order; }, "begin to explore");
    refuse_if(
        shared_->refused.load(),
        "the emulated device cannot reach the start pose: move the start closer to the object");
}

bool EmulatedBoard::hand_is_done() const noexcept {
    return shared_->done.load();
}

void EmulatedBoard::plug(bool in) {
    shared_->unplugged.wanted.store(!in);
    await([&] { return shared_->unplugged.is.load() != in; }, in ? "come back" : "go away");
}

void EmulatedBoard::press_stop(bool pressed) {
    shared_->stopped.wanted.store(pressed);
    await([&] { return shared_->stopped.is.load() == pressed; }, "obey");
}

void EmulatedBoard::hush(bool silent) {
    shared_->silent.wanted.store(silent);
    await([&] { return shared_->silent.is.load() == silent; }, "obey");
}

std::unique_ptr<BoardDevice> open_haply(const std::string& path,
                                        const Calibration& calibration,
                                        const BoardTiming& timing,
                                        const GuardTiming& guard) {
    return std::make_unique<BoardDevice>(calibration, std::make_unique<SerialLink>(path),
                                         haply_line, std::make_unique<GuardProcess>(guard), timing);
}

std::unique_ptr<BoardDevice> open_board(const std::string& path,
                                        const Calibration& calibration,
                                        const BoardTiming& timing,
                                        const GuardTiming& guard) {
    std::unique_ptr<ByteLink> link;
    if (path.starts_with(kUdp)) {
        link = std::make_unique<UdpLink>(udp_address(path));
    } else {
        link = std::make_unique<SerialLink>(path, true);
    }
    return std::make_unique<BoardDevice>(calibration, std::move(link), open_line,
                                         std::make_unique<GuardProcess>(guard), timing);
}

}  // namespace palpate::engine
