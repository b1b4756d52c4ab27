#include <csignal>
#include <filesystem>

#include "engine/device/emulator/emulated_haply.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/presser.hpp"
#include "tests/support/process.hpp"

using namespace palpate::tests;
using Catch::Matchers::ContainsSubstring;
namespace engine = palpate::engine;

TEST_CASE("palpate haply-emulator is a board that a driver can use, until it is interrupted",
          "[laws][haply]") {
    const TemporaryFolder folder;
    const std::string link = folder.file("board");
    Process emulator({palpate_program(), "haply-emulator", "--link", link, "--preset", "gen2"});
    REQUIRE(eventually([&] { return std::filesystem::exists(link); }));
    {
        const auto device = engine::open_haply(link, engine::emulated_calibration("gen2"),
                                               {.patience = 200.0, .silence = 10.0});
        const engine::Reading reading = device->read();
        CHECK(reading.fresh);
        CHECK(glm::length(reading.hip - engine::Vec2{0.0, 0.060}) < 1e-4);
    }
    emulator.signal(SIGINT);
    const Finished finished = emulator.wait();
    CHECK(finished.code == 0);
    CHECK(finished.out == link + "\n");
    CHECK_FALSE(std::filesystem::is_symlink(link));
}

TEST_CASE("an emulator that cannot be is refused with a sentence", "[laws][haply]") {
    const Finished preset = palpate_command({"haply-emulator", "--preset", "gen9"});
    CHECK(preset.code == 2);
    CHECK_THAT(preset.error, ContainsSubstring("there are gen3, gen2 and haplet"));
    const Finished link = palpate_command({"haply-emulator", "--link", "/proc/no/such/place"});
    CHECK(link.code == 1);
    CHECK_THAT(link.error, ContainsSubstring("name a file in a folder that you may write"));
}
