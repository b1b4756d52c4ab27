#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "engine/base/text.hpp"
#include "engine/commissioning/commissioning.hpp"
#include "engine/device/emulator/emulated_haply.hpp"
#include "engine/device/emulator/free_handle.hpp"
#include "engine/device/simulated_pantograph.hpp"
#include "protocols/file/calibration_file.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/calibration_device.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/open_device.hpp"
#include "ui/rig/rig_proof.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

using engine::Vec2;

struct CommissionOptions {
    std::string device = "sim";
    std::string calibration;         ///< as RunOptions::calibration
    std::vector<std::string> marks;  ///< X_MM,Y_MM of two; none: chosen
    double handle_g = 60.0;
    bool handle_free = false;
    std::string output;
};

constexpr double kPeriod = 1e-3;

/// A device whose handle nobody holds, and how it comes to a place.
struct Rig {
    std::unique_ptr<engine::EmulatedHaply> emulated;
    std::unique_ptr<engine::Device> own;
    engine::Device* device = nullptr;
    engine::CommissioningDesk desk;
};

engine::PlantModel free_plant(const engine::Calibration& machine) {
    engine::PlantModel plant;
    plant.machine = machine.pantograph;
    return engine::nobody_holds(plant);
}

Rig simulated_rig(const engine::Calibration& machine) {
    Rig rig;
    auto device = std::make_unique<engine::SimulatedPantograph>(
        engine::PantographModel{.plant = free_plant(machine)}, kPeriod);
    rig.desk = {.bring = [simulated = device.get()](
                             const Vec2& place) { return bring_handle(*simulated, place); },
                .wait = [] { return true; },
                .period = kPeriod};
    rig.device = device.get();
    rig.own = std::move(device);
    return rig;
}

Rig emulated_rig(engine::Calibration& machine) {
    Rig rig;
    machine.home = engine::Exploration{}.start;  // where an emulated board finds its handle
    rig.emulated = std::make_unique<engine::EmulatedHaply>(
        machine,
        [plant = free_plant(machine)] {
            return std::make_unique<engine::HandOf<engine::PantographPlant>>(plant);
        },
        engine::BoardTiming{.period = kPeriod, .silence = 5.0},
        engine::GuardTiming{.wait_ms = 5, .patience = 1000, .alive_ms = 5000});
    rig.device = &rig.emulated->device();
    rig.desk = {.bring =
                    [emulated = rig.emulated.get()](const Vec2& place) {
                        emulated->begin({.start = place, .tremor = 0.0});
                        return true;
                    },
                .wait = wall_ticks(kPeriod),
                .period = kPeriod};
    return rig;
}

/// The handle is home when a real device is opened; later the operator brings it.
Rig real_rig(const CommissionOptions& options,
             const DeviceChoice& choice,
             const engine::Calibration& machine) {
    ask_for_home(machine, options.handle_free);
    Rig rig;
    rig.own = open_device(choice, machine, kPeriod);
    rig.device = rig.own.get();
    rig.desk = {.bring =
                    [there = home_of(machine)](const Vec2& place) mutable {
                        const bool already = place == there;
                        there = place;
                        return already ||
                               wait_for_enter(fmt::format(
                                   "Bring the handle to {}, let go of it and press Enter. ",
                                   place_text(place)));
                    },
                .wait = wall_ticks(kPeriod),
                .period = kPeriod};
    return rig;
}

Rig open_rig(const CommissionOptions& options, engine::Calibration& machine) {
    const DeviceChoice choice = parse_device(options.device);
    switch (choice.kind) {
        case DeviceChoice::Kind::simulated:
            return simulated_rig(machine);
        case DeviceChoice::Kind::haply_emulator:
            return emulated_rig(machine);
        case DeviceChoice::Kind::haply:
        case DeviceChoice::Kind::board:
        case DeviceChoice::Kind::comedi:
            return real_rig(options, choice, machine);
        case DeviceChoice::Kind::mouse:
        case DeviceChoice::Kind::replay:
            break;
    }
    throw std::invalid_argument(
        fmt::format("--device {} gives no force: there is nothing to commission", options.device));
}

