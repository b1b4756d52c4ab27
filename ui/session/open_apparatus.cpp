#include "ui/session/open_apparatus.hpp"

#include <array>
#include <cmath>
#include <csignal>
#include <limits>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/device/simulated_pantograph.hpp"
#include "protocols/session/trust.hpp"
#include "protocols/trial/emulated_haply_apparatus.hpp"
#include "data/store/analysed.hpp"
#include "data/store/reader.hpp"
#include "ui/rig/control_line.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/open_device.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

using Kind = DeviceChoice::Kind;

/// Said before each session: nothing in this program can mend it.
constexpr const char* kKeepsForce =
    "this device has no watchdog of its own: its last force stays for ever if palpate and its "
    "guard are killed, frozen or starved together, the machine halts or the cable is pulled while "
    "a force is on; put a switch into the motors' supply, within the experimenter's reach";

std::unique_ptr<protocols::ServoApparatus> make_apparatus(const RigSpec& spec,
                                                          std::vector<protocols::Event>& opening) {
    const protocols::Protocol& protocol = spec.study.protocol;
    const auto& [calibration, record] = spec.rig;
    require_fit(protocol, spec.device, calibration.axes());
    const auto hand = [&] {
        return protocols::DrawnHand(protocol, spec.study.hash, spec.key, spec.seed, spec.hand);
    };
    switch (spec.device.kind) {
        case Kind::simulated: {
            if (protocol.surface) {
                return std::make_unique<protocols::GantryApparatus>(protocol, hand(),
                                                                    spec.screen.speed);
            }
            engine::PantographModel model;
            model.plant.machine = calibration.pantograph;
            return std::make_unique<protocols::SimulatedApparatus>(protocol, hand(),
                                                                   spec.screen.speed, model);
        }
        case Kind::haply_emulator:
            return std::make_unique<protocols::EmulatedHaplyApparatus>(
                protocol, hand(), calibration, spec.spin_share);
        case Kind::replay:
            return std::make_unique<protocols::ReplayApparatus>(
                protocol, spec.recordings, spec.device.file, spec.screen.speed);
        case Kind::mouse:
            return std::make_unique<protocols::PointerApparatus>(protocol);
        case Kind::haply:
        case Kind::board:
        case Kind::comedi:
            break;
    }
    const double period = 1.0 / protocol.apparatus.rate_hz;
    if (record) {
        ask_for_home(calibration, spec.handle_free);
    }
    auto device = open_device(spec.device, calibration, period);
    const auto other = [choice = spec.device, behind = spec.behind] {
        return behind ? other_behind(choice, *behind) : std::string();
    };
    const std::string why = other();  // since the question
    refuse_if<std::runtime_error>(!why.empty(), "{}", why);
    if (record) {
        check_board(*device, *record);
        opening = prove_opening(*device, calibration, *record, period, spec.handle_free,
                                spec.stop_button);
    }
    auto apparatus = std::make_unique<protocols::DeviceApparatus>(
        protocol, std::move(device), spec.spin_share,
        unproved(spec) ? protocols::kUnprovedForce : std::numeric_limits<double>::infinity());
    apparatus->ask_by(other);
    if (record) {
        apparatus->prove_by(proof_between_trials(
            calibration, *record, period,
            [port = apparatus.get()] { return port->stopped() || interrupted(); }));
    }
    return apparatus;
}

/// What the system refused to a servo that a hand depends on, and the remedy.
std::vector<std::string> refusals(const engine::RealtimeRights& rights) {
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < engine::kRights; ++i) {
        const auto right = static_cast<engine::Right>(i);
        if (rights.of(right).grant == engine::Grant::refused) {
            lines.push_back(fmt::format("real-time {}: {}; {}", name_of(right),
                                        describe(right, rights), remedy(right, rights)));
        }
    }
    return lines;
}

/// Keeps the machine from sleeping for as long as it lives, where systemd is there to be asked: a
/// force that nobody renews while the machine wakes up is nothing to hold. It ends with this
/// program, however that comes: the inhibitor waits for the end of a pipe.
class StayAwake {
public:
    /// Never throws: without systemd the machine may sleep.
    StayAwake() {
        std::array<int, 2> life{-1, -1};
        std::array<int, 2> word{-1, -1};
        const bool piped = pipe2(life.data(), O_CLOEXEC) == 0 && pipe2(word.data(), O_CLOEXEC) == 0;
        const Descriptor in(life[0]);
        const Descriptor said(word[0]);
        Descriptor out(word[1]);
        pipe_ = Descriptor(life[1]);
        if (piped) {
            start(in.get(), out.get());
            out = Descriptor();
            char first = 0;
            held_ =
                pid_ > 0 && readable(said.get(), kPatienceMs) && read(said.get(), &first, 1) == 1;
        }
    }
    ~StayAwake() {
        pipe_ = Descriptor();
        if (pid_ > 0) {
            kill(pid_, SIGTERM);  // it may wait for its bus instead
            waitpid(pid_, nullptr, 0);
        }
    }
    /// For the record of a session: whether sleep is held off.
    [[nodiscard]] std::string text() const {
        return held_ ? "held off (systemd-inhibit)"
                     : "not held off: systemd-inhibit is not there or was refused";
    }

private:
    static constexpr int kPatienceMs = 2000;  ///< for a bus that answers slowly

