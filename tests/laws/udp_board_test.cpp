#include "engine/device/drivers/udp_link.hpp"
#include "engine/device/open/open_wire.hpp"
#include "tests/support/free_board.hpp"
#include "tests/support/pressed_desk.hpp"
#include "tests/support/program.hpp"
#include "tests/support/udp_port.hpp"

// The shipped program and a device that is another program, behind a UDP port.

namespace {

/// What no host sends: any bytes, a 01 and no CRC behind it, or a right body with one wrong bit.
std::vector<std::uint8_t> spoilt(std::mt19937& rng) {
    const auto below = [&](std::size_t n) {
        return std::uniform_int_distribution<std::size_t>(0, n - 1)(rng);
    };
    const std::size_t kind = below(3);
    if (kind == 2) {
        const auto right = engine::open_datagram(
            {}, below(2) == 0 ? engine::open_hello(1) : engine::open_torque(1, {30'000, 30'000}));
        std::vector<std::uint8_t> bytes(right.view().begin(), right.view().end());
        const std::size_t bit = below(8 * (bytes.size() - engine::kOpenNonce));
        bytes[engine::kOpenNonce + bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
        return bytes;
    }
    std::vector<std::uint8_t> bytes(1 + below(1400));
    for (std::uint8_t& byte : bytes) {
        byte = static_cast<std::uint8_t>(below(256));
    }
    bytes[kind == 1 ? std::min(engine::kOpenNonce, bytes.size() - 1) : 0] = 0x01;
    return bytes;
}

/// Torques in the name of a session's own port, each 200th number, with nonces by chance.
void speak_as(std::uint16_t host, std::uint16_t board, std::mt19937& rng) {
    for (std::uint16_t i = 0; i < 328; ++i) {
        engine::OpenNonce nonce{};
        std::generate(nonce.begin(), nonce.end(), [&] { return rng() & 0xFFU; });
        const auto torque =
            engine::open_torque(static_cast<std::uint16_t>(200 * i), {30'000, 30'000});
        if (!send_as(host, board, engine::open_datagram(nonce, torque).view())) {
            WARN("this user may send nothing in another program's name: not tried");
            return;
        }
        if (i % 5 == 0) {
            wait_a_little();
        }
    }
}

}  // namespace

TEST_CASE("the doctor takes a device behind UDP, emulated or the example, and says where nobody is",
          "[open]") {
    const TemporaryFolder folder;
    Process emulator({palpate_program(), "haply-emulator", "--open", "--udp", "0"});
    REQUIRE(eventually([&] { return emulator.out().find('\n') != std::string::npos; }));
    std::string device = emulator.out();
    device.pop_back();
    CHECK_THAT(device, StartsWith("udp:127.0.0.1:"));
    CHECK_THAT(doctored(folder, "board:" + device, "2diy_gen3", "answers after"),
               Has("its own watchdog stops it after 20 ms"));
    CHECK(emulator.ended_by(SIGINT) == 0);
    CHECK_THAT(doctored(folder, "board:" + device, "2diy_gen3"),
               Has("does the device's program run there"));

    const std::string port = std::to_string(free_port());
    const Process example({PALPATE_UDP_DEVICE, port});
    const std::string calibration = PALPATE_SOURCE_DIR "/examples/udp_device.toml";
    CHECK_THAT(doctored(folder, "board:udp:127.0.0.1:" + port, calibration, "answers after"),
               Has("its own watchdog stops it after 20 ms"));
    CHECK(Process({PALPATE_UDP_DEVICE, port}).wait().code == 2);  // taken
}

TEST_CASE(
    "a stranger at a UDP port is distinguished from a cable, and a board that is in use from a "
    "silent one",
    "[open]") {
    const TemporaryFolder folder;
    const std::uint16_t number = free_port();
    const std::string port = std::to_string(number);
    const Process example({PALPATE_UDP_DEVICE, port});
    const std::string calibration = PALPATE_SOURCE_DIR "/examples/udp_device.toml";
    std::atomic<bool> there{true};
    std::atomic<bool> whole{true};
    std::thread stranger([&] {
        engine::UdpLink link({.host = "127.0.0.1", .port = port});
        while (there && !link.reopen()) {
        }
        for (std::uint16_t seq = 1; there; ++seq) {
            engine::BoardBytes hello = engine::open_datagram({}, engine::open_hello(seq));
            hello.bytes[hello.size - 1] ^= static_cast<std::uint8_t>(whole ? 0 : 1);
            static_cast<void>(link.send(hello.view()));
            link.pause(50'000'000);
        }
    });
    CHECK(eventually([&] {
        return doctored(folder, "board:udp:127.0.0.1:" + port, calibration)
                   .find("another program speaks to the board") != std::string::npos;
    }));
    whole = false;  // a HELLO without a right CRC makes nobody the host
    CHECK_THAT(doctored(folder, "board:udp:127.0.0.1:" + port, calibration, "answers after"),
               Has("its own watchdog stops it after 20 ms"));
    there = false;
    stranger.join();
    CHECK_THAT(doctored(folder, "board:udp:127.0.0.1:" + port, calibration, "answers after"),
               Has("its own watchdog stops it after 20 ms"));
}

TEST_CASE("a hand is felt over UDP as over a cable, whoever else speaks to the board",
          "[window][open]") {
    const TemporaryFolder folder;
    TypedTo typed(folder, "keys", "haply-emulator --open --udp 0");
    const Process& emulator = typed.program();
    REQUIRE(eventually([&] { return emulator.out().find('\n') != std::string::npos; }));
    std::ofstream(folder.file("p.toml"))
        << replaced(pressed_study(), "dead_man = true", "dead_man = false");
    const std::string file = folder.file("d.sqlite");
    const std::string name = emulator.out().substr(0, emulator.out().find('\n'));
    WindowSession session(
        run_words(folder.file("p.toml"), "P1", file, {"--device", "board:" + name, "--windowed"}));
    session.press_at("welcome", "space");
    const auto felt = [&] {
        return session.ask(
            "SELECT count(*) > 0 FROM trial WHERE outcome = 'complete' AND "
            "max_normal_force_n > 0.1");
    };
    // Whoever else speaks to the port meanwhile is nobody: no nonce of his is the session's.
    const std::string port = name.substr(name.rfind(':') + 1);
    const auto board = static_cast<std::uint16_t>(std::stoi(port));
    session.wait_for_screen("ready");
    const std::uint16_t host = host_of(board);
    REQUIRE(host != 0);
    engine::UdpLink stranger({.host = "127.0.0.1", .port = port});
    REQUIRE(eventually([&] { return stranger.reopen(); }));
    std::mt19937 rng{28};
    for (int i = 0; i < 3000; ++i) {
        static_cast<void>(stranger.send(spoilt(rng)));
        if (i % 5 == 0) {
            wait_a_little();
        }
        if (i % 300 == 0) {
            typed.type("motors");
        }
    }
    CHECK(eventually([&] { return count_of(emulator.out(), "give 0, 0 mN m") == 10; }));
    const auto disturb = [&] {
        for (std::uint16_t seq = 1; seq <= 40; ++seq) {
            for (const engine::BoardBytes& body :
                 {engine::open_hello(seq), engine::open_bare(engine::OpenType::disarm, seq),
                  engine::open_torque(seq, {30'000, 30'000}, 2)}) {
                static_cast<void>(stranger.send(engine::open_datagram({}, body).view()));
            }
            static_cast<void>(stranger.send(spoilt(rng)));
        }
        speak_as(host, board, rng);
    };
    CHECK(session.goes_on_until([&] {
        if (session.screen_name() == "explore") {
            pause(0.7);
            disturb();
            pause(0.8);
            press_on(session.hand());
        }
        return felt() == "1";
    }));
    CHECK(session.ask("SELECT count(*) FROM trial WHERE fault_cause = 'device_garbage'") == "0");
}
