#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/files.hpp"
#include "engine/base/text.hpp"
#include "engine/realtime/tick_record.hpp"
#include "data/csv/json_text.hpp"
#include "data/export/csv_export.hpp"
#include "data/export/selection.hpp"
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
    DelimitedFile file(path, TableStyle::tsv);
    each_tick(ticks, [&file, all = channels()](const TickRecord* tick) {
        for (const Channel& channel : all) {
            if (tick == nullptr) {
                file.add(std::monostate());
            } else if (channel.type == "LATENCY") {
                file.add(latency_text(tick->time_ns));
            } else {
                file.add(channel.column->value(*tick));
            }
        }
        file.end_row();
    });
    file.close();
}

void write_channels(double rate_hz, const std::filesystem::path& path) {
    DelimitedFile file(path, TableStyle::tsv);
    file.row("name", "component", "type", "tracked_point", "units", "reference_frame",
             "sampling_frequency", "description");
    for (const Channel& channel : channels()) {
        const std::string_view unit = channel.column->unit;
        file.row(channel.column->name, channel.component, channel.type,
                 channel.type == "POS" ? "handle" : "n/a",
                 unit.empty() || unit.starts_with('1') ? "n/a" : unit,
                 channel.component == "n/a" ? "n/a" : "object", rate_hz, channel.column->meaning);
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
    DelimitedFile file(path, TableStyle::tsv);
    each_tick(ticks, [&file](const TickRecord* tick) {
        constexpr std::monostate kLost;
        tick == nullptr ? file.row(kLost, kLost, kLost)
                        : file.row(tick->command.x, tick->command.y, tick->command.z);
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

std::string bids_stem(const ChosenSession& session) {
    return fmt::format("{}_ses-{:02}_task-{}", session.subject, session.number, session.label);
}

namespace fs = std::filesystem;

void write_json(const fs::path& path, const Json& members) {
    write_whole(path, json_text(members) + "\n");
}

void write_bids_run(Database& database,
                    const ChosenSession& session,
                    std::int64_t trial,
                    std::int64_t number,
                    const fs::path& session_folder) {
    TraceReader traces(database);
    for (const std::int64_t interval : {1, 2}) {
        const Ticks ticks = traces.stored(trial, interval);
        if (ticks.empty()) {
            continue;
        }
        const std::string run =
            fmt::format("{}_run-{:04}", interval == 1 ? "" : "_acq-interval2", number);
        const std::string motion = bids_stem(session) + "_tracksys-handle" + run;
        const fs::path folder = session_folder / "motion";
        fs::create_directories(folder);
        write_motion(ticks, folder / (motion + "_motion.tsv"));
        write_json(folder / (motion + "_motion.json"), motion_json(session, ticks));
        write_channels(session.rate_hz, folder / (motion + "_channels.tsv"));
        write_json(folder / (motion + "_channels.json"), channels_json());
        const fs::path stim =
            session_folder / "beh" / (bids_stem(session) + run + "_recording-force_stim");
        write_stim(ticks, stim.string() + ".tsv.gz");
        write_json(stim.string() + ".json", stim_json(session));
    }
}

Json described(const ExportColumn& column) {
    Json words{{"Description", column.meaning}};
    if (!column.unit.empty() && column.unit != "1") {
        words["Units"] = column.unit;
    }
    for (const auto& [level, what] : levels_of(column)) {
        words["Levels"][level] = what;
    }
    return words;
}

Json described(const char* words) {
    return {{"Description", words}};
}

/// The rows, and what their columns are: members of `sidecar`.
void write_described(const std::string& stem, Statement rows, const Json& sidecar) {
    DelimitedFile file(stem + ".tsv", TableStyle::tsv);
    for (const auto& [name, words] : sidecar.items()) {
        file.add(name);
    }
    file.end_row();
    write_rows(std::move(rows), file);
    write_json(stem + ".json", sidecar);
}

void write_participants(Database& database, bool details, const fs::path& folder) {
    Json sidecar{
        {"participant_id", described("the same in every export; it says nothing")},
        {"handedness",
         {{"Description", "by the Edinburgh score"},
          {"Levels",
           {{"left", "-40 or less"}, {"right", "40 or more"}, {"ambidextrous", "between"}}}}}};
    std::string score;
    if (details) {
        sidecar["edinburgh_score"] =
            described("Edinburgh handedness score, -100 left to 100 right");
        score = ", handedness";
    }
    // The standard's word for both.
    write_described(folder / "participants",
                    database.prepare(fmt::format(
                        "SELECT DISTINCT chosen.subject, replace({}, 'both', 'ambidextrous'){} "
                        "FROM chosen JOIN session USING (session_id) JOIN participant USING "
                        "(participant_id) ORDER BY chosen.subject",
                        kHandednessSql, score)),
                    sidecar);
}

void write_sessions(Database& database,
                    const std::string& subject,
                    bool details,
                    const fs::path& folder) {
    const auto kind =
        std::ranges::find(export_table("trials").columns, "session_kind", &ExportColumn::name);
    Json sidecar{{"session_id", described("the same number in every study of the session")},
                 {"studies", described("the tasks of the session")},
                 {"session_kind", described(*kind)}};
    if (details) {
        sidecar["day"] = {{"Description", "since the participant's first session here"},
                          {"Units", "d"}};
    }
    Statement row = database.prepare(
        fmt::format("SELECT printf('ses-%02d', chosen.session_number), group_concat(label, ' '), "
                    "group_concat(DISTINCT session_kind){} FROM (SELECT * FROM chosen ORDER BY "
                    "label) AS chosen JOIN session USING (session_id) WHERE subject = ?1 GROUP BY "
                    "chosen.session_number ORDER BY chosen.session_number",
                    details ? ", min(day)" : ""),
        subject);
    write_described(folder / (subject + "_sessions"), std::move(row), sidecar);
}

void write_beh(Database& database,
               const ChosenSession& session,
               bool details,
               const fs::path& folder) {
    fs::create_directories(folder);
    std::vector<ExportColumn> columns = visible_columns(export_table("trials"), details);
    std::erase_if(columns, [](const ExportColumn& column) {  // the name of the file says it
        return column.name == "subject" || column.name == "study_label" ||
               column.name == "session_number";
    });
    const std::string stem = bids_stem(session) + "_beh";
    DelimitedFile file(folder / (stem + ".tsv"), TableStyle::tsv);
    Json sidecar{{"TaskName", session.study}, {"TaskDescription", session.title}};
    for (const ExportColumn& column : columns) {
        sidecar[column.name] = described(column);
    }
    file.head(columns);
    write_rows(
        database.prepare(select_sql(export_table("trials"), columns, kOfSession), session.id),
        file);
    write_json(folder / (stem + ".json"), sidecar);
}

/// The Brain Imaging Data Structure a dataset is written to.
constexpr const char* kBidsVersion = "1.9.0";

/// @param ticks  some are there
std::string readme(const Selection& selection, const ExportOptions& options, bool ticks) {
    std::string of_ticks;
    if (ticks) {
        of_ticks =
            ", motion (the handle as POS; contact, rendered force, encoder\n"
            "counts and flags as MISC) and stim (the commanded force). run is the column "
            "trial_number of beh.\n"
            "motion.tsv has no head line, by the standard: channels.tsv names its columns.\n"
            "A lost tick is a row of n/a: row k is always tick k";
    } else if (options.traces) {
        of_ticks = ".\nThe file has no servo ticks: there is no motion and no stim";
    }
    return fmt::format(
        "# Felt shape: answers{}\n\n"
        "People felt objects that they could not see, then answered what they felt. On what device "
        "is\n"
        "the column trial_device of beh. Written by palpate as BIDS {}: {}, kind {}.\n\n"
        "What BIDS covers: participants, sessions, beh (one row an attempt at a trial, the "
        "columns\n"
        "described in the .json beside it){}.\n"
        "What it does not: the plan that was not run and the row of pictures; export CSV for "
        "these.\n"
        "Authors, licence and ethics approval are not known to palpate: add them to\n"
        "dataset_description.json before you share this.\n"
        "Units are SI. {}\n",
        ticks ? ", motion and forces" : "", kBidsVersion,
        counted(selection.sessions().size(), "session"), options.kind, of_ticks,
        options.details ? "With details of people: hand it on to nobody who may not know them."
                        : "De-identified: codes, operators, wall clock and notes are left out.");
}

}  // namespace

void export_bids(const Exporting& to) {
    const auto& [database, selection, options, folder] = to;
    write_json(folder / "dataset_description.json",
               {{"Name", selection.titles()},
                {"BIDSVersion", kBidsVersion},
                {"DatasetType", "raw"},
                {"GeneratedBy", Json::array({{{"Name", "palpate"}}})}});
    write_participants(database, options.details, folder);
    bool ticks = false;
    for (const ChosenSession& session : selection.sessions()) {
        const fs::path subject = folder / session.subject;
        const fs::path place = subject / fmt::format("ses-{:02}", session.number);
        write_beh(database, session, options.details, place / "beh");
        if (!fs::exists(subject / (session.subject + "_sessions.tsv"))) {
            write_sessions(database, session.subject, options.details, subject);
        }
        if (options.traces) {
            each_traced_trial(database, session, [&](std::int64_t trial, std::int64_t number) {
                write_bids_run(database, session, trial, number, place);
                ticks = true;
            });
        }
    }
    write_whole(folder / "README", readme(selection, options, ticks));
    if (options.keep_codes) {
        fs::create_directory(folder / "sourcedata");
        write_codes(database, folder / "sourcedata" / "codes.csv");
    }
}

}  // namespace palpate::data
