#include <iostream>

#include "engine/device/drivers/serial_link.hpp"
#include "tests/bench/commands.hpp"
#include "tests/bench/report.hpp"
#include "tests/support/emulated_machine.hpp"

#if defined(PALPATE_BENCH_WINDOW)
#include "tests/support/stop_ways.hpp"
#endif

namespace palpate::bench {
namespace {

using namespace palpate::engine;

/// @throws std::runtime_error unless `seen`
void need(bool seen, const char* else_what) {
    if (!seen) {
        throw std::runtime_error(else_what);
    }
}

constexpr const char* kNoTorque = "the emulated board got no torque";
constexpr const char* kStaysOn = "the motors stayed on";

/// Since `start`, ms, until the board had no torque.
double ms_to_zero(const EmulatedBoard& board, std::int64_t start) {
    return 1e-6 * static_cast<double>(board.motors().since_ns - start);
}

/// ms from the signal to zero torque at the board, for each kill.
/// @param both  palpate's guard is killed a moment before: only the board itself is left
std::vector<double> delays(
    const EmulatedBoard& board, const Calibration& machine, int kills, int signal, bool both) {
    std::vector<double> ms;
    tests::Random random(1);
    for (int i = 0; i < kills; ++i) {
        tests::Presser presser(board.path(), machine, {0.4, -0.5});
        need(tests::eventually([&] { return !board.motors().off(); }), kNoTorque);
        for (int wait = random.below(30); wait > 0; --wait) {
            tests::wait_a_little();
        }
        const std::int64_t start = monotonic_ns();
        if (both) {
            kill(presser.guard(), SIGKILL);
        }
        presser.signal(signal);
        need(tests::eventually([&] { return board.motors().off(); }), kStaysOn);
        ms.push_back(ms_to_zero(board, start));
        presser.signal(SIGKILL);
        presser.reap();
        SerialLink port(board.path());
        tests::eventually([&] { return port.reopen(); });  // the guard has let go of it
    }
    std::sort(ms.begin(), ms.end());
    return ms;
}

#if defined(PALPATE_BENCH_WINDOW)
constexpr bool kWindow = true;

void print(const std::string& name, const std::vector<double>& ms);

/// ms from what somebody does until the board has no torque, for every way to stop, window and all.
void stops(int times) {
    const tests::TemporaryFolder folder;
    const tests::Terminal terminal;
    tests::StopButton button(folder.file("button"));
    using Desk = tests::PressedDesk;
    const auto hand = [](Desk& desk) -> tests::XHand& {
        return desk.session->hand();
    };
    const auto none = [] {
    };
    struct Way {
        const char* name;
        std::function<void(Desk&)> act;
        std::function<void()> undo;
    };
    for (const auto& [name, act, undo] :
         {Way{"Escape at the window", [&](Desk& desk) { hand(desk).key("Escape"); }, none},
          Way{"Escape at the terminal", [&](Desk&) { terminal.type("\x1b"); }, none},
          Way{"Enter at the terminal", [&](Desk&) { terminal.type("\n"); }, none},
          Way{"palpate stop",
              [](Desk& desk) {
                  static_cast<void>(tests::palpate_command({"stop", desk.file}));
              },
              none},
          Way{"stop button", [&](Desk&) { button.send(1); },
              [&] {
                  button.send(0);
              }},
          Way{"stop button unplugged", [&](Desk&) { button.unplug(); },
              [&] {
                  button.plug_in();
              }},
          Way{"keyboard taken away", [&](Desk& desk) { hand(desk).take_keyboard_away(); }, none},
          Way{"window to be closed",
              [&](Desk& desk) { hand(desk).ask_to_close(hand(desk).find_window("palpate: ")); },
              none}}) {
        Desk desk(tests::PressingHand::Does::presses,
                  {std::string(tests::kTerminal) + "=" + terminal.name()}, false,
                  {"--stop-button", folder.file("button")});
        std::vector<double> ms;
        for (int i = 0; i < times; ++i) {
            need(desk.feel(), kNoTorque);
            const std::int64_t start = monotonic_ns();
            act(desk);
            need(desk.force_ends(), kStaysOn);
            ms.push_back(ms_to_zero(desk.board, start));
            hand(desk).release("space");
            undo();
            desk.goes_on();
        }
        std::sort(ms.begin(), ms.end());
        print(name, ms);
    }
}

/// The same of the whole program in its window: what it has in memory takes time to be freed.
std::vector<double> windowed_delays(int kills) {
    std::vector<double> ms;
    for (int i = 0; i < kills; ++i) {
        tests::PressedDesk desk(tests::PressingHand::Does::presses);
        need(desk.feel(), kNoTorque);
        const std::int64_t start = monotonic_ns();
        desk.session->program().signal(SIGKILL);
        need(desk.force_ends(), kStaysOn);
        ms.push_back(ms_to_zero(desk.board, start));
    }
    std::sort(ms.begin(), ms.end());
    return ms;
}

/// How long a hand keeps its force on a busy machine, in `runs` sessions one after the other.
/// @param seconds  as much as is looked for in each
/// @param busy     programs beside it that never rest
int held(double seconds, int runs, int busy) {
    int broken = 0;
    for (int run = 0; run < runs; ++run) {
        tests::PressedDesk desk(tests::PressingHand::Does::presses);
        need(desk.feel(), kNoTorque);
        const std::vector<std::string> rests_never{"sh", "-c", "while :; do :; done"};
        std::vector<std::unique_ptr<tests::Process>> others;
        for (int i = 0; i < busy; ++i) {
            others.push_back(std::make_unique<tests::Process>(rests_never));
        }
        const std::int64_t start = monotonic_ns();
        const auto since = [&] {
            return 1e-9 * static_cast<double>(monotonic_ns() - start);
        };
        // A hand that turns back or lets up has no force for a moment: what counts is a fault.
        const auto fault = [&] {
            return desk.session->ask(
                "SELECT group_concat(fault_cause) FROM trial WHERE fault_cause <> ''");
        };
        while (since() < seconds && fault().empty()) {
            tests::pause(0.1);
        }
        const std::string cause = fault();
        broken += cause.empty() ? 0 : 1;
        std::printf("%-34s %7d %9.3f %s\n", "held, s", busy, since(),
                    cause.empty() ? "no fault" : cause.c_str());
        std::fflush(stdout);
        for (const auto& other : others) {
            other->signal(SIGKILL);
        }
    }
    return broken;
}

#else
constexpr bool kWindow = false;

std::vector<double> windowed_delays(int /*kills*/) {
    return {};
}

int held(double /*seconds*/, int /*runs*/, int /*busy*/) {
    throw WrongWord("--hold needs a window: not built, libxtst-dev is missing");
}

void stops(int /*times*/) {
    throw WrongWord("--stops needs a window: not built, libxtst-dev is missing");
}
#endif

double at(const std::vector<double>& ms, double share) {
    return ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1))];
}

