#include "data/export/bids_files.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/files.hpp"
#include "engine/realtime/tick_record.hpp"
#include "data/export/delimited_file.hpp"
#include "data/export/json_text.hpp"
#include "data/store/reader.hpp"
#include "data/trace/columns.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;

/// A column of a tick as BIDS asks for it: all but the number of the tick, which is the row's, and
/// the commanded force, which is a stimulus.
struct Channel {
    const TraceColumn* column;
    std::string_view component, type;
};

std::vector<Channel> channels() {
    std::vector<Channel> all;
    for (const TraceColumn& column : trace_columns()) {
        const std::string_view name = column.name;
        if (name == "tick" || name.starts_with("commanded_")) {
            continue;
        }
        all.push_back({&column,
                       name.find("_x_") != std::string_view::npos   ? "x"
                       : name.find("_y_") != std::string_view::npos ? "y"
                       : name.find("_z_") != std::string_view::npos ? "z"
                                                                    : "n/a",
                       name == "time_s"           ? "LATENCY"
                       : name.starts_with("hip_") ? "POS"
                                                  : "MISC"});
    }
    return all;
}

/// As LATENCY asks for it: seconds and their fraction, no exponent.
std::string latency_text(std::int64_t ns) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    return fmt::format("{}{}.{:09}", ns < 0 ? "-" : "", std::abs(ns / kSecond),
                       std::abs(ns % kSecond));
}

/// The ticks by number from 0, each lost one as nothing.
template <class Row>
void each_tick(std::span<const TickRecord> ticks, const Row& row) {
    std::int64_t next = 0;
    for (const TickRecord& tick : ticks) {
        for (; next < tick.tick; ++next) {
            row(static_cast<const TickRecord*>(nullptr));
        }
        row(&tick);
        ++next;
    }
}

void write_motion(std::span<const TickRecord> ticks, const std::filesystem::path& path) {
    DelimitedFile file(path, Delimited::tsv);
    each_tick(ticks, [&file, all = channels()](const TickRecord* tick) {
        for (const Channel& channel : all) {
            if (tick == nullptr) {
                file.none();
            } else if (channel.type == "LATENCY") {
                file.text(latency_text(tick->time_ns));
            } else {
                file.value(channel.column->value(*tick));
            }
        }
        file.end_row();
    });
    file.close();
}

void write_channels(double rate_hz, const std::filesystem::path& path) {
    DelimitedFile file(path, Delimited::tsv);
    for (const char* name : {"name", "component", "type", "tracked_point", "units",
                             "reference_frame", "sampling_frequency", "description"}) {
        file.text(name);
    }
    file.end_row();
    for (const Channel& channel : channels()) {
        const std::string_view unit = channel.column->unit;
        for (const std::string_view word :
             {channel.column->name, channel.component, channel.type,
              std::string_view(channel.type == "POS" ? "handle" : "n/a"),
              unit.empty() || unit.starts_with('1') ? std::string_view("n/a") : unit,
              std::string_view(channel.component == "n/a" ? "n/a" : "object")}) {
            file.text(word);
        }
        file.real(rate_hz);
        file.text(channel.column->meaning);
        file.end_row();
    }
    file.close();
}

Json channels_json() {
    return {{"reference_frame",
             {{"Description", "where x, y and z are measured"},
              {"Levels",
               {{"object",
                 {{"SpatialAxes", "RAS"},
                  {"Description",
                   "origin where the study's objects have theirs: x to the right, y away from the "
                   "person, z up, which is 0 where the handle moves in a plane"}}}}}}}};
}

std::int64_t channels_of(std::string_view type) {
    return std::ranges::count(channels(), type, &Channel::type);
}

Json motion_json(const ChosenSession& session, std::span<const TickRecord> ticks) {
    const double duration = seconds_of(ticks.back().time_ns - ticks.front().time_ns);
    const auto steps = static_cast<double>(ticks.back().tick - ticks.front().tick);
    return {{"TaskName", session.study},
            {"TaskDescription", session.title},
            {"TrackingSystemName", "handle"},
            {"SamplingFrequency", session.rate_hz},
            {"SamplingFrequencyEffective", duration > 0.0 ? steps / duration : session.rate_hz},
            {"RecordingDuration", duration},
            {"MotionChannelCount", channels().size()},
            {"POSChannelCount", channels_of("POS")},
            {"LATENCYChannelCount", channels_of("LATENCY")},
            {"MISCChannelCount", channels_of("MISC")},
            {"TrackedPointsCount", 1},
            {"MissingValues", "n/a: the tick was lost, or the value was not a number"}};
}

void write_stim(std::span<const TickRecord> ticks, const std::filesystem::path& path) {
    DelimitedFile file(path, Delimited::tsv);
    each_tick(ticks, [&file](const TickRecord* tick) {
        file.real(tick == nullptr ? std::numeric_limits<double>::quiet_NaN() : tick->command.x);
        file.real(tick == nullptr ? std::numeric_limits<double>::quiet_NaN() : tick->command.y);
        file.real(tick == nullptr ? std::numeric_limits<double>::quiet_NaN() : tick->command_z);
        file.end_row();
    });
    file.close();
}

Json stim_json(const ChosenSession& session) {
    const auto column = [](const char* words) {
        return Json{{"Description", words}, {"Units", "N"}};
    };
    return {{"SamplingFrequency", session.rate_hz},
            {"StartTime", 0},
            {"Columns", {"commanded_x_n", "commanded_y_n", "commanded_z_n"}},
            {"commanded_x_n",
             column("force commanded to the device after the safety chain, to the right")},
            {"commanded_y_n",
             column("force commanded to the device after the safety chain, away from the person")},
            {"commanded_z_n", column("force commanded to the device after the safety chain, up")}};
}

}  // namespace

std::string bids_stem(const ChosenSession& session) {
    return fmt::format("{}_ses-{:02}_task-{}", session.subject, session.number, session.label);
}

std::string bids_run(std::int64_t number) {
    return fmt::format("{:04}", number);
}

void write_bids_run(Database& database,
                    const ChosenSession& session,
                    std::int64_t trial,
                    std::int64_t number,
                    const std::filesystem::path& session_folder) {
    TraceReader traces(database);
    for (const std::int64_t interval : {1, 2}) {
        const Ticks ticks = traces.stored(trial, interval);
        if (ticks.empty()) {
            continue;
        }
        const std::string run =
            fmt::format("{}_run-{}", interval == 1 ? "" : "_acq-interval2", bids_run(number));
        const std::string motion = bids_stem(session) + "_tracksys-handle" + run;
        const std::filesystem::path folder = session_folder / "motion";
        std::filesystem::create_directories(folder);
        write_motion(ticks, folder / (motion + "_motion.tsv"));
        write_whole(folder / (motion + "_motion.json"),
                    json_text(motion_json(session, ticks)) + "\n");
        write_channels(session.rate_hz, folder / (motion + "_channels.tsv"));
        write_whole(folder / (motion + "_channels.json"), json_text(channels_json()) + "\n");
        const std::filesystem::path stim =
            session_folder / "beh" / (bids_stem(session) + run + "_recording-force_stim");
        write_stim(ticks, stim.string() + ".tsv.gz");
        write_whole(stim.string() + ".json", json_text(stim_json(session)) + "\n");
    }
}

}  // namespace palpate::data
