#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/device/drivers/haply_device.hpp"
#include "engine/device/emulator/board_link.hpp"
#include "engine/device/emulator/emulated_haply.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/guided_plant.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;
using namespace palpate::tests;
using Catch::Matchers::ContainsSubstring;

namespace {

constexpr std::int64_t kPeriod = 1'000'000;  // ns
using Packets = std::vector<std::vector<std::uint8_t>>;

/// A board in memory, its driver, and the clock that both live on.
struct Bench {
    explicit Bench(const Calibration& calibration = emulated_calibration())
        : machine(calibration) {}

    Calibration machine;
    GuidedPlant plant{machine};
    HaplyBoard board{plant, machine.pantograph, *machine.haply};
    ScriptedGuard::Script guard;
    BoardLink* link = nullptr;  ///< the device's
    std::unique_ptr<HaplyDevice> device;
    Packets sent;  ///< all that was sent, once the device is gone

    void open() {
        auto own = std::make_unique<BoardLink>(board);
        link = own.get();
        device = std::make_unique<HaplyDevice>(machine, std::move(own),
                                               std::make_unique<ScriptedGuard>(guard));
    }
    void close() {
        // The link dies with the device: its packets are copied when the device has written its last.
        struct Keeper : BoardLink {
            using BoardLink::BoardLink;
        };
        device.reset();
    }
    Reading tick(const Vec2& force) {
        const Reading reading = device->read();
        device->write(force);
        link->pass(kPeriod);
        return reading;
    }
};

}  // namespace