    void start(int in, int out) {
        posix_spawn_file_actions_t files;
        posix_spawn_file_actions_init(&files);
        posix_spawn_file_actions_adddup2(&files, in, STDIN_FILENO);
        posix_spawn_file_actions_adddup2(&files, out, STDOUT_FILENO);
        posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
        posix_spawnattr_t own_group;  // Ctrl+C ends a session in good order, and is not for this
        posix_spawnattr_init(&own_group);
        posix_spawnattr_setflags(&own_group, POSIX_SPAWN_SETPGROUP);
        std::array<const char*, 9> words{"systemd-inhibit",
                                         "--what=sleep:idle:handle-lid-switch",
                                         "--who=palpate",
                                         "--why=a hand is on a device that gives force",
                                         "--mode=block",
                                         "sh",
                                         "-c",
                                         "echo held; cat > /dev/null",
                                         nullptr};
        if (posix_spawnp(&pid_, words[0], &files, &own_group, const_cast<char**>(words.data()),
                         environ) != 0) {
            pid_ = -1;
        }
        posix_spawnattr_destroy(&own_group);
        posix_spawn_file_actions_destroy(&files);
    }

    pid_t pid_ = -1;
    Descriptor pipe_{};  ///< the inhibitor lives until this is closed
    bool held_ = false;
};

}  // namespace

bool unproved(const RigSpec& spec) {
    return spec.kind == data::RunKind::pilot && pushes_a_person(spec.device.kind) &&
           !spec.rig.record;
}

void check_record(RigSpec& spec, const std::string& device, const std::string& calibration) {
    const std::string why = objection(spec.rig, device, calibration);
    if (why.empty()) {
        return;
    }
    refuse_if(spec.kind == data::RunKind::real, "no real session: {}", why);
    spec.rig.record.reset();
    warn("{}{}", why,
         unproved(spec)
             ? fmt::format(". Until then it gives {:g} N at most", protocols::kUnprovedForce)
             : "");
}

data::TrialDevice felt_on(const RigSpec& spec) {
    const DeviceChoice& device = spec.device;
    const engine::Calibration& calibration = spec.rig.calibration;
    const bool surface = spec.study.protocol.surface.has_value();
    const bool calibrated = gives_force(device.kind) && (!surface || calibration.gantry);
    return {.name = device_name(device, calibration.name(), surface),
            .calibration = calibrated ? protocols::calibration_id(calibration) : ""};
}

std::vector<protocols::ReplayApparatus::Recording> load_recordings(const DeviceChoice& device) {
    if (device.kind != DeviceChoice::Kind::replay) {
        return {};
    }
    data::Database source(device.file, data::Access::read);
    const std::vector<std::int64_t> trials =
        device.trial ? std::vector{*device.trial} : data::answered_trials(source);
    std::vector<protocols::ReplayApparatus::Recording> all;
    data::TraceReader traces(source);
    std::size_t hidden = 0;
    for (const std::int64_t trial : trials) {
        if (device.trial) {
            data::require_shown(source, trial);
        } else if (!data::why_hidden(source, trial).empty()) {
            ++hidden;
            continue;
        }
        for (const std::int64_t interval : data::intervals_of(source, trial)) {
            protocols::ReplayApparatus::Recording recording;
            for (const engine::TickRecord& tick : traces.read(trial, interval)) {
                recording.push_back({.hip = tick.hip, .counts = tick.counts});
            }
            all.push_back(std::move(recording));
        }
    }
    if (hidden > 0) {
        warn("{}: {} of who does not consent or of withdrawn sessions {} not replayed", device.file,
             counted(hidden, "trial"), hidden == 1 ? "is" : "are");
    }
    return all;
}

OpenedApparatus open_apparatus(const RigSpec& spec) {
    const engine::Calibration& calibration = spec.rig.calibration;
    OpenedApparatus opened;
    auto apparatus = make_apparatus(spec, opened.opening);
    opened.findings = check_feasibility(spec.study.protocol, apparatus->device());
    opened.provenance = engine::provenance(apparatus->rights());
    if (const std::string board = apparatus->device().identity(); !board.empty()) {
        opened.provenance.emplace_back(protocols::kBoard, board);
    }
    if (apparatus->device().traits().gives_force) {
        opened.rest = rest_text(margins_of(spec.study.protocol, apparatus->device()));
        opened.refused = refusals(apparatus->rights());
        opened.round_trip = apparatus->device().traits().round_trip;
        if (opened.round_trip > 0.0) {
            opened.provenance.emplace_back(
                "reply delay",
                fmt::format("{:g} of the period", apparatus->device().traits().delay_ticks));
        }
        if (const std::string id = felt_on(spec).calibration; !id.empty()) {
            opened.provenance.emplace_back("calibration name", calibration.name());
            opened.provenance.emplace_back(data::kCalibrationHashKey, id);
            opened.provenance.emplace_back(data::kCalibrationKey, protocols::to_toml(calibration));
        }
    }
    if (spec.spin_share > 0.0 && apparatus->real_time()) {
        opened.provenance.emplace_back("realtime spin",
                                       fmt::format("{:g} of the period", spec.spin_share));
    }
    if (unproved(spec)) {
        opened.provenance.emplace_back(
            "force limit", fmt::format("{:g} N: nobody proved the rig",
                                       std::min(protocols::kUnprovedForce,
                                                spec.study.protocol.apparatus.force_limit)));
    }
    if (pushes_a_person(spec.device.kind)) {
        auto awake = std::make_shared<StayAwake>();
        opened.provenance.emplace_back("sleep", awake->text());
        opened.awake = std::move(awake);
        const double holds = apparatus->device().traits().holds_force;
        if (std::isinf(holds)) {
            opened.findings.push_back({protocols::Verdict::warn, kKeepsForce});
        } else {
            opened.provenance.emplace_back("device watchdog", fmt::format("{:g} ms", 1e3 * holds));
        }
    }
    opened.port = std::move(apparatus);
    return opened;
}

}  // namespace palpate::ui
