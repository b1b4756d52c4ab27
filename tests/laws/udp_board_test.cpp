#include <atomic>
#include <csignal>
#include <filesystem>
#include <thread>

#include "engine/device/drivers/udp_link.hpp"
#include "engine/device/open/open_wire.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/process.hpp"
#include "tests/support/udp_port.hpp"

using namespace palpate;
using Catch::Matchers::ContainsSubstring;
using tests::eventually;
using tests::Finished;
using tests::free_udp_port;
using tests::palpate_command;
using tests::palpate_program;
using tests::Process;
using tests::TemporaryFolder;

// The shipped program and a device that is another program, behind a UDP port.

namespace {

std::string doctor(const TemporaryFolder& folder,
                   const std::string& device,
                   const std::string& calibration) {
    const std::string out =
        palpate_command({"doctor", "--device", "board:" + device, "--calibration", calibration,
                         "--seconds", "0.05", "--json", "--db", folder.file("d.sqlite")})
            .out;
    return out.substr(0, out.find("kinematics"));
}

/// A busy machine may leave the device without its turn: then once more.
std::string doctor_in_the_end(const TemporaryFolder& folder,
                              const std::string& device,
                              const std::string& calibration) {
    std::string said;
    for (int i = 0; i < 20 && said.find("answers after") == std::string::npos; ++i) {
        said = doctor(folder, device, calibration);
    }
    return said;
}

}  // namespace

TEST_CASE("the doctor takes a device behind UDP, emulated or the example, and says where nobody is",
          "[laws][open][doctor]") {
    const TemporaryFolder folder;
    Process emulator({palpate_program(), "haply-emulator", "--open", "--udp", "0"});
    REQUIRE(eventually([&] { return emulator.out().find('\n') != std::string::npos; }));
    std::string device = emulator.out();
    device.pop_back();
    CHECK_THAT(device, Catch::Matchers::StartsWith("udp:127.0.0.1:"));
    CHECK_THAT(doctor_in_the_end(folder, device, "2diy_gen3"),
               ContainsSubstring("its own watchdog stops it after 20 ms"));
    emulator.signal(SIGINT);
    CHECK(emulator.wait().code == 0);
    CHECK_THAT(doctor(folder, device, "2diy_gen3"),
               ContainsSubstring("does the device's program run there"));

    const std::string port = std::to_string(free_udp_port());
    const Process example({PALPATE_UDP_DEVICE, port});
    const std::string calibration = PALPATE_SOURCE_DIR "/examples/udp_device.toml";
    CHECK_THAT(doctor_in_the_end(folder, "udp:127.0.0.1:" + port, calibration),
               ContainsSubstring("its own watchdog stops it after 20 ms"));
    CHECK(Process({PALPATE_UDP_DEVICE, port}).wait().code == 2);  // taken
}

TEST_CASE(
    "a stranger at a UDP port is distinguished from a cable, and a board that is in use from a "
    "silent one",
    "[laws][open][doctor]") {
    const TemporaryFolder folder;
    const std::uint16_t number = free_udp_port();
    const std::string port = std::to_string(number);
    const Process example({PALPATE_UDP_DEVICE, port});
    const std::string calibration = PALPATE_SOURCE_DIR "/examples/udp_device.toml";
    std::atomic<bool> there{true};
    std::thread stranger([&] {
        engine::UdpLink link({.host = "127.0.0.1", .port = port});
        while (there && !link.reopen()) {
        }
        for (std::uint16_t seq = 1; there; ++seq) {
            static_cast<void>(link.send(engine::open_datagram({}, engine::open_hello(seq)).view()));
            link.pause(50'000'000);
        }
    });
    CHECK(eventually([&] {
        return doctor(folder, "udp:127.0.0.1:" + port, calibration)
                   .find("another program speaks to the board") != std::string::npos;
    }));
    there = false;
    stranger.join();
    CHECK_THAT(doctor_in_the_end(folder, "udp:127.0.0.1:" + port, calibration),
               ContainsSubstring("its own watchdog stops it after 20 ms"));
}

TEST_CASE("words of a UDP port that cannot be are refused with a sentence, before a file is made",
          "[laws][open]") {
    const TemporaryFolder folder;
    for (const char* wrong : {"board:udp:rig", "board:udp::5000", "board:udp:rig:99999"}) {
        const Finished run = palpate_command({"run", "shape_friction_demo", "--participant", "P1",
                                              "--db", folder.file("d.sqlite"), "--device", wrong});
        CHECK(run.code == 2);
        CHECK_THAT(run.error, ContainsSubstring("as in udp:127.0.0.1:5000"));
    }
    CHECK(folder.names().empty());
    CHECK(palpate_command({"haply-emulator", "--udp", "5000"}).code == 2);
    CHECK(palpate_command({"haply-emulator", "--open", "--udp", "70000"}).code == 2);
}
