#include "protocols/file/calibration_file.hpp"

#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/sha256.hpp"
#include "engine/base/text.hpp"
#include "protocols/file/calibration_keys.hpp"
#include "protocols/file/document.hpp"
#include "protocols/library/shipped.hpp"

namespace palpate::protocols {
namespace {

using engine::Calibration;
using engine::RigRecord;

constexpr std::int64_t kCalibrationFormat = 1;
/// The hash stands in the last line, over all bytes before it.
constexpr std::string_view kSeal = "# sha256 ";

std::string sealed(const std::string& text) {
    return fmt::format("{}{}{}\n", text, kSeal, sha256_hex(text));
}

bool seal_holds(const std::string& text) {
    const std::size_t at = text.rfind(kSeal);
    return at != std::string::npos && sealed(text.substr(0, at)) == text;
}

void check_name(TableReader& table, const std::string& name) {
    constexpr std::size_t kLongestName = 64;
    if (!table.broken() && (name.empty() || name.size() > kLongestName)) {
        table.refuse("name",
                     fmt::format("name is {}: give 1 to {} bytes", shown(name), kLongestName));
    }
}

/// A machine and what lies in its table; then what all that says together.
Calibration read_machine(TableReader& table, bool gantry) {
    const auto tables = machine_tables(gantry);
    Calibration machine = gantry ? Calibration() : begun_pantograph();
    table.read(tables.front().keys, tables.front().record(machine, true));
    check_name(table, machine.name());
    bool broken = false;
    for (const MachineTable& part : tables.subspan(1)) {
        if (auto reader = table.table(part.name)) {
            reader->read_last(part.keys, part.record(machine, true));
            broken = broken || reader->broken();
        } else if (part.required && !table.broken()) {
            table.refuse(part.name,
                         fmt::format("the machine {} has no table [{}.{}]: add it",
                                     shown(machine.name()), tables.front().name, part.name));
        }
    }
    table.refuse_unknown();
    if (!broken) {
        table.attempt([&] { check(machine); });
    }
    return machine;
}

constexpr std::array<const char*, 3> kAxisNames{"axis_x", "axis_y", "axis_z"};

/// @param straight  of three straight axes, each of which has a table
RigRecord read_record(TableReader& table, bool straight) {
    RigRecord record;
    table.read(kRecordKeys.any, &record);
    if (!straight) {
        LinkageRecord linkage;
        table.read(kRecordKeys.linkage, &linkage);
        record.dynamics = linkage.dynamics;
        if (linkage.mark) {
            record.mark = engine::Vec3(*linkage.mark, 0.0);
        }
    }
    for (std::size_t i = 0; i < kAxisNames.size() && straight; ++i) {
        AxisRecord axis;
        if (auto reader = table.table(kAxisNames[i])) {
            reader->read_last(kRecordKeys.axis, &axis);
        } else {
            table.refuse(kAxisNames[i], fmt::format("there is no table [commissioning.{}]: run "
                                                    "palpate commission",
                                                    kAxisNames[i]));
        }
        record.axes[i] = axis.dynamics;
        record.mark = record.mark.value_or(engine::Vec3{});
        (*record.mark)[static_cast<int>(i)] = axis.mark;
    }
    table.refuse_unknown();
    return record;
}

void keep(TableReader& table, Calibration calibration, std::vector<Calibration>& found) {
    const std::string& name = calibration.name();
    if (std::ranges::any_of(found,
                            [&](const Calibration& other) { return other.name() == name; })) {
        table.refuse(
            "name", fmt::format("two machines are called {}: give each its own name", shown(name)));
    }
    found.push_back(std::move(calibration));
}

/// Every machine of a file, and its record, if it has one.
std::vector<Calibration> parse_rig(std::string_view text,
                                   std::string_view file_name,
                                   std::optional<RigRecord>& record) {
    const Table file = parse_document(text, file_name);
    Problems problems;
    Places places;
    TableReader top(file, "", {}, problems, places, "the calibration file");
    top.check_format(kCalibrationFormat);
    std::vector<Calibration> found;
    for (const bool gantry : {false, true}) {
        for (TableReader& table : top.tables(machine_tables(gantry).front().name)) {
            keep(table, read_machine(table, gantry), found);
        }
    }
    if (auto reader = top.table("commissioning")) {
        record = read_record(*reader, !found.empty() && found.front().gantry);
    }
    if (found.empty() && problems.none()) {
        problems.add({}, "the file holds no machine: add a [[pantograph]] or a [[gantry]] table");
    }
    top.refuse_unknown();
    problems.throw_if_any(file_name);
    return found;
}

}  // namespace

std::vector<Calibration> parse_calibrations(std::string_view text, std::string_view file_name) {
    std::optional<RigRecord> record;
    return parse_rig(text, file_name, record);
}

Calibration load_calibration(const std::string& name_or_file) {
    return load_rig(name_or_file).calibration;
}

RigFile load_rig(const std::string& name_or_file, bool also_changed) {
    std::error_code ignored;
    if (std::filesystem::exists(name_or_file, ignored)) {
        const std::string text = read_text(name_or_file, kMaxDocument);
        RigFile rig;
        auto found = parse_rig(text, name_or_file, rig.record);
        refuse_if<ProtocolError>(
            found.size() != 1,
            "{}:1:1: the file holds {} machines: leave one, or name a shipped one", name_or_file,
            found.size());
        refuse_if<ProtocolError>(rig.record && !also_changed && !seal_holds(text),
                                 "{}:1:1: the file was changed after the rig was commissioned: run "
                                 "palpate commission again, or take the table [commissioning] out "
                                 "and damping_n_s_per_m, which it measured",
                                 name_or_file);
        rig.calibration = std::move(found.front());
        return rig;
    }
    std::vector<std::string> known;
    for (const Calibration& shipped :
         parse_calibrations(shipped_pantographs(), "pantographs.toml")) {
        if (shipped.name() == name_or_file) {
            return {.calibration = shipped};
        }
        known.push_back(shipped.name());
    }
    throw ProtocolError(
        fmt::format("{}:1:1: there is no such calibration: give a file, or one of {}{}",
                    name_or_file, fmt::join(known, ", "), suggestion(name_or_file, known, "")));
}

std::string to_toml(const Calibration& calibration) {
    std::string text = fmt::format("format = {}\n", kCalibrationFormat);
    Calibration machine = calibration;
    const auto tables = machine_tables(machine.gantry.has_value());
    const std::string_view kind = tables.front().name;
    for (const MachineTable& table : tables) {
        if (const void* record = table.record(machine, false)) {
            text += table.name == kind ? fmt::format("\n[[{}]]\n", kind)
                                       : fmt::format("\n[{}.{}]\n", kind, table.name);
            text += toml_lines(table.keys, record);
        }
    }
    return text;
}

std::string calibration_id(const Calibration& calibration) {
    return sha256_hex(to_toml(calibration));
}

std::string to_toml(const Calibration& calibration, const RigRecord& record) {
    std::string text = fmt::format("{}\n[commissioning]\n{}", to_toml(calibration),
                                   toml_lines(kRecordKeys.any, &record));
    if (!calibration.gantry) {
        const LinkageRecord linkage{
            .dynamics = record.dynamics,
            .mark = record.mark ? std::optional(engine::Vec2(*record.mark)) : std::nullopt};
        return sealed(text + toml_lines(kRecordKeys.linkage, &linkage));
    }
    for (std::size_t i = 0; i < kAxisNames.size(); ++i) {
        const AxisRecord axis{.dynamics = record.axes[i],
                              .mark = record.mark.value_or(engine::Vec3{})[static_cast<int>(i)]};
        text += fmt::format("\n[commissioning.{}]\n{}", kAxisNames[i],
                            toml_lines(kRecordKeys.axis, &axis));
    }
    return sealed(text);
}

}  // namespace palpate::protocols
