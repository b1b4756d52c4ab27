#include <cstdio>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/device/replay_device.hpp"
#include "engine/device/simulated_pantograph.hpp"
#include "protocols/file/calibration_file.hpp"
#include "protocols/library/shipped.hpp"
#include "protocols/trial/emulated_haply_apparatus.hpp"
#include "protocols/trial/start_gate.hpp"
#include "ui/command/command.hpp"
#include "ui/doctor/checks.hpp"
#include "ui/rig/device_choice.hpp"
#include "ui/rig/open_device.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/load_study.hpp"
#include "ui/session/run_rig.hpp"

namespace palpate::ui {
namespace {

struct DoctorOptions {
    std::string device = "sim";  ///< as RunOptions::device
    std::string calibration;     ///< as RunOptions::calibration
    std::string protocol;        ///< whose rate and force are asked for; empty: 1 kHz, no force
    std::string database = "palpate.sqlite";  ///< whose folder is looked at; not made
    std::string font;
    double seconds = 5.0;  ///< of the jitter measurement
    bool json = false;
};

/// What the checks need to know of the study; the program's defaults without a protocol.
struct DoctorSpec {
    DeviceChoice device;
    protocols::RigFile rig{};
    std::optional<protocols::Protocol> protocol{};
    engine::Vec3 start{};  ///< of the handle, object frame, m
    double rate_hz = 1000.0;
};

DoctorSpec plan_of(const DoctorOptions& options) {
    DoctorSpec plan{.device = parse_device(options.device)};
    plan.rig = rig_file_of(plan.device, options.calibration);
    if (!options.protocol.empty()) {
        plan.protocol = load_study(options.protocol).protocol;
        require_fit(*plan.protocol, plan.device, plan.rig.calibration.axes());
        plan.start = protocols::start_of(*plan.protocol);
        plan.rate_hz = plan.protocol->apparatus.rate_hz;
    }
    return plan;
}

/// @throws what opening a device throws
std::shared_ptr<engine::Device> open_device(const DoctorSpec& plan) {
    const double period = 1.0 / plan.rate_hz;
    switch (plan.device.kind) {
        case DeviceChoice::Kind::replay: {
            auto recordings = load_recordings(plan.device);
            refuse_if(recordings.empty(), "{} holds no recorded trial to replay", plan.device.file);
            auto device = std::make_unique<engine::ReplayDevice>();
            device->begin(std::move(recordings.front()));
            return device;
        }
        case DeviceChoice::Kind::simulated: {
            engine::PantographModel model;
            model.plant.machine = plan.rig.calibration.pantograph;
            return std::make_unique<engine::SimulatedPantograph>(model, period);
        }
        case DeviceChoice::Kind::haply_emulator: {
            const std::shared_ptr<engine::EmulatedHaply> rig(
                new engine::EmulatedHaply(protocols::emulated_haply(plan.rig.calibration, period)));
            return {rig, &rig->device()};  // the board lives as long as its device
        }
        case DeviceChoice::Kind::mouse:
        case DeviceChoice::Kind::haply:
        case DeviceChoice::Kind::board:
        case DeviceChoice::Kind::comedi:
            break;
    }
    return ui::open_device(plan.device, plan.rig.calibration, period);
}

/// Of the machine in use, unless its axes are straight, and of every one that ships.
std::vector<Linkage> linkages(const engine::Calibration& machine) {
    const engine::PantographSpec& used = machine.pantograph;
    std::vector<Linkage> all;
    if (!machine.gantry) {
        all.push_back({.name = used.name, .bars = used.linkage, .centre = used.origin});
    }
    for (const engine::Calibration& one :
         protocols::parse_calibrations(protocols::shipped_pantographs(), "pantographs.toml")) {
        if (one.name() == machine.name()) {
            continue;
        }
        all.push_back({.name = one.pantograph.name,
                       .bars = one.pantograph.linkage,
                       .centre = one.pantograph.origin});
    }
    return all;
}

/// Keeps the checks in order, and prints each as soon as it is there: some take seconds.
class Report {
public:
    explicit Report(bool print) : print_(print) {}

