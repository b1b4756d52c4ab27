#pragma once

#include <cstdlib>

#include "engine/device/emulator/open_board.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/emulated_machine.hpp"
#include "tests/support/random.hpp"

#if defined(PALPATE_FIRMWARE_328P)
#include "tests/firmware/sim_board.hpp"
#endif

namespace palpate::tests {

/// The firmware's portable part on this machine's processor.
struct OnHost {
    using Board = engine::OpenBoard;
    static Board make(engine::BoardPlant& plant, const engine::Calibration& machine) {
        return Board(plant, machine, *machine.board);
    }
};

#if defined(PALPATE_FIRMWARE_328P)
/// A mutant may stand in for the firmware.
inline std::string firmware_or(const char* elf) {
    const char* other = std::getenv("PALPATE_FIRMWARE");
    return other == nullptr ? elf : other;
}

/// The whole firmware on an ATmega328P in simavr.
struct On328p {
    using Board = SimBoard;
    static Board make(engine::BoardPlant& plant, const engine::Calibration& machine) {
        return Board(plant, machine, *machine.board, kAtmega328p,
                     firmware_or(PALPATE_FIRMWARE_328P));
    }
};

/// The same on an ATmega2560.
struct On2560 {
    using Board = SimBoard;
    static Board make(engine::BoardPlant& plant, const engine::Calibration& machine) {
        return Board(plant, machine, *machine.board, kAtmega2560, PALPATE_FIRMWARE_2560);
    }
};

/// The firmware of three axes on an ATmega2560.
struct On2560Of3 {
    using Board = SimBoard;
    static Board make(engine::BoardPlant& plant, const engine::Calibration& machine) {
        const char* mutant = std::getenv("PALPATE_FIRMWARE_OF_3");
        return Board(plant, machine, *machine.board, kAtmega2560,
                     mutant == nullptr ? PALPATE_FIRMWARE_2560_OF_3 : mutant);
    }
};
#endif

/// A host that says what it likes to a board, and hears every answer.
template <class On, class Plant = GuidedHand>
struct Talk {
    explicit Talk(const engine::Calibration& of = open_machine()) : machine(of) { pass_ms(20); }

    engine::Calibration machine;
    Plant plant{machine};
    typename On::Board board = On::make(plant, machine);
    std::uint16_t seq = 0;
    static constexpr std::uint16_t kToken = 0x1234;

    void pass_ms(double ms) {
        const double end = board.time() + 1e-3 * ms;
        while (board.time() < end - 1e-9) {
            board.poll();
            hear();
        }
    }
    void send(std::span<const std::uint8_t> bytes) { board.receive(bytes); }
    /// Sends a body and waits for its answer. @return none: there was none within 3 ms
    std::optional<engine::OpenAnswer> ask(const engine::BoardBytes& body) {
        answers.clear();
        send(engine::open_frame(body).view());
        for (int i = 0; i < 60 && answers.empty(); ++i) {
            board.poll();
            hear();
        }
        return answers.empty() ? std::nullopt : std::optional(answers.front());
    }
    std::optional<engine::OpenAnswer> hello() { return ask(engine::open_hello(++seq)); }
    std::optional<engine::OpenAnswer> config(const engine::OpenConfig& config) {
        return ask(engine::open_config(++seq, config));
    }
    std::optional<engine::OpenAnswer> arm(std::uint16_t token = kToken) {
        return ask(engine::open_token(engine::OpenType::arm, ++seq, token));
    }
    std::optional<engine::OpenAnswer> clear(std::uint16_t token = kToken) {
        return ask(engine::open_token(engine::OpenType::clear, ++seq, token));
    }
    std::optional<engine::OpenAnswer> disarm() {
        return ask(engine::open_bare(engine::OpenType::disarm, engine::kGuardSeq));
    }
    engine::OpenReport peek() {
        const auto answer = ask(engine::open_bare(engine::OpenType::peek, ++seq));
        return answer && answer->type == engine::OpenType::state ? answer->report
                                                                 : engine::OpenReport{};
    }
    std::optional<engine::OpenAnswer> torque(std::int32_t one,
                                             std::int32_t two,
                                             std::int32_t three = 0) {
        return ask(engine::open_torque(++seq, {one, two, three}, machine.axes()));
    }
    /// Up to the state with motors on.
    void make_ready(std::uint8_t watchdog_ms = 20, std::int32_t limit = 123000) {
        hello();
        config({.token = kToken,
                .watchdog_ms = watchdog_ms,
                .limit = {limit, limit, machine.axes() > 2 ? limit : 0},
                .axes = machine.axes()});
        arm();
    }
    /// A torque each millisecond for `ms`. @return how long answers took, ms, the slowest last
    std::vector<double> talk_at_1_khz(int ms) {
        std::vector<double> took;
        for (int i = 0; i < ms; ++i) {
            const double begin = board.time();
            if (torque(60000, -60000, 60000)) {
                took.push_back(1e3 * (board.time() - begin));
            }
            pass_ms(std::max(0.05, 1.0 - 1e3 * (board.time() - begin)));
        }
        std::sort(took.begin(), took.end());
        return took;
    }
    /// ms until the enable line is low, at a step of 50 us; at most `max`.
    double until_off(double max) {
        const double begin = board.time();
        while (board.enabled() && board.time() - begin < 1e-3 * max) {
            board.poll();
            hear();
        }
        return 1e3 * (board.time() - begin);
    }

