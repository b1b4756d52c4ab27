#include <cmath>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/commissioning/commissioning.hpp"
#include "engine/commissioning/place_proof.hpp"
#include "engine/device/emulator/emulated_board.hpp"
#include "engine/device/emulator/hands.hpp"
#include "engine/device/simulated_pantograph.hpp"
#include "protocols/file/calibration_file.hpp"
#include "protocols/file/document.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/open_device.hpp"
#include "ui/rig/rig_proof.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

using engine::Vec2;
using engine::Vec3;

struct CommissionOptions {
    std::string device = "sim";
    std::string calibration;         ///< as RunOptions::calibration
    std::vector<std::string> marks;  ///< X_MM,Y_MM of two; none: chosen
    double handle_g = 0.0;           ///< 0: not given
    std::string moved_g;             ///< X_G,Y_G,Z_G of three axes
    bool handle_free = false;
    std::string stop_button;  ///< as RunOptions::stop_button
    std::string output;
};

constexpr double kPeriod = 1e-3;  ///< s, as a desk has it

/// A device whose handle nobody holds, and how it comes to a place.
struct Rig {
    std::unique_ptr<StopLines> stops;
    std::unique_ptr<engine::EmulatedHaply> emulated;
    std::unique_ptr<engine::Device> own;
    engine::Device* device = nullptr;
    engine::CommissioningDesk desk;
};

engine::PlantModel free_plant(const engine::Calibration& machine) {
    engine::PlantModel plant;
    plant.machine = machine.pantograph;
    return engine::held_by(plant, engine::kNobody);
}

Rig simulated_rig(const engine::Calibration& machine) {
    Rig rig;
    auto device = std::make_unique<engine::SimulatedPantograph>(
        engine::PantographModel{.plant = free_plant(machine)}, kPeriod);
    rig.desk = {.bring = [simulated = device.get()](
                             const Vec3& place) { return bring_handle(*simulated, Vec2(place)); },
                .wait =
                    [] {
                        return true;
                    }};
    rig.device = device.get();
    rig.own = std::move(device);
    return rig;
}

Rig emulated_rig(const engine::Calibration& machine) {
    Rig rig;
    rig.emulated = std::make_unique<engine::EmulatedHaply>(
        machine,
        [plant = free_plant(machine)] {
            return std::make_unique<engine::HandOf<engine::PantographPlant>>(plant);
        },
        engine::BoardTiming{.period = kPeriod, .silence = 5.0},
        engine::GuardTiming{.wait_ms = 5, .patience = 1000, .alive_ms = 5000, .apart = true});
    rig.device = &rig.emulated->device();
    rig.desk = {.bring =
                    [emulated = rig.emulated.get()](const Vec3& place) {
                        emulated->begin({.start = Vec2(place), .tremor = 0.0});
                        return true;
                    },
                .wait = ticks_until(kPeriod, interrupted)};
    return rig;
}

/// The handle is home when a real device is opened; later the operator brings it.
Rig real_rig(const CommissionOptions& options,
             const DeviceChoice& choice,
             const engine::Calibration& machine) {
    auto button = named_button(options.stop_button);
    ask_for_home(machine, options.handle_free);
    Rig rig;
    rig.stops = stops_of_pulses(std::move(button));
    rig.own = open_device(choice, machine, kPeriod);
    rig.device = rig.own.get();
    rig.desk = {
        .bring =
            [there = engine::home_of(machine), axes = machine.axes()](const Vec3& place) mutable {
                const bool already = place == there;
                there = place;
                return already || typed_after(fmt::format(
                                      "Bring the handle to {}, let go of it and press Enter. ",
                                      engine::place_text(place, axes)));
            },
        .wait = ticks_until(kPeriod, interrupted)};
    return rig;
}

