#include <algorithm>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/device/homing.hpp"
#include "engine/device/pantograph.hpp"
#include "protocols/file/calibration_file.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/open_device.hpp"
#include "ui/rig/rig_proof.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct CalibrateOptions {
    std::string device = "sim";
    std::string preset = "mk2";      ///< a calibration file, or the name of a shipped machine
    std::vector<std::string> marks;  ///< X_MM,Y_MM each; none: the home pose, or the origin
    bool scale = false;              ///< counts per turn as well
    std::string output;
};

using engine::Vec2;

constexpr int kReadings = 500;  ///< half a second at 1 kHz
constexpr auto kPause = std::chrono::milliseconds(1);
constexpr int kMaxSilent = 100;  ///< readings in a row that say nothing new

std::vector<Vec2> marks_of(const CalibrateOptions& options, const engine::Calibration& preset) {
    std::vector<Vec2> marks;
    for (const std::string& text : options.marks) {
        marks.push_back(parse_place(text, "--mark"));
    }
    if (marks.empty()) {
        marks.push_back(preset.home.value_or(Vec2{}));
    }
    const engine::Pantograph machine(preset.pantograph);
    for (const Vec2& mark : marks) {
        refuse_if(!machine.reach(mark),
                  "the mark ({}, {}) mm is out of the reach of {}: give a mark within it",
                  mark.x * 1e3, mark.y * 1e3, preset.pantograph.name);
    }
    refuse_if(
        options.scale && marks.size() < 3,
        "--scale needs three marks that do not lie in line, {} given: give --mark three times",
        marks.size());
    return marks;
}

/// One reading; the zeros are wrong yet, so that counts of a pose that cannot be are welcome.
bool add_reading(engine::Device& device, engine::MarkCounts& counts) {
    const engine::Reading reading = device.read();
    device.write(engine::Vec3{});
    if (!reading.ok() && reading.fault != engine::DeviceFault::unreachable) {
        const std::string trouble = device.trouble();
        throw std::runtime_error(
            fmt::format("{} stopped answering while it was read; nothing was written{}{}",
                        device.name(), trouble.empty() ? "" : ": ", trouble));
    }
    if (reading.fresh) {
        counts.add(reading.counts);
    }
    return reading.fresh;
}

engine::MarkReading read_mark(engine::Device& device, const Vec2& place) {
    const bool simulated = bring_handle(device, place);
    engine::MarkCounts counts;
    int silent = 0;
    while (counts.readings() < kReadings) {
        silent = add_reading(device, counts) ? 0 : silent + 1;
        refuse_if<std::runtime_error>(
            silent > kMaxSilent,
            "{} says nothing new; nothing was written: check its cable and power", device.name());
        if (!simulated) {
            std::this_thread::sleep_for(kPause);
        }
    }
    return counts.at(place);
}

void print_found(const engine::Calibration& found,
                 const engine::Homing& homing,
                 const std::vector<engine::MarkReading>& readings) {
    constexpr double kDegree = 180.0 / engine::kPi;
    say("\n");
    for (std::size_t i = 0; i < readings.size(); ++i) {
        say("mark ({}, {}) mm: missed by {:.3f} mm\n", readings[i].place.x * 1e3,
            readings[i].place.y * 1e3, homing.residuals[i] * 1e3);
    }
    for (std::size_t i = 0; i < 2; ++i) {
        const engine::Axis& axis = found.pantograph.axes[i];
        say("axis {}: zero {:.4f} deg, {:.2f} counts a turn\n", i + 1, axis.zero * kDegree,
            axis.counts_per_turn);
    }
    constexpr double kApart = 0.010;  // m
    if (std::ranges::all_of(readings, [&](const engine::MarkReading& one) {
            return glm::length(one.place - readings.front().place) < kApart;
        })) {
        say("Marks at one place are always met: one {:g} mm away or more would tell whether the "
            "lengths fit.\n",
            1e3 * kApart);
    }
}

void declare(CommandWords& words, CalibrateOptions& options) {
    words.add("--device", options.device, "The device to calibrate; sim to try it out");
    words.add("--preset", options.preset,
              "What is known of it: a calibration file, or haplet, 2diy_gen2, 2diy_gen3, mk2");
    words
        .add("--mark", options.marks,
             "X_MM,Y_MM of a place where the handle will be held; once for each mark")
        .again_for_each();
    words.add("--scale", options.scale,
              "Find counts per turn as well: three marks or more, not in line");
    words.add("-o,--output", options.output, "The calibration file to write").required();
}

/// None: standard input ended.
std::optional<std::vector<engine::MarkReading>> read_marks(engine::Device& device,
                                                           const engine::PantographSpec& machine,
                                                           const std::vector<Vec2>& marks) {
    std::vector<engine::MarkReading> readings;
    while (readings.size() < marks.size()) {
        const Vec2& mark = marks[readings.size()];
        if (!typed_after(fmt::format("Bring the handle to {} and press Enter. ",
                                     engine::place_text({mark, 0.0}, 2)))) {
            return std::nullopt;
        }
        const engine::MarkReading reading = read_mark(device, mark);
        try {
            static_cast<void>(engine::find_home(machine, std::span(&reading, 1), false));
            readings.push_back(reading);
        } catch (const engine::HomingError& error) {  // it moved: this mark once more
            say_to(stderr, fmt::format("palpate: {}\n", error.what()));
        }
    }
    return readings;
}

/// What is known beforehand. A damping that was measured on a commissioned rig goes with its
/// record.
engine::Calibration preset_of(const CalibrateOptions& options) {
    const auto there = record_in(options.output);
    refuse_if(there.has_value(),
              "{} is the commissioning record of {}: give another file to -o, or delete it",
              options.output, there ? there->device : "");
    protocols::RigFile preset = protocols::load_rig(options.preset);
    if (preset.record) {
        preset.calibration.pantograph.damping.reset();
        say("{}: left out damping_n_s_per_m, which was measured on {}: palpate commission measures "
            "it\n",
            options.output, preset.record->device);
    }
    return preset.calibration;
}

int run(const CalibrateOptions& options) {
    engine::Calibration calibration = preset_of(options);
    refuse_if(calibration.gantry.has_value(),
              "--preset {}: straight axes have no zeros to be found: write home_mm of each axis "
              "into the file by a rule, then palpate commission proves it",
              options.preset);
    const std::vector<Vec2> marks = marks_of(options, calibration);
    require_writable(options.output,
                     protocols::to_toml(calibration));  // before anybody brings a handle
    const auto device = open_for_calibration(options.device, calibration);
    say("{}: {} with the numbers of {}, {}\n", options.output, device->name(),
        calibration.pantograph.name, counted(marks.size(), "mark"));

    const auto readings = read_marks(*device, calibration.pantograph, marks);
    if (!readings) {
        say_to(stderr, "\npalpate: standard input ended; nothing was written\n");
        return kExitStopped;
    }
    const engine::Homing homing =
        engine::find_home(calibration.pantograph, *readings, options.scale);
    calibration = engine::calibrated(calibration, homing);
    print_found(calibration, homing, *readings);

    const std::string text = protocols::to_toml(calibration);
    write_whole(options.output, text);
    say("Calibration {} written to {}\n",
        protocols::calibration_id(calibration).substr(0, kShownId), options.output);
    return 0;
}

}  // namespace

Command calibrate_command() {
    return make_command<CalibrateOptions>(
        "calibrate", "Find the encoders' zeros of a pantograph, and write its calibration file",
        declare, run);
}

}  // namespace palpate::ui
