#include "data/store/stored_progress.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::data;
using namespace palpate::protocols;

TEST_CASE("a trial's device is the last one that was meant before it, or the session's first",
          "[store][law]") {
    SEEDED(random, std::uint64_t{50});
    const TrialDevice first{.name = "first", .calibration = "0"};
    DeviceProgress device{.begun = first};
    std::vector<Event> events;
    for (int i = 0; i < 40; ++i) {
        const std::string word = std::to_string(i);
        const std::array<Event, 6> choice{
            Event{.kind = EventKind::device, .value = word},
            Event{.kind = EventKind::provenance, .key = "calibration sha256", .value = word},
            Event{.kind = EventKind::provenance, .key = "calibration", .value = word},
            Event{.kind = EventKind::reconnect, .value = word},
            Event{.kind = EventKind::note, .text = word, .value = word},
            Event{.kind = random.below(4) == 0 ? EventKind::planned_again : EventKind::rest}};
        events.push_back(choice[random.index(6)]);
        device = apply(std::move(device), events.back());
        // The law, said backwards: what the newest event said, unless all was planned again since.
        TrialDevice expected;
        for (auto event = events.rbegin(); event != events.rend(); ++event) {
            if (event->kind == EventKind::planned_again) {
                break;
            }
            if (event->kind == EventKind::device && expected.name.empty()) {
                expected.name = event->value;
            }
            if (event->key == "calibration sha256" && expected.calibration.empty()) {
                expected.calibration = event->value;
            }
        }
        REQUIRE(device.now.name == (expected.name.empty() ? first.name : expected.name));
        REQUIRE(device.now.calibration ==
                (expected.calibration.empty() ? first.calibration : expected.calibration));
        REQUIRE(device.begun.name == first.name);
    }
}

TEST_CASE("another port is the same rig, another calibration or machine is not", "[store]") {
    const TrialDevice rig{.name = "Haply gen3 at /dev/ttyACM0", .calibration = "1a"};
    CHECK(same_rig(rig, {.name = "Haply gen3 at /dev/ttyACM1", .calibration = "1a"}));
    CHECK_FALSE(same_rig(rig, {.name = "Haply gen3 at /dev/ttyACM0", .calibration = "1b"}));
    CHECK_FALSE(same_rig(rig, {.name = "Haply gen2 at /dev/ttyACM0", .calibration = "1a"}));
    CHECK_FALSE(same_rig(rig, {.name = "mouse", .calibration = {}}));
}