Rig open_rig(const CommissionOptions& options, const engine::Calibration& machine) {
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

std::vector<Vec3> places_of(const CommissionOptions& options, const engine::Calibration& machine) {
    const Vec3 home = engine::home_of(machine);
    if (options.marks.empty()) {
        return engine::places_to_commission(machine, Vec2(home));
    }
    refuse_if(machine.gantry.has_value(),
              "--mark: the marks of three axes lie along them and are chosen: leave it out");
    std::vector<Vec3> places{home};
    for (const std::string& text : options.marks) {
        places.emplace_back(parse_place(text, "--mark"), 0.0);
    }
    refuse_if(places.size() < 3, "--mark: pulses need two marks besides home; give it twice");
    return places;
}

/// kg
Vec3 mass_of(const CommissionOptions& options, const engine::Calibration& machine) {
    constexpr double kMaxG = 20000.0;
    constexpr double kHandleG = 60.0;
    if (!machine.gantry) {
        refuse_if(!options.moved_g.empty(),
                  "--moved-g {} is of three axes: give --handle-g for the pantograph {}",
                  options.moved_g, machine.name());
        return Vec3(1e-3 * (options.handle_g > 0.0 ? options.handle_g : kHandleG));
    }
    const std::string wanted = fmt::format(
        "give --moved-g, what the motors of the axes x, y and z move, the handle and all that "
        "comes along, 1 to {:g} g each, as in --moved-g 480,300,120: strength is known by it",
        kMaxG);
    refuse_if(options.handle_g > 0.0, "--handle-g {:g} is of a linkage, and {} has three axes: {}",
              options.handle_g, machine.name(), wanted);
    const auto grams = three_numbers(options.moved_g);
    const auto weighs = [](double g) {
        return g >= 1.0 && g <= kMaxG;
    };
    refuse_if(!grams || !weighs(grams->x) || !weighs(grams->y) || !weighs(grams->z), "{}",
              options.moved_g.empty() ? fmt::format("{} has three axes: {}", machine.name(), wanted)
                                      : fmt::format("--moved-g {}: {}", options.moved_g, wanted));
    return 1e-3 * *grams;
}

void print_axes(const engine::RigRecord& record) {
    for (std::size_t i = 0; i < 3; ++i) {
        const engine::AxisDynamics& axis = record.axes[i];
        say("axis {}: {:.0f} g, damping {:.2g} N s/m, dry friction {:.2f} N, pulled {} by {:.2f} "
            "N\n",
            "xyz"[i], 1e3 * axis.mass, axis.damping, axis.friction,
            axis.pull < 0.0 ? "forward" : "backward", std::fabs(axis.pull));
    }
    say("relied upon: damping {:.2g} N s/m\n", record.damping);
}

void print_found(const engine::RigRecord& record, bool straight) {
    const engine::HandleDynamics& d = record.dynamics;
    say("encoders and motors: as the calibration says\n");
    if (straight) {
        print_axes(record);
    } else {
        say("handle: {:.0f} g, damping {:.2g} N s/m (relied upon: {:.2g}), dry friction {:.2g} N; "
            "of these {:.2g} N s/m and {:.2g} N at the handle, the rest in the joints\n",
            1e3 * d.handle_mass, record.damping / 0.8, record.damping, record.friction,
            d.handle_damping, d.handle_friction);
    }
    if (record.round_trip > 0.0) {
        say("answers after {:.2f} ms: up to {:.0f} Hz without a tick of delay more\n",
            1e3 * record.round_trip, record.rate_hz);
    }
    say("usable stiffness at 1 kHz: {:.0f} N/m\n", record.stiffness);
}

/// A record is written over by a newer one of the same rig alone.
/// @throws std::invalid_argument where another rig's is there
void require_same_rig(const CommissionOptions& options) {
    const auto there = record_in(options.output);  // none: write_whole() looks what it is
    refuse_if(there && there->device != options.device,
              "{} is the record of {}, and this is {}: give another file to write", options.output,
              there ? there->device : "", options.device);
}

/// The same of boards that say which one they are, at one port.
void require_same_board(const CommissionOptions& options, const std::string& identity) {
    const auto there = record_in(options.output);
    const auto now = engine::board_id(identity);
    refuse_if(there && there->board && there->board != now,
              "{} is the record of the board with the id {}, and this is {}: give another file to "
              "write",
              options.output, there ? there->board.value_or(0) : 0,
              now ? fmt::format("the one with the id {}", *now) : "another device");
}

void write_rig(const CommissionOptions& options,
               engine::Calibration& machine,
               std::optional<std::uint32_t> board,
               engine::RigRecord& record) {
    (machine.gantry ? machine.gantry->damping : machine.pantograph.damping) = record.damping;
    record.device = options.device;
    record.program = PALPATE_VERSION;
    record.board = board;
    record.calibration = protocols::calibration_id(machine);
    print_found(record, machine.gantry.has_value());
    write_whole(options.output, protocols::to_toml(machine, record));
    say("Rig {} written to {}: give it by --calibration\n", record.calibration.substr(0, kShownId),
        options.output);
}

int run(const CommissionOptions& options) {
    engine::Calibration machine =
        rig_file_of(parse_device(options.device), options.calibration).calibration;
    if (parse_device(options.device).kind == DeviceChoice::Kind::haply_emulator) {
        machine.home = engine::Exploration{}.start;  // where such a board finds its handle
    }
    const std::vector<Vec3> places = places_of(options, machine);
    const Vec3 mass = mass_of(options, machine);
    require_writable(options.output,
                     protocols::to_toml(machine));  // before anybody brings a handle
    require_same_rig(options);
    catch_signals();
    Rig rig = open_rig(options, machine);
    require_same_board(options, rig.device->identity());
    say("{}: {} with the numbers of {}; the handle is free\n", options.output, rig.device->name(),
        machine.name());
    engine::CommissioningResult done;
    try {
        in_real_time(
            [&] { done = engine::commission(*rig.device, machine, places, mass, rig.desk); });
    } catch (const StopDuringPulses&) {
        done.given_up = true;
    }
    if (done.given_up) {
        say_to(stderr, fmt::format("\npalpate: {}; the motors are off and nothing was written\n",
                                   interrupted() ? "stopped" : "standard input ended"));
        return kExitStopped;
    }
    refuse_if<std::runtime_error>(!done.refused.empty(),
                                  "{}. The motors are off and nothing was written", done.refused);
    write_rig(options, machine, engine::board_id(rig.device->identity()), done.record);
    return 0;
}

void declare(CommandWords& words, CommissionOptions& options) {
    words.add("--device", options.device, "The device to commission; sim to try it out");
    words.add("--calibration", options.calibration, std::string(kCalibrationWords));
    words.add("--mark", options.marks, "X_MM,Y_MM of a place besides home; twice. Left out: chosen")
        .again_for_each();
    words
        .add("--handle-g", options.handle_g,
             "What the handle weighs with the near halves of its links: strength is known by it; "
             "60 without it")
        .within(1.0, 2000.0);
    words
        .add("--moved-g", options.moved_g,
             "Of three axes instead: X_G,Y_G,Z_G, what each motor moves, the handle and all that "
             "comes along")
        .excludes("--handle-g");
    words.add(
        "--handle-free", options.handle_free,
        "Says beforehand that nobody holds the handle and that it rests at home, for scripts");
    words.add("--stop-button", options.stop_button, std::string(kStopButtonWords));
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
