#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <functional>
#include <mutex>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/shell.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/trial/presentation.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "ui/command/command.hpp"
#include "ui/console/page_server.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/json_line.hpp"
#include "ui/rig/open_device.hpp"
#include "ui/rig/operator_log.hpp"
#include "ui/rig/say.hpp"
#include "ui/rig/stop_lines.hpp"
#include "ui/session/run_rig.hpp"

namespace palpate::ui {

// As they lie in page/.
std::string_view preview_page(), preview_style(), preview_script();

namespace {

namespace fs = std::filesystem;
using protocols::Presentation;

struct PreviewOptions {
    std::string protocol;
    std::string device;  ///< empty: nothing is felt
    std::string calibration;
    bool handle_free = false;
};

void declare(CommandWords& words, PreviewOptions& options) {
    words.add("PROTOCOL", options.protocol, "A protocol file, looked at again when it is saved")
        .required();
    words.add("--device", options.device,
              "Each stimulus can be felt on it, and nothing is kept: sim, haply:PORT, "
              "haply-emulator, board:PORT, board:udp:HOST:PORT or comedi:FILE");
    words.add("--calibration", options.calibration, std::string(kCalibrationWords))
        .needs("--device");
    words.add("--handle-free", options.handle_free, "As of palpate run").needs("--device");
}

/// @return its path, which ends with /
std::string new_folder() {
    std::string name = (fs::temp_directory_path() / "palpate-preview-XXXXXX").string();
    refuse_if<std::runtime_error>(mkdtemp(name.data()) == nullptr,
                                  "{}: cannot be made; check TMPDIR", name);
    return name + '/';
}

/// What a command of this program says, both ways, and whether it said that all is right.
std::pair<std::string, bool> said_by(const std::vector<std::string>& words) {
    std::string line = fmt::format("exec /proc/{}/exe", getpid());
    for (const std::string& word : words) {
        line += ' ' + shell_word(word);
    }
    auto [said, status] = output_of(line + " 2>&1");
    return {std::move(said), status == 0};
}

/// By its name on the page.
using FeltStimulus = std::pair<std::string, Presentation>;

/// What the rule of a protocol may choose, its ends and what is between them, beside the standard;
/// without a rule each object with each friction.
std::vector<FeltStimulus> stimuli_of(const protocols::Protocol& protocol) {
    std::vector<FeltStimulus> all;
    for (const protocols::RunSpec& run : protocol.runs) {
        const protocols::AdaptiveSpec& rule = *protocol.procedure;
        const auto felt = [&](const std::string& friction) {
            return Presentation{.object = *std::ranges::find(protocol.objects, rule.object,
                                                             &protocols::ObjectSpec::name),
                                .friction = *std::ranges::find(protocol.frictions, friction,
                                                               &protocols::FrictionSpec::name)};
        };
        all.emplace_back(
            run.name + ", standard",
            felt(run.standard_friction.empty() ? run.friction : run.standard_friction));
        for (const double share : {0.0, 0.5, 1.0}) {
            const double chosen = rule.lowest + share * (rule.highest - rule.lowest);
            if (std::isfinite(chosen)) {
                auto& [name, one] = all.emplace_back("", felt(run.friction));
                name = fmt::format("{}, {} {:.4g}", run.name, protocols::word_of(rule.varies),
                                   felt_value(rule, chosen));
                feel_stimulus(rule, chosen, one);
            }
        }
    }
    for (const auto& object : protocol.objects) {
        for (const auto& friction : protocol.frictions) {
            if (!protocol.procedure) {
                all.emplace_back(fmt::format("{}, friction {}", object.name, friction.name),
                                 Presentation{.object = object, .friction = friction});
            }
        }
    }
    return all;
}

/// A protocol as it was when it was saved last: check, order, screens and objects as the commands
/// of these names have them. On a device what it lets one feel can be felt, one stimulus at a time,
/// by the same servo and safety chain as in a pilot, and nothing is kept.
class Preview {
public:
    /// @throws std::invalid_argument for a device that cannot be felt without a window
    explicit Preview(const PreviewOptions& options) : given_(options) {
        if (!given_.device.empty()) {
            rig_.device = parse_device(given_.device);
            rig_.rig = rig_file_of(rig_.device, options.calibration);
            rig_.handle_free = options.handle_free;
            const auto kind = rig_.device.kind;
            refuse_if(kind == DeviceChoice::Kind::mouse || kind == DeviceChoice::Kind::replay,
                      "--device {} of a preview: give a device with force, or sim; palpate run has "
                      "the window of a pointer, and what was recorded",
                      given_.device);
            rig_.key.participant = "preview";
            rig_.screen.speed = 1.0;
            rig_.kind = held_by_a_person(kind) ? data::RunKind::pilot : data::RunKind::simulated;
            check_record(rig_, given_.device, options.calibration);
        }
        look();
    }
    ~Preview() { remove(folder_); }