void print(const std::string& name, const std::vector<double>& ms) {
    std::printf("%-34s %7zu %9.3f %9.3f %9.3f\n", name.c_str(), ms.size(), at(ms, 0.5),
                at(ms, 0.99), ms.back());
    std::fflush(stdout);
}

constexpr const char* kHead = "%-34s %7s %9s %9s %9s\n";

}  // namespace

int guard_command(Words words) {
    const auto number = [&](const char* name, double otherwise) {
        return static_cast<int>(words.number(name, otherwise, otherwise > 0.0 ? 1 : 0, 1e6));
    };
    const int kills = number("--kills", 100);
    const std::string csv_name = words.value("--csv");
    const int hold = number("--hold", 0);
    const int busy = number("--busy", 2);
    const int stopped = number("--stops", 0);
    words.finish();
    if (stopped > 0) {
        std::cout << machine() << "\nfrom what somebody does to zero torque, in its window, ms\n";
        std::printf(kHead, "stop", "times", "p50", "p99", "worst");
        stops(stopped);
        return 0;
    }
    if (hold > 0) {
        std::cout << machine() << "\nforce in its window on a busy machine, three sessions\n";
        std::printf("%-34s %7s %9s\n", "palpate", "busy", "s");
        return held(hold, 3, busy) == 0 ? 0 : 1;
    }
    Output csv(csv_name, "machine,end,kills,p50_ms,p99_ms,worst_ms\n");
    const Calibration haply = tests::emulated_calibration();
    const Calibration open = tests::open_machine();
    const auto hand = [&] {
        return std::make_unique<tests::GuidedHand>(haply);
    };
    const EmulatedBoard haply_board(haply, hand);
    const EmulatedBoard open_board(open, hand, {}, make_open_board);
    std::cout << machine() << "\nfrom a signal to zero torque at an emulated board, ms\n";
    std::printf(kHead, "palpate", "times", "p50", "p99", "worst");
    struct End {
        const char* name;
        int signal;
        bool open = false;
        bool both = false;
    };
    for (const auto& [name, signal, is_open, both] :
         {End{"killed (kill -9)", SIGKILL}, End{"stopped with the force on", SIGSTOP},
          End{"open board: killed", SIGKILL, true},
          End{"open board: killed with its guard", SIGKILL, true, true},
          End{"killed, in its window", 0}}) {
        std::cout.flush();
        std::fflush(stdout);
        if (signal == 0 && !kWindow) {
            std::printf("%-34s %7s\n", name, "not built: libxtst-dev is missing");
            continue;
        }
        const std::vector<double> ms = signal == 0
                                         ? windowed_delays(kills)
                                         : delays(is_open ? open_board : haply_board,
                                                  is_open ? open : haply, kills, signal, both);
        print(name, ms);
        csv << '"' << machine() << "\",\"" << name << "\"," << kills << ',' << at(ms, 0.5) << ','
            << at(ms, 0.99) << ',' << ms.back() << '\n';
    }
    csv.finish();
    return 0;
}

}  // namespace palpate::bench