    void add(Check check) {
        if (print_) {
            say("{}", as_text(check));
            std::fflush(stdout);
        }
        checks_.push_back(std::move(check));
    }
    void look(const std::string& name, const std::function<Check()>& look) {
        add(guarded(name, look));
    }
    [[nodiscard]] const std::vector<Check>& checks() const { return checks_; }

private:
    bool print_;
    std::vector<Check> checks_;
};

void look_at_device(Report& report, const std::string& word, const DoctorSpec& plan) {
    std::optional<Check> feasible;  // while it is open: some devices can be opened only once
    const auto then = [&](const engine::Device& device) {
        if (plan.protocol) {
            feasible = guarded("passivity and force",
                               [&] { return check_feasible(*plan.protocol, device); });
        }
    };
    report.look("device", [&] {
        Check check = check_device(
            word, [&] { return open_device(plan); }, plan.start, then);
        const Behind board = behind(parse_device(word));
        if (board.emulator) {
            check.detail += fmt::format(
                "; behind it is palpate haply-emulator, process {}: its sessions are recorded as "
                "simulated unless --kind says otherwise",
                *board.emulator);
        } else if (board.unseen) {
            check.detail +=
                "; behind it is a program that this user cannot see, and it may be an emulator: "
                "run will ask for --kind";
        }
        return check;
    });
    if (feasible) {
        report.add(*std::move(feasible));
    }
}

Check check_commissioned(const DoctorOptions& options, const protocols::RigFile& rig) {
    std::string why = objection(rig, options.device, options.calibration);
    return {.name = "commissioning",
            .status = why.empty() ? CheckStatus::ok : CheckStatus::warn,
            .detail = why.empty() ? options.calibration + " is the record of this device"
                                  : "no real session can be run on it",
            .remedy = std::move(why)};
}

void look_at_timing(Report& report, double rate_hz, double seconds) {
    JitterRun jitter;
    Check failed = guarded("jitter", [&] {
        jitter = run_jitter(rate_hz, seconds);
        return check_jitter(jitter);
    });
    if (jitter.all.lateness.count() > 0) {
        for (Check& check : check_rights(jitter.all.rights)) {
            report.add(std::move(check));
        }
    }
    report.add(std::move(failed));
    report.look("cyclictest", [&] { return check_cyclictest(jitter); });
}

void declare(CommandWords& words, DoctorOptions& options) {
    words.add("--device", options.device, std::string(kDeviceWords));
    words.add("--calibration", options.calibration, std::string(kCalibrationWords));
    words.add("--protocol", options.protocol,
              "The protocol to be run: its rate, and whether the device can render it");
    words.add("--db", options.database,
              "Where the data will go: room and speed of its disk; nothing is written into it");
    words.add("--font", options.font, "A TrueType font for the subject's screen");
    words
        .add("--seconds", options.seconds,
             "How long to measure the jitter; as long again with cyclictest installed")
        .within(0.05, 3600.0);
    words.add("--json", options.json, "One JSON object instead of lines");
}

int run(const DoctorOptions& options) {
    const DoctorSpec plan = plan_of(options);
    Report report(!options.json);
    const auto before = processor_time();
    look_at_device(report, options.device, plan);
    if (pushes_a_person(plan.device.kind)) {
        report.look("commissioning", [&] { return check_commissioned(options, plan.rig); });
    }
    report.look("kinematics", [&] { return check_kinematics(linkages(plan.rig.calibration)); });
    report.look("clock", check_clock);
    report.look("kernel", check_kernel);
    look_at_timing(report, plan.rate_hz, options.seconds);
    report.look("host", [&] { return check_host(before); });
    report.look("display", [&] { return check_display(held_by_a_person(plan.device.kind)); });
    report.look("audio", check_audio);
    report.look("font", [&] { return check_font(options.font); });
    report.look("disk", [&] { return check_disk(options.database); });
    if (options.json) {
        say("{}", as_json(PALPATE_VERSION, report.checks()));
    } else {
        say("{}", verdict(report.checks()));
    }
    return any_fails(report.checks()) ? kExitFailure : 0;
}

}  // namespace

Command doctor_command() {
    return make_command<DoctorOptions>(
        "doctor", "Is this machine ready? Device, timing, rights, screen, sound, disk", declare,
        run);
}

}  // namespace palpate::ui
