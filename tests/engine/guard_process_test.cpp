#include "engine/device/drivers/haply_line.hpp"
#include "engine/device/drivers/serial_link.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/emulated_machine.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

// Real processes and a real port. Nothing here depends on how long things take: waits end when what
// they wait for has happened, and only a wait of 20 s is a failure.

namespace {

/// No such process, or one that ended and was not reaped by its parent.
bool gone(pid_t pid) {
    std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
    std::string skip;
    std::string state;
    file >> skip >> skip >> state;
    return !file || state == "Z" || state == "X";
}

bool off(const EmulatedBoard& board) {
    return eventually([&] { return board.motors().off(); });
}

/// They stay off: 200 ms of opportunity.
bool stays_off(const EmulatedBoard& board) {
    for (int i = 0; i < 200; ++i) {
        if (!board.motors().off()) {
            return false;
        }
        wait_a_little();
    }
    return true;
}

}  // namespace

TEST_CASE("however palpate dies with the force on, its motors go to zero") {
    EmulatedBoard board(haply_machine(), guided_hand());
    EACH(death, SIGKILL, SIGTERM, SIGINT, SIGSEGV, SIGABRT, SIGHUP);
    const auto presser = pressing(board, haply_machine());
    const pid_t guard = presser->guard();
    presser->signal(death);
    presser->reap();
    CHECK(off(board));
    CHECK(stays_off(board));
    CHECK(eventually([&] { return gone(guard); }));
    CHECK(board.journal().undefined_duty == 0);
    CHECK(board.journal().desyncs == 0);
}

TEST_CASE(
    "whatever befalls palpate, its guard and the board together, the force ends and stays off") {
    EACH(open, false, true);
    const Calibration calibration = open ? open_machine() : haply_machine();
    EmulatedBoard board(
        calibration, [&] { return std::make_unique<GuidedHand>(calibration); }, {},
        open ? make_open_board : make_haply_board);
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const auto presser = pressing(board, calibration);
        const pid_t guard = presser->guard();
        const int hushed = random.below(3);  // before, between or not at all
        // A Haply board has no watchdog: there one of both is spared, or nobody is left to end it.
        const bool palpate_first = random.coin();
        const int blows = open ? 1 + random.below(2) : 1;
        for (int i = 0; i < blows; ++i) {
            if (hushed == i) {
                board.hush(true);
            }
            const int blow = random.coin() ? SIGKILL : SIGSTOP;
            kill(palpate_first == (i == 0) ? presser->id() : guard, blow);
            for (int ms = random.below(5); ms > 0; --ms) {
                wait_a_little();
            }
        }
        CHECK(off(board));
        for (int i = 0; i < 60; ++i) {
            REQUIRE(board.motors().off());
            wait_a_little();
        }
        board.hush(false);
        presser->signal(SIGKILL);
        presser->reap();
        kill(guard, SIGCONT);
        CHECK(eventually([&] { return gone(guard); }));
        CHECK(off(board));
    }
}

TEST_CASE(
    "a palpate that hangs or is stopped with the force on has its motors zeroed, and may not press "
    "again") {
    EmulatedBoard board(haply_machine(), guided_hand());
    const bool stopped = GENERATE(true, false);
    const auto presser =
        pressing(board, haply_machine(), stopped ? Presser::End::signal : Presser::End::hang);
    if (stopped) {
        presser->signal(SIGSTOP);
    } else {
        presser->end();
    }
    CHECK(off(board));
    CHECK(stays_off(board));
    if (stopped) {
        presser->signal(SIGCONT);
        CHECK(eventually([&] { return presser->fault() != 0; }));
        CHECK(presser->fault() == static_cast<int>(DeviceFault::held));
        CHECK(off(board));
        CHECK(stays_off(board));
    }
    presser->signal(SIGKILL);
    presser->reap();
    CHECK(stays_off(board));
}

TEST_CASE("when its guard is killed or stopped the driver gives no more force") {
    EmulatedBoard board(haply_machine(), guided_hand());
    const int blow = GENERATE(SIGKILL, SIGSTOP);
    const auto presser = pressing(board, haply_machine());
    const pid_t guard = presser->guard();
    kill(guard, blow);
    CHECK(off(board));
    CHECK(stays_off(board));
    CHECK(presser->fault() == static_cast<int>(DeviceFault::unguarded));
    presser->signal(SIGKILL);
    presser->reap();
    CHECK(stays_off(board));
    kill(guard, SIGCONT);
    CHECK(eventually([&] { return gone(guard); }));
}

TEST_CASE("a guard outlives the terminal's signals and ends with its owner's object") {
    EmulatedBoard board(haply_machine(), guided_hand());
    pid_t guard = -1;
    {
        auto own = std::make_unique<GuardProcess>(GuardTiming{.alive_ms = 20'000});
        guard = own->id();
        BoardDevice device(haply_machine(), std::make_unique<SerialLink>(board.path()), haply_line,
                           std::move(own), {.silence = 5.0});
        for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGTSTP}) {
            kill(guard, number);
        }
        for (int i = 0; i < 50; ++i) {
            CHECK(device.read().ok());
            device.write({});
            wait_a_little();
        }
        CHECK_FALSE(gone(guard));
        CHECK(getsid(guard) == guard);
    }
    CHECK(kill(guard, 0) != 0);  // reaped: not even a zombie
}

