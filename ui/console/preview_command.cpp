#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <mutex>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/shell.hpp"
#include "ui/command/command.hpp"
#include "ui/console/felt_stimuli.hpp"
#include "ui/console/page_server.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/json_line.hpp"
#include "ui/rig/open_device.hpp"
#include "ui/rig/operator_log.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {

// As they lie in page/.
std::string_view preview_page(), preview_style(), preview_script();

namespace {

namespace fs = std::filesystem;

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

/// A folder that is gone with it.
class DrawingFolder {
public:
    DrawingFolder() {
        std::string name = (fs::temp_directory_path() / "palpate-preview-XXXXXX").string();
        refuse_if<std::runtime_error>(mkdtemp(name.data()) == nullptr,
                                      "{}: cannot be made; check TMPDIR", name);
        path_ = name;
    }
    DrawingFolder(const DrawingFolder&) = delete;
    DrawingFolder& operator=(const DrawingFolder&) = delete;
    ~DrawingFolder() {
        std::error_code kept;
        fs::remove_all(path_, kept);
    }
    [[nodiscard]] std::string file(std::string_view name) const { return path_ / name; }

private:
    fs::path path_;
};

/// What a command of this program says, both ways, and whether it said that all is right.
std::pair<std::string, bool> said_by(const std::vector<std::string>& words) {
    std::string line = fmt::format("exec /proc/{}/exe", getpid());
    for (const std::string& word : words) {
        line += ' ' + shell_word(word);
    }
    auto [said, status] = output_of(line + " 2>&1");
    return {std::move(said), status == 0};
}

/// A protocol as it was when it was saved last: check, order, screens and objects as the commands
/// of these names have them.
class Drawn {
public:
    explicit Drawn(std::string protocol) : protocol_(std::move(protocol)) { draw(); }

    /// Draws it again if it was saved. @return it was
    bool look() {
        const bool saved = stamp() != stamp_;
        if (saved) {
            draw();
        }
        return saved;
    }
    [[nodiscard]] std::string event() const {
        const std::scoped_lock lock(mutex_);
        return event_;
    }
    [[nodiscard]] std::optional<std::string> file(std::string_view path) const {
        const std::scoped_lock lock(mutex_);
        const std::string file = folder_->file(path.substr(std::min<std::size_t>(1, path.size())));
        const bool there = path.rfind('/') == 0 && fs::is_regular_file(file);
        return there ? std::optional(file_text(file)) : std::nullopt;
    }

private:
    using Stamp = std::pair<fs::file_time_type, std::uintmax_t>;
    [[nodiscard]] Stamp stamp() const {
        std::error_code gone;
        return {fs::last_write_time(protocol_, gone), fs::file_size(protocol_, gone)};
    }

    void draw() {
        stamp_ = stamp();
        auto folder = std::make_unique<DrawingFolder>();
        auto [check, right] =
            said_by({"check", protocol_, "--long", "--svg", folder->file("objects.svg")});
        check.resize(std::min(check.size(), check.rfind("objects drawn in ")));  // in our folder
        const auto [order, ordered] = said_by({"sequence", protocol_, "--participant", "P01"});
        const auto [taken, pictured] = said_by({"screenshots", "--protocol", protocol_, "--width",
                                                "960", "--height", "600", "-o", folder->file("")});
        data::Json screens = data::Json::array();
        std::istringstream files(pictured ? taken : "");
        for (std::string file; std::getline(files, file);) {
            if (file.starts_with(folder->file(""))) {
                screens.push_back(fs::path(file).filename().string());
            }
        }
        const bool drawn = pictured && fs::exists(folder->file("objects.svg"));
        const std::scoped_lock lock(mutex_);
        folder_ = std::move(folder);
        ++version_;
        event_ = event_text("drawn", {{"protocol", protocol_},
                                      {"version", version_},
                                      {"right", right},
                                      {"check", check},
                                      {"order", ordered ? order : ""},
                                      {"screens", screens},
                                      {"objects", json_or_null(drawn ? "objects.svg" : "")}});
    }

    std::string protocol_;
    std::unique_ptr<DrawingFolder> folder_;
    Stamp stamp_{};
    mutable std::mutex mutex_;
    std::string event_;
    std::uint64_t version_ = 0;
};

/// What a page has not yet been told; at least every 5 s that it is still there.
/// @param felt  null: nothing is
EventSource stream_of(const Drawn& drawn, const FeltStimuli* felt) {
    return [&drawn, felt, said = std::array<std::string, 2>(),
            said_ns = monotonic_ns()]() mutable -> std::optional<std::string> {
        std::array now{drawn.event(), felt == nullptr ? "" : felt->event()};
        std::string news = (now[0] != said[0] ? now[0] : "") + (now[1] != said[1] ? now[1] : "");
        said = std::move(now);
        if (news.empty() && monotonic_ns() - said_ns > 5'000 * kMillisecond) {
            news = ": still here\n\n";
        }
        said_ns = news.empty() ? said_ns : monotonic_ns();
        return news;
    };
}

int run(const PreviewOptions& options) {
    std::error_code unknown;
    refuse_if(
        !fs::is_regular_file(options.protocol, unknown),
        "{}: {}; palpate new makes a protocol of a shipped one", options.protocol,
        fs::exists(options.protocol, unknown) ? "it is no plain file" : "there is no such file");
    catch_signals();
    std::optional<FeltStimuli> felt;
    if (!options.device.empty()) {
        RigSpec rig;
        rig.device = parse_device(options.device);
        rig.rig = rig_file_of(rig.device, options.calibration);
        rig.handle_free = options.handle_free;
        felt.emplace(options.protocol, std::move(rig), options.device, options.calibration);
    }
    Drawn drawn(options.protocol);
    PageServerSpec spec;
    spec.file = [&drawn](std::string_view path) {
        return path == "/"            ? std::string(preview_page())
             : path == "/preview.css" ? std::string(preview_style())
             : path == "/preview.js"  ? std::string(preview_script())
                                      : drawn.file(path);
    };
    spec.open = [&drawn, &felt](bool /*shown*/, bool /*still*/) {
        return stream_of(drawn, felt ? &*felt : nullptr);
    };
    if (felt) {
        spec.act = [&felt](const std::string& line, bool gone) {
            return felt->ask(line, gone);
        };
    }
    const PageServer server(std::move(spec));
    say("{} as its participants will see it, drawn again when it is saved: {}\nCtrl+C ends it.\n",
        options.protocol, server.address());
    while (!interrupted()) {
        sleep_until(monotonic_ns() + 300 * kMillisecond);
        const bool saved = drawn.look();
        if (felt && saved) {
            felt->read_again();
        }
        if (felt) {
            felt->feel_asked();
        }
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
