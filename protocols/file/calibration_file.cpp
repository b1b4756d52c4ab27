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
using engine::GantrySpec;
using engine::PantographSpec;
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

/// The tables of a machine.
class Parts {
public:
    Parts(TableReader& table, std::string_view kind, const std::string& name)
        : table_(&table), kind_(kind), name_(name) {}

    template <class Record>
    void operator()(std::string_view name, bool required, Keys keys, Record&& record) {
        if (auto reader = table_->table(name)) {
            reader->read(keys, record());
            reader->refuse_unknown();
            broken_ = broken_ || reader->broken();
        } else if (required && !table_->broken()) {
            table_->refuse(name, fmt::format("the machine {} has no table [{}.{}]: add it",
                                             shown(name_), kind_, name));
        }
    }
    /// All keys were known and right; now what they say together. @return the machine
    Calibration checked(const Calibration& calibration) {
        table_->refuse_unknown();
        if (!broken_) {
            table_->attempt([&] { check(calibration); });
        }
        return calibration;
    }

private:
    TableReader* table_;
    std::string_view kind_;
    std::string name_;
    bool broken_ = false;
};

Calibration read_gantry(TableReader& table) {
    Calibration calibration;
    GantrySpec& machine = calibration.gantry.emplace();
    table.read(kCalibrationKeys.gantry, &machine);
    check_name(table, machine.name);
    Parts part(table, "gantry", machine.name);
    part("axis_x", true, kCalibrationKeys.straight_axis, [&] { return &machine.axes[0]; });
    part("axis_y", true, kCalibrationKeys.straight_axis, [&] { return &machine.axes[1]; });
    part("axis_z", true, kCalibrationKeys.straight_axis, [&] { return &machine.axes[2]; });
    part("board", true, kCalibrationKeys.gantry_board,
         [&] { return &calibration.board.emplace(); });
    return part.checked(calibration);
}

Calibration read_pantograph(TableReader& table) {
    Machine calibration;
    PantographSpec& machine = calibration.pantograph;
    table.read(kCalibrationKeys.pantograph, &calibration);
    check_name(table, machine.name);
    Parts part(table, "pantograph", machine.name);
    part("linkage", true, kCalibrationKeys.linkage, [&] { return &machine.linkage; });
    part("axis_1", true, kCalibrationKeys.axis, [&] { return &machine.axes[0]; });
    part("axis_2", true, kCalibrationKeys.axis, [&] { return &machine.axes[1]; });
    part("haply", false, kCalibrationKeys.haply, [&] { return &calibration.haply.emplace(); });
    part("board", false, kCalibrationKeys.board, [&] { return &calibration.board.emplace(); });
    part("comedi", false, kCalibrationKeys.comedi, [&] { return &calibration.comedi.emplace(); });
    return part.checked(calibration);
}

constexpr std::array<const char*, 3> kAxisNames{"axis_x", "axis_y", "axis_z"};

/// @param straight  of three straight axes, each of which has a table
RigRecord read_record(TableReader& table, bool straight) {
    RigRecord record;
    table.read(kCalibrationKeys.record, &record);
    if (!straight) {
        LinkageRecord linkage;
        table.read(kCalibrationKeys.linkage_record, &linkage);
        record.dynamics = linkage.dynamics;
        if (linkage.mark) {
            record.mark = engine::Vec3(*linkage.mark, 0.0);
        }
    }
    for (std::size_t i = 0; i < kAxisNames.size() && straight; ++i) {
        AxisRecord axis;
        if (auto reader = table.table(kAxisNames[i])) {
            reader->read(kCalibrationKeys.axis_record, &axis);
            reader->refuse_unknown();
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
    if (std::any_of(found.begin(), found.end(),
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
    for (TableReader& table : top.tables("pantograph")) {
        keep(table, read_pantograph(table), found);
    }
    for (TableReader& table : top.tables("gantry")) {
        keep(table, read_gantry(table), found);
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
    const auto append = [&text](std::string_view heading, Keys keys, const void* record) {
        text += fmt::format("\n{}\n{}", heading, toml_lines(keys, record));
    };
    if (calibration.gantry) {
        append("[[gantry]]", kCalibrationKeys.gantry, &*calibration.gantry);
        append("[gantry.axis_x]", kCalibrationKeys.straight_axis, &calibration.gantry->axes[0]);
        append("[gantry.axis_y]", kCalibrationKeys.straight_axis, &calibration.gantry->axes[1]);
        append("[gantry.axis_z]", kCalibrationKeys.straight_axis, &calibration.gantry->axes[2]);
        if (calibration.board) {
            append("[gantry.board]", kCalibrationKeys.gantry_board, &*calibration.board);
        }
        return text;
    }
    const Machine whole(calibration);
    const PantographSpec& machine = calibration.pantograph;
    append("[[pantograph]]", kCalibrationKeys.pantograph, &whole);
    append("[pantograph.linkage]", kCalibrationKeys.linkage, &machine.linkage);
    append("[pantograph.axis_1]", kCalibrationKeys.axis, &machine.axes[0]);
    append("[pantograph.axis_2]", kCalibrationKeys.axis, &machine.axes[1]);
    if (calibration.haply) {
        append("[pantograph.haply]", kCalibrationKeys.haply, &*calibration.haply);
    }
    if (calibration.board) {
        append("[pantograph.board]", kCalibrationKeys.board, &*calibration.board);
    }
    if (calibration.comedi) {
        append("[pantograph.comedi]", kCalibrationKeys.comedi, &*calibration.comedi);
    }
    return text;
}

std::string calibration_id(const Calibration& calibration) {
    return sha256_hex(to_toml(calibration));
}

std::string to_toml(const Calibration& calibration, const RigRecord& record) {
    std::string text = fmt::format("{}\n[commissioning]\n{}", to_toml(calibration),
                                   toml_lines(kCalibrationKeys.record, &record));
    if (!calibration.gantry) {
        const LinkageRecord linkage{
            .dynamics = record.dynamics,
            .mark = record.mark ? std::optional(engine::Vec2(*record.mark)) : std::nullopt};
        return sealed(text + toml_lines(kCalibrationKeys.linkage_record, &linkage));
    }
    for (std::size_t i = 0; i < kAxisNames.size(); ++i) {
        const AxisRecord axis{.dynamics = record.axes[i],
                              .mark = record.mark.value_or(engine::Vec3{})[static_cast<int>(i)]};
        text += fmt::format("\n[commissioning.{}]\n{}", kAxisNames[i],
                            toml_lines(kCalibrationKeys.axis_record, &axis));
    }
    return sealed(text);
}

}  // namespace palpate::protocols