TEST_CASE("a driver that is silent without force is left alone") {
    EmulatedBoard board(haply_machine(), guided_hand());
    auto own = std::make_unique<GuardProcess>(GuardTiming{.alive_ms = 20'000});
    const GuardProcess& guard = *own;
    BoardDevice device(haply_machine(), std::make_unique<SerialLink>(board.path()), haply_line,
                       std::move(own), {.silence = 5.0});
    REQUIRE(device.read().ok());
    device.write({});
    const int exchanges = board.journal().exchanges;
    for (int i = 0; i < 100; ++i) {
        wait_a_little();
    }
    CHECK_FALSE(guard.tripped());
    CHECK(board.journal().exchanges <= exchanges + 1);
    CHECK(device.read().ok());
}

TEST_CASE("a reconnection starts a new guard for one that is gone") {
    EmulatedBoard board(haply_machine(), guided_hand());
    auto own = std::make_unique<GuardProcess>(GuardTiming{.alive_ms = 300});
    const GuardProcess& guard = *own;
    BoardDevice device(haply_machine(), std::make_unique<SerialLink>(board.path()), haply_line,
                       std::move(own), {.silence = 5.0});
    const pid_t first = guard.id();
    kill(first, SIGKILL);
    CHECK(eventually([&] { return device.read().fault == DeviceFault::unguarded; }));
    CHECK(eventually([&] { return device.reconnect(); }));
    CHECK(guard.id() != first);
    CHECK(kill(first, 0) != 0);
    CHECK_FALSE(gone(guard.id()));
    CHECK(board.journal().setups >= 1);  // a busy machine may need a second
}

TEST_CASE("however long a guard spoke with the board alone, its answers do not cost the place") {
    EmulatedBoard board(haply_machine(), guided_hand());
    auto own = std::make_unique<GuardProcess>(GuardTiming{.wait_ms = 1, .alive_ms = 5000});
    const GuardProcess& guard = *own;
    BoardDevice device(haply_machine(), std::make_unique<SerialLink>(board.path()), haply_line,
                       std::move(own), {.silence = 5.0});
    REQUIRE(eventually([&] {
        static_cast<void>(device.read());
        device.write({0.3, 0.3, 0.0});
        return !board.motors().off();
    }));
    REQUIRE(eventually([&] { return guard.tripped(); }));
    std::this_thread::sleep_for(std::chrono::seconds(4));  // 30 kB of answers, more or less
    CHECK(device.read().fault == DeviceFault::held);
    CHECK(device.prove_zero());
    CHECK(eventually([&] { return device.reconnect(); }));
    CHECK(device.homings() == 0);
    CHECK(device.read().ok());
}

TEST_CASE("a guard sets up a board that has lost its address, and zeroes it then") {
    EmulatedBoard board(haply_machine(), guided_hand());
    const BoardBytes setup =
        setup_packet(haply_setup(*haply_machine().haply, haply_machine().pantograph));
    const pid_t careless = in_a_child([&] {
        SerialLink link(board.path());
        GuardProcess guard;
        if (link.reopen() && guard.watch(link.descriptor(), {.zero = *torque_packet(5, {0.0, 0.0}),
                                                             .setup = setup,
                                                             .answer = {.bytes = {5}, .size = 1},
                                                             .answer_size = 9})) {
            for (const BoardBytes& packet :
                 {setup, *torque_packet(5, {0.05, -0.05}), reset_packet(5)}) {
                link.pause(5'000'000);
                static_cast<void>(link.send(packet.view()));
            }
        }
        while (true) {
            wait_a_little();
        }
    });
    CHECK(eventually([&] { return board.journal().resets > 0; }));
    CHECK_FALSE(board.motors().off());  // and a zero torque cannot reach them
    kill(careless, SIGKILL);
    waitpid(careless, nullptr, 0);
    CHECK(off(board));
    CHECK(stays_off(board));
}

TEST_CASE("a guard that is to repeat zeros does so while its driver sleeps, whoever else speaks") {
    EmulatedBoard board(haply_machine(), guided_hand());
    const int stranger =
        open(board.path().c_str(), O_WRONLY | O_NOCTTY);  // before TIOCEXCL bars it
    REQUIRE(stranger >= 0);
    const auto device = open_haply(board.path(), haply_machine());  // nobody ticks yet
    REQUIRE(board.motors().off());
    const BoardBytes foreign = *torque_packet(5, {0.1, 0.1});
    const auto sent = [&] {
        static_cast<void>(write(stranger, foreign.bytes.data(), foreign.size) < 0);
        return !board.motors().off();
    };
    CHECK(eventually(sent));
    for (int ms = 0; ms < 5000 && !board.motors().off(); ++ms) {
        wait_a_little();
    }
    CHECK(board.motors().off());
    close(stranger);
}
