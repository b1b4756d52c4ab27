#include "ui/rig/device_choice.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::ui;

TEST_CASE("a device is read as it is written, also a replay of a file with colons", "[cli]") {
    CHECK(parse_device("sim").kind == DeviceChoice::Kind::simulated);
    CHECK(parse_device("mouse").kind == DeviceChoice::Kind::mouse);
    const DeviceChoice whole = parse_device("replay:a.sqlite");
    CHECK(whole.kind == DeviceChoice::Kind::replay);
    CHECK(whole.file == "a.sqlite");
    CHECK_FALSE(whole.trial.has_value());
    const DeviceChoice one = parse_device("replay:C:my:12.sqlite:7");
    CHECK(one.file == "C:my:12.sqlite");
    CHECK(one.trial == 7);
    CHECK(parse_device("replay:a:b").file == "a:b");
    CHECK(parse_device("replay:a:").file == "a:");
    CHECK(parse_device("haply-emulator").kind == DeviceChoice::Kind::haply_emulator);
    const DeviceChoice board = parse_device("haply:/dev/ttyACM0");
    CHECK(board.kind == DeviceChoice::Kind::haply);
    CHECK(board.file == "/dev/ttyACM0");
    CHECK(parse_device("board:/dev/ttyUSB0").kind == DeviceChoice::Kind::board);
    CHECK(parse_device("board:/dev/ttyUSB0").file == "/dev/ttyUSB0");
    CHECK(parse_device("comedi:/dev/comedi0").kind == DeviceChoice::Kind::comedi);
    CHECK(parse_device("comedi:/dev/comedi0").file == "/dev/comedi0");
    for (const char* wrong : {"", "simulated", "replay", "replay:", "haply",
                              "haply:", "haplyX:/dev/x", "board:", "comedi:"}) {
        CHECK_THROWS_WITH(parse_device(wrong), Has(wrong, std::string(kDeviceWords)));
    }
}

TEST_CASE("a study that asks for a device fits that one alone, and one that asks for any fits all",
          "[cli][law]") {
    using Kind = DeviceChoice::Kind;
    using palpate::protocols::DeviceClass;
    for (const Kind kind : {Kind::simulated, Kind::mouse, Kind::replay, Kind::haply,
                            Kind::haply_emulator, Kind::board, Kind::comedi}) {
        CHECK(fits(DeviceClass::any, kind));
        CHECK(fits(DeviceClass::haply, kind) == (kind == Kind::haply));
        CHECK(fits(DeviceClass::comedi, kind) == (kind == Kind::comedi));
        CHECK(fits(DeviceClass::board, kind) == (kind == Kind::board));
        CHECK(fits(DeviceClass::mouse, kind) == (kind == Kind::mouse));
    }
}