    /// Draws it again if it was saved, and lets what was asked for be felt until its end; what goes
    /// wrong is said on the page, not thrown. On the thread that made it.
    void look() {
        if (stamp() != stamp_) {
            draw();
            read_stimuli();
        }
        feel_asked();
    }

    /// What was drawn, and what can be felt, as events of the page; of the latter {"device": "sim",
    /// "stimuli": ["convex, friction off", ...], "on": 3 or null, "said": "..."}. Any thread.
    [[nodiscard]] std::array<std::string, 2> events() const {
        const std::scoped_lock lock(mutex_);
        data::Json names = data::Json::array();
        for (const FeltStimulus& one : stimuli_) {
            names.push_back(one.first);
        }
        return {drawn_, given_.device.empty() ? ""
                                              : event_text("felt", {{"device", given_.device},
                                                                    {"stimuli", names},
                                                                    {"on", json_or_null(on_)},
                                                                    {"said", said_}})};
    }
    /// Any thread.
    [[nodiscard]] std::string file(std::string_view path) const {
        const std::scoped_lock lock(mutex_);
        const std::string file = folder_ + std::string(path.substr(path.empty() ? 0 : 1));
        return path.rfind('/') == 0 && fs::is_regular_file(file) ? file_text(file) : "";
    }
    /// {"do": "feel", "at": 3} or {"do": "stop"}. Any thread. @return {"ok": ..., "text": ...}
    /// @param gone  whoever asked: nothing is felt for them
    [[nodiscard]] std::string ask(const std::string& line, bool gone) {
        const data::Json asked = object_in(line);
        const data::Json what = asked.value("do", data::Json());
        if (what == "stop") {
            stop_ = true;
            return answer_of(true, "no force");
        }
        const std::scoped_lock lock(mutex_);
        const data::Json at = asked.value("at", data::Json());
        const bool known = what == "feel" && at.is_number_unsigned() && at < stimuli_.size();
        if (!known || gone || on_ || asked_) {
            return answer_of(false, known ? "one is felt already: stop it first"
                                          : "there is no such stimulus: nothing was done");
        }
        stop_ = false;
        asked_ = at.get<std::size_t>();
        return answer_of(true, "it is felt until Stop is pressed");
    }

private:
    using Stamp = std::pair<fs::file_time_type, std::uintmax_t>;
    [[nodiscard]] Stamp stamp() const {
        std::error_code gone;
        return {fs::last_write_time(given_.protocol, gone), fs::file_size(given_.protocol, gone)};
    }
    static void remove(const std::string& folder) {
        std::error_code kept;
        fs::remove_all(folder, kept);
    }

    void draw() {
        stamp_ = stamp();
        std::string folder = new_folder();
        const std::string drawing = folder + "objects.svg";
        auto [check, right] = said_by({"check", given_.protocol, "--long", "--svg", drawing});
        check.resize(std::min(check.size(), check.rfind("objects drawn in ")));  // in our folder
        const auto [order, ordered] =
            said_by({"sequence", given_.protocol, "--participant", "P01"});
        const auto [taken, pictured] = said_by({"screenshots", "--protocol", given_.protocol,
                                                "--width", "960", "--height", "600", "-o", folder});
        data::Json screens = data::Json::array();
        std::istringstream files(pictured ? taken : "");
        for (std::string file; std::getline(files, file);) {
            if (file.starts_with(folder)) {
                screens.push_back(fs::path(file).filename().string());
            }
        }
        const bool drawn = pictured && fs::exists(drawing);
        const std::scoped_lock lock(mutex_);
        remove(std::exchange(folder_, std::move(folder)));
        drawn_ = event_text("drawn", {{"protocol", given_.protocol},
                                      {"version", ++version_},
                                      {"right", right},
                                      {"check", check},
                                      {"order", ordered ? order : ""},
                                      {"screens", screens},
                                      {"objects", json_or_null(drawn ? "objects.svg" : "")}});
    }

    /// The device is opened anew for them when something is asked for.
    void read_stimuli() {
        opened_.reset();
        std::vector<FeltStimulus> stimuli;
        try {
            rig_.study = load_study(given_.protocol);
            stimuli = stimuli_of(rig_.study.protocol);
        } catch (const std::exception&) {  // the page has the problem at its line
        }
        const std::scoped_lock lock(mutex_);
        stimuli_ = std::move(stimuli);
        asked_.reset();
        on_.reset();
        said_.clear();
    }

    void say_on_page(std::optional<std::size_t> on, std::string text) {
        const std::scoped_lock lock(mutex_);
        on_ = on;
        said_ = std::move(text);
    }

