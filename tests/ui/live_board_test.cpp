#include "protocols/design/session_plan.hpp"
#include "ui/live/live_board.hpp"
#include "ui/rig/device_choice.hpp"
#include "tests/support/random.hpp"
#include "tests/support/short_text.hpp"

using namespace palpate::ui;

// What a session shows to other programs, byte for byte.

using namespace palpate::protocols;

namespace {

Protocol demo() {
    return parse_protocol(short_text("shape_friction_demo", {}), "p.toml");
}

/// All that another program can read of it, but for when its phase began.
std::vector<std::uint64_t> memory_of(const ui::LiveBoard& board) {
    std::vector<std::uint64_t> words(1U << 15U);
    const ssize_t got = pread(board.descriptor(), words.data(), words.size() * 8, 0);
    REQUIRE(got > 0);
    words.resize(static_cast<std::size_t>(got) / 8);
    words[1] = words[2] = 0;  // and how often it was written
    return words;
}

}  // namespace

TEST_CASE("two conditions that the same hand feels are shown alike, byte for byte") {
    const Protocol protocol = demo();
    const Plan plan = make_plan(protocol, "hash", {.participant = "P1", .session = 1}, 3);
    OperatorDesk desk;
    const auto felt = [&](std::size_t object, std::size_t friction) {
        return Presentation{.object = protocol.objects.at(object),
                            .friction = protocol.frictions.at(friction)};
    };
    const auto shown = [&](const Presentation& presentation, double force, bool reveals) {
        Random hand(7);  // the same
        ui::LiveBoard board({.session = R"({"session":"u"})", .gives_force = true, .left = 9},
                            protocol, plan, desk);
        TrialView view{.number = 3, .total = 9};
        if (reveals) {
            board.reveal();
        }
        board.enter(SessionStep::ready, &view);
        board.feels(presentation);
        board.enter(SessionStep::explore, &view);
        for (int i = 0; i < 3000; ++i) {
            const engine::Vec2 hip = hand.point(-0.03, 0.03);
            engine::TickRecord tick{
                .tick = i, .time_ns = i * std::int64_t{1'000'000}, .hip = {hip, 0.0}};
            tick.lateness_us = static_cast<float>(hand.in(0.0, 300.0));
            tick.force = {0.0, force, 0.0};  // and all that follows from the object
            tick.normal_force = force;
            tick.tangential_force = 0.3 * force;
            tick.cp = tick.go = tick.hip + engine::Vec3{0.0, force, 0.0};
            tick.mode = force > 1.0 ? engine::Mode::slip : engine::Mode::stuck;
            board.feel({&tick, 1});
        }
        board.enter(SessionStep::question, &view);
        return memory_of(board);
    };
    const auto one = shown(felt(0, 0), 0.5, false);
    CHECK(one == shown(felt(1, 1), 2.5, false));
    CHECK(one != shown(felt(0, 0), 0.5, true));  // there was something to hide
    CHECK(shown(felt(0, 0), 0.5, true) != shown(felt(1, 1), 2.5, true));
}

TEST_CASE("a pause and a stop that are asked for are shown before they are done") {
    const Protocol protocol = demo();
    const Plan plan = make_plan(protocol, "hash", {.participant = "P1", .session = 1}, 3);
    OperatorDesk desk;
    ui::LiveBoard board({.session = R"({"session":"u"})", .gives_force = true}, protocol, plan,
                        desk);
    const ui::LiveReader reader(board.descriptor());
    const auto shows = [&](const char* what) {
        board.look();
        return reader.state()->json.find(what) != std::string::npos;
    };
    const TrialView next{.number = 4, .total = 9};
    board.enter(SessionStep::rest, &next);
    board.enter(SessionStep::gap);
    CHECK_FALSE(shows("after trial 4"));
    board.enter(SessionStep::explore);
    CHECK(shows("\"pausing\":false"));
    CHECK(shows("\"force\":{\"on\":true"));
    desk.pause();
    CHECK(shows("\"pausing\":true"));
    desk.stop("a way");
    CHECK(shows("\"force\":{\"on\":false"));
    const std::uint64_t version = reader.version();
    board.look();
    CHECK(reader.version() == version);
}

TEST_CASE("a device is read as it is written, also a replay of a file with colons") {
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
    for (const char* wrong : {"", "simulated", "haplyX:/dev/x"}) {
        CHECK_THROWS_WITH(parse_device(wrong), Has(wrong, std::string(kDeviceWords)));
    }
    for (const std::string half : {"replay", "replay:", "haply", "haply:", "board:", "comedi:"}) {
        const std::string name = half.substr(0, half.find(':'));
        CHECK_THROWS_WITH(parse_device(half), Has("say which one, as " + name + ":"));
    }
}

TEST_CASE(
    "a study that asks for a device fits that one alone, and one that asks for any fits all") {
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

TEST_CASE("noise is said to be on from Ready to the question, between two intervals as well",
          "[live][sound][law]") {
    const Protocol protocol = demo();
    const Plan plan = make_plan(protocol, "hash", {.participant = "P1", .session = 1}, 3);
    const OperatorDesk desk;
    ui::LiveBoard board({.session = R"({"session":"u"})", .masking_db = -30.0}, protocol, plan,
                        desk);
    const ui::LiveReader reader(board.descriptor());
    TrialView view{.number = 3, .total = 9, .intervals = 2};
    std::string heard;
    using enum SessionStep;
    for (const SessionStep step :
         {welcome, ready, explore, gap, ready, explore, question, feedback, gap, rest, ready}) {
        board.enter(step, &view);
        const bool on =
            reader.state().value().json.find(R"("masking":{"on":true)") != std::string::npos;
        heard += on ? '1' : '0';
    }
    CHECK(heard == "01111100001");
    board.enter(TroubleView{.sentence = "the cable is out"});
    CHECK_THAT(reader.state().value().json, Has(R"("masking":{"on":false)"));
}