std::vector<Vec2> places_of(const CommissionOptions& options, const engine::Calibration& machine) {
    const Vec2 home = home_of(machine);
    if (options.marks.empty()) {
        return engine::commissioning_places(machine.pantograph, home);
    }
    std::vector<Vec2> places{home};
    for (const std::string& text : options.marks) {
        places.push_back(parse_place(text, "--mark"));
    }
    if (places.size() < 3) {
        throw std::invalid_argument("--mark: pulses need two marks besides home; give it twice");
    }
    return places;
}

void print_found(const engine::RigRecord& record) {
    const engine::HandleDynamics& d = record.dynamics;
    say("encoders and motors: as the calibration says\n"
        "handle: {:.0f} g, damping {:.2g} N s/m (relied upon: {:.2g}), dry friction {:.2g} N\n",
        1e3 * d.handle_mass, record.damping / 0.8, record.damping, record.friction);
    if (record.round_trip > 0.0) {
        say("answers after {:.2f} ms: up to {:.0f} Hz without a tick of delay more\n",
            1e3 * record.round_trip, record.rate_hz);
    }
    say("usable stiffness at 1 kHz: {:.0f} N/m\n", record.stiffness);
}

int run(const CommissionOptions& options) {
    engine::Calibration machine = calibration_of(parse_device(options.device), options.calibration);
    if (parse_device(options.device).kind == DeviceChoice::Kind::haply_emulator) {
        machine.home = engine::Exploration{}.start;
    }
    if (machine.gantry) {
        throw std::invalid_argument(fmt::format(
            "--calibration {}: pulses prove a pantograph and no machine of three axes yet: prove "
            "its signs by hand with its motors weak, and run --kind pilot",
            options.calibration));
    }
    const std::vector<Vec2> places = places_of(options, machine);
    require_writable(options.output,
                     protocols::to_toml(machine));  // before anybody brings a handle
    Rig rig = open_rig(options, machine);
    say("{}: {} with the numbers of {}; the handle is free\n", options.output, rig.device->name(),
        machine.pantograph.name);
    engine::Commissioned done;
    in_real_time([&] {
        done = engine::commission(*rig.device, machine.pantograph, places, 1e-3 * options.handle_g,
                                  rig.desk);
    });
    if (done.given_up) {
        say_to(stderr, "\npalpate: standard input ended; nothing was written\n");
        return kExitStopped;
    }
    if (!done.refused.empty()) {
        throw std::runtime_error(
            fmt::format("{}. The motors are off and nothing was written", done.refused));
    }
    machine.pantograph.damping = done.record.damping;
    done.record.device = options.device;
    done.record.program = PALPATE_VERSION;
    done.record.calibration = protocols::calibration_id(machine);
    print_found(done.record);
    write_whole(options.output, protocols::to_toml(machine, done.record));
    say("Rig {} written to {}: give it by --calibration\n",
        done.record.calibration.substr(0, kShownId), options.output);
    return 0;
}

void declare(CommandWords& words, CommissionOptions& options) {
    words.add("--device", options.device, "The device to commission; sim to try it out")
        .with_default();
    words.add("--calibration", options.calibration, std::string(kCalibrationWords));
    words.add("--mark", options.marks, "X_MM,Y_MM of a place besides home; twice. Left out: chosen")
        .again_for_each();
    words
        .add("--handle-g", options.handle_g,
             "What the handle weighs with the near halves of its links: strength is told by it")
        .within(1.0, 2000.0)
        .with_default();
    words.add(
        "--handle-free", options.handle_free,
        "Says beforehand that nobody holds the handle and that it rests at home, for scripts");
    words.add("-o,--output", options.output, "The file to write: calibration, record and hash")
        .required();
}

}  // namespace

Command commission_command() {
    return make_command<CommissionOptions>(
        "commission",
        "Prove a rig's wiring and strength by weak pulses on a free handle, and write its record",
        declare, run);
}

}  // namespace palpate::ui