    std::vector<engine::OpenAnswer> answers;

private:
    void hear() {
        std::array<std::uint8_t, 256> bytes{};
        const std::size_t got = board.transmit(bytes);
        for (std::size_t i = 0; i < got; ++i) {
            if (const auto answer = engine::read_open(reader_.take(bytes[i]))) {
                answers.push_back(*answer);
            }
        }
    }

    engine::OpenReader reader_;
};

/// Asks an armed board for torques at the ends of their range and anywhere, uN m: each axis gives
/// what is asked, to its step, within its own limit, and flags what was cut.
template <class ArmedTalk>
void obeys_torques(ArmedTalk& talk, const engine::OpenAxes& limit, double step) {
    constexpr std::array<std::uint16_t, 3> kClamped{1U << 2U, 1U << 3U, 1U << 10U};
    constexpr std::array<std::int32_t, 11> kEnds{
        0, -1, 1, 30000, -30001, 60001, -80001, 80000, 100000, 2147483647, -2147483647 - 1};
    const std::size_t axes = talk.machine.axes();
    Random random(7);
    for (int i = 0; i < 80; ++i) {
        const auto pick = [&] {
            return i < 30 ? kEnds[random.index(kEnds.size())]
                          : static_cast<std::int32_t>(random.in(-120000.0, 120000.0));
        };
        const engine::OpenAxes asked{pick(), pick(), axes == 3 ? pick() : 0};
        CAPTURE(asked);
        const auto answer = talk.torque(asked[0], asked[1], asked[2]);
        REQUIRE(answer);
        REQUIRE(answer->type == engine::OpenType::state);
        CHECK(answer->report.state == engine::OpenState::armed);
        CHECK(answer->report.axes == axes);
        const engine::Vec3 given = 1e6 * talk.board.torque();
        for (std::size_t k = 0; k < axes; ++k) {
            const double want = std::clamp(asked[k], -limit[k], limit[k]);
            const double got = given[static_cast<int>(k)];
            CHECK(std::fabs(got) <= std::fabs(want) + 1e-6);
            CHECK(std::fabs(got - want) <= step);
            CHECK(got * want >= 0.0);
            CHECK(((answer->report.flags & kClamped[k]) != 0) == (want != asked[k]));
        }
    }
}

#if defined(PALPATE_FIRMWARE_328P)
constexpr double kStill = 1e-9;  ///< counts/s: an encoder stays where it is

/// While encoders turn at `speeds`, counts/s, and a host talks for `ms`, no count, byte or answer
/// is lost, and the answers are in time.
template <class ReadyTalk>
void counts_edges(ReadyTalk& talk, std::span<const double> speeds, int ms) {
    const engine::OpenReport first = talk.peek();
    std::vector<std::int64_t> before;
    for (std::size_t i = 0; i < speeds.size(); ++i) {
        before.push_back(talk.board.edges(i));
        talk.board.spin(i, speeds[i]);
    }
    const std::vector<double> took = talk.talk_at_1_khz(ms);
    for (std::size_t i = 0; i < speeds.size(); ++i) {
        talk.board.spin(i, kStill);
    }
    talk.pass_ms(1);
    const engine::OpenReport last = talk.peek();
    REQUIRE(took.size() == static_cast<std::size_t>(ms));
    CHECK(took.back() < 1.0);
    for (std::size_t i = 0; i < speeds.size(); ++i) {
        const std::int64_t turned = talk.board.edges(i) - before[i];
        CHECK(last.counts[i] - first.counts[i] == turned);
        CHECK(std::fabs(static_cast<double>(turned)) > 0.9e-3 * ms * std::fabs(speeds[i]));
    }
    CHECK((last.flags & (engine::kOpenSkippedEdge | engine::kOpenLostBytes)) == 0);
    CHECK(last.bad_frames == 0);
}

/// What a chip comes to that is ready and whose encoders turn at `speed` counts/s each.
template <class ReadyTalk>
std::string numbers_at(double speed, ReadyTalk& talk) {
    for (std::size_t i = 0; i < talk.machine.axes(); ++i) {
        talk.board.spin(i, speed);
    }
    const std::uint64_t cycles = talk.board.cycles();
    const std::uint64_t slept = talk.board.slept();
    const auto took = talk.talk_at_1_khz(300);
    const double load = 1.0 - static_cast<double>(talk.board.slept() - slept) /
                                  static_cast<double>(talk.board.cycles() - cycles);
    return fmt::format(
        "{} counts/s each: load {} %, answers after {} to {} ms, {} of 300, flags {}", speed,
        100.0 * load, took[took.size() / 2], took.back(), took.size(), talk.peek().flags);
}
#endif

}  // namespace palpate::tests