    void feel_asked() {
        std::unique_lock lock(mutex_);
        const auto at = std::exchange(asked_, std::nullopt);
        if (!at) {
            return;
        }
        const FeltStimulus one = stimuli_.at(*at);
        on_ = at;
        said_ = "the device is opened for " + one.first;
        lock.unlock();
        try {
            if (!opened_) {
                refuse_if(rig_.study.protocol.safety.dead_man && held_by_a_person(rig_.device.kind),
                          "the protocol asks for a dead-man key, which the window of a session "
                          "has: "
                          "palpate run with --kind pilot lets one feel it");
                opened_ = open_and_check(rig_);
            }
            if (!felt_whole(one)) {
                opened_.reset();  // whatever it was, it is opened and proved anew
            }
        } catch (const std::exception& e) {
            opened_.reset();
            say_on_page(std::nullopt, e.what());
        }
    }

    /// What a session's exploration does, without whatever would be kept. @return false on a fault
    [[nodiscard]] bool felt_whole(const FeltStimulus& one) {
        constexpr double kLongest = 30.0;  // s; what nobody ended ends then
        protocols::Apparatus& port = *opened_->port;
        const engine::FeltScene scene = make_felt_scene(rig_.study.protocol, one.second);
        const auto stop = [&](const char*) {
            stop_ = true;
            port.stop();
        };
        const StopLines lines("", "preview of " + given_.protocol + '\n', {},
                              {.stop = stop, .types = held_by_a_person(rig_.device.kind)});
        say_on_page(on_, "felt now: " + one.first);
        std::array<engine::TickRecord, 256> ticks{};
        double strongest = 0.0;
        std::size_t felt = 0;
        const auto drain = [&] {
            for (std::size_t n = port.ring().pop(ticks); n > 0; n = port.ring().pop(ticks)) {
                felt += n;
                for (const engine::TickRecord& tick : std::span(ticks).first(n)) {
                    strongest = std::max(strongest, glm::length(tick.command));
                }
            }
        };
        port.allow();
        port.hold(true);  // nobody feels a simulated one
        bool faulted = false;
        protocols::ForceScope force(port, scene, {}, 1);
        while (!faulted && !stop_ && !interrupted() && port.elapsed_s() < kLongest &&
               !port.hand_is_done()) {
            faulted = port.advance() == engine::ServoStatus::faulted;
            port.beat();
            drain();
        }
        force.end();
        drain();
        const std::string trouble = port.trouble();
        say_on_page(std::nullopt,
                    !faulted || stop_
                        ? fmt::format("{}: {} ticks, {:.2f} N at most; nothing was kept", one.first,
                                      felt, strongest)
                    : trouble.empty() ? std::string(explanation(port.trip()))
                                      : trouble);
        return !faulted;
    }

    const PreviewOptions given_;
    RigSpec rig_{};  ///< its study is read anew when the protocol is saved
    std::optional<OpenedApparatus> opened_;
    Stamp stamp_{};
    std::uint64_t version_ = 0;

    mutable std::mutex mutex_;
    std::string folder_;  ///< of what was drawn
    std::string drawn_, said_;
    std::vector<FeltStimulus> stimuli_;
    std::optional<std::size_t> asked_, on_;
    std::atomic<bool> stop_{false};
};

int run(const PreviewOptions& options) {
    std::error_code unknown;
    refuse_if(
        !fs::is_regular_file(options.protocol, unknown),
        "{}: {}; palpate new makes a protocol of a shipped one", options.protocol,
        fs::exists(options.protocol, unknown) ? "it is no plain file" : "there is no such file");
    catch_signals();
    Preview preview(options);
    PageServerSpec spec;
    spec.file = [&preview](std::string_view path) {
        return path == "/"            ? std::string(preview_page())
             : path == "/preview.css" ? std::string(preview_style())
             : path == "/preview.js"  ? std::string(preview_script())
                                      : preview.file(path);
    };
    spec.open = [&preview](bool /*shown*/, bool /*still*/) {  // what it does not know yet
        return [&preview, said = std::array<std::string, 2>(),
                said_ns = monotonic_ns()]() mutable -> std::optional<std::string> {
            std::array now = preview.events();
            std::string news =
                (now[0] != said[0] ? now[0] : "") + (now[1] != said[1] ? now[1] : "");
            said = std::move(now);
            if (news.empty() && monotonic_ns() - said_ns > 1'000 * kMillisecond) {
                news = event_text("there", data::Json::object());  // else it is given up
            }
            said_ns = news.empty() ? said_ns : monotonic_ns();
            return news;
        };
    };
    if (!options.device.empty()) {
        spec.act = std::bind_front(&Preview::ask, &preview);
    }
    const PageServer server(std::move(spec));
    say("{} as its participants will see it, drawn again when it is saved: {}\nCtrl+C ends it.\n",
        options.protocol, server.address());
    while (!interrupted()) {
        sleep_until(monotonic_ns() + 300 * kMillisecond);
        preview.look();
    }
    return 0;
}

}  // namespace

Command preview_command() {
    return make_command<PreviewOptions>(
        "preview", "Serve a page with all that a protocol shows, drawn again when it is saved",
        declare, run);
}

}  // namespace palpate::ui
