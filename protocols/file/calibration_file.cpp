#include "protocols/file/calibration_file.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "engine/base/sha256.hpp"
#include "engine/base/text.hpp"
#include "protocols/library/shipped.hpp"

namespace palpate::protocols {
namespace {

using engine::Calibration;

constexpr std::int64_t kCalibrationFormat = 1;
constexpr double kMilli = 1000.0;  // mm, mN m
constexpr std::array<std::string_view, 2> kSides{"right", "left"};
constexpr std::array<std::string_view, 2> kWays{"anticlockwise", "clockwise"};

// What a desk-top machine can be, as check() of the engine has it.
constexpr Range kLength{.min = 0.0, .max = 2000.0, .above = true};
constexpr Range kTorque{.min = 0.0, .max = 2000.0, .above = true};
constexpr Range kPort{.min = 1.0, .max = 2.0};
constexpr Range kChannel{.min = 0.0, .max = 65535.0};
constexpr Range kVolts{.min = -1000.0, .max = 1000.0};

/// As a file begins: its frame is the linkage's.
struct Machine : Calibration {
    Machine() { pantograph.origin = {}; }
    explicit Machine(const Calibration& from) : Calibration(from) {}
};

/// What lies deeper in a record than one member.
template <class Record, auto Get>
Slot in(void* record) {
    return slot_of(Get(record_at<Record>(record)));
}
/// The second word stands for true.
template <class Record, const auto& kWords, auto Get>
Slot is(void* record) {
    return OneOf{kWords, whole_of(Get(record_at<Record>(record)))};
}

using engine::ComediWiring;
using engine::FiveBar;
using engine::HaplyWiring;
using engine::OpenWiring;
using engine::PantographSpec;
using enum Need;

// clang-format off
constexpr Key kPantograph[]{
    {.name = "name", .slot = in<Machine, [](auto& r) -> auto& { return r.pantograph.name; }>, .need = required, .form = Form::any,
     .meaning = "of the machine, 1 to 64 bytes"},
    {.name = "origin_mm", .slot = in<Machine, [](auto& r) -> auto& { return r.pantograph.origin; }>, .per_si = kMilli,
     .meaning = "the object frame's origin in the linkage's frame, whose x axis leads from pivot 1 to pivot 2"},
    {.name = "turn_deg", .slot = in<Machine, [](auto& r) -> auto& { return r.pantograph.turn; }>, .range = {-360, 360}, .per_si = kDegrees,
     .meaning = "from the linkage's x axis to the object frame's"},
    {.name = "home_mm", .slot = in<Machine, [](auto& r) -> auto& { return r.home; }>, .per_si = kMilli,
     .meaning = "rest pose of the handle when the device is switched on; left out: by hand"},
    {.name = "damping_n_s_per_m", .slot = in<Machine, [](auto& r) -> auto& { return r.pantograph.damping; }>, .range = {0, 100},
     .meaning = "of the machine at its handle, the least in the workspace"},
    {.name = "motor_time_s", .slot = in<Machine, [](auto& r) -> auto& { return r.pantograph.motor_time; }>, .range = {0, 1e5},
     .meaning = "thermal time constant of the motors; 0: not known"},
    {.name = "clearance_mm", .slot = in<Machine, [](auto& r) -> auto& { return r.pantograph.clearance; }>, .range = {0, 50, true}, .per_si = kMilli,
     .meaning = "poses closer to a singular one are refused"},
};

constexpr Key kLinkage[]{
    {.name = "driven_1_mm", .slot = at<&FiveBar::driven_1>, .need = required, .range = kLength, .per_si = kMilli,
     .meaning = "link at pivot 1"},
    {.name = "driven_2_mm", .slot = at<&FiveBar::driven_2>, .need = required, .range = kLength, .per_si = kMilli,
     .meaning = "link at pivot 2"},
    {.name = "free_1_mm", .slot = at<&FiveBar::free_1>, .need = required, .range = kLength, .per_si = kMilli,
     .meaning = "from elbow 1 to the handle"},
    {.name = "free_2_mm", .slot = at<&FiveBar::free_2>, .need = required, .range = kLength, .per_si = kMilli,
     .meaning = "from elbow 2 to the handle"},
    {.name = "base_mm", .slot = at<&FiveBar::base>, .need = required, .range = {0, 2000}, .per_si = kMilli,
     .meaning = "between the pivots"},
    {.name = "elbow_1", .slot = is<FiveBar, kSides, [](auto& r) -> auto& { return r.mode.elbow_1_left; }>,
     .meaning = "side of the line from pivot 1 to the handle"},
    {.name = "elbow_2", .slot = is<FiveBar, kSides, [](auto& r) -> auto& { return r.mode.elbow_2_left; }>,
     .meaning = "side of the line from pivot 2 to the handle"},
    {.name = "handle", .slot = is<FiveBar, kSides, [](auto& r) -> auto& { return r.mode.handle_left; }>,
     .meaning = "side of the line from elbow 1 to elbow 2"},
};

constexpr Key kAxis[]{
    {.name = "counts_per_turn", .slot = at<&engine::Axis::counts_per_turn>, .need = required, .range = {0, 1e9, true},
     .meaning = "of the encoder, at the joint"},
    {.name = "zero_deg", .slot = at<&engine::Axis::zero>, .need = required, .range = {-720, 720}, .per_si = kDegrees,
     .meaning = "angle at count 0"},
    {.name = "torque_limit_mn_m", .slot = at<&engine::Axis::torque_limit>, .need = required, .range = kTorque, .per_si = kMilli,
     .meaning = "the most that the motor gives, at the joint"},
    {.name = "torque_forever_mn_m", .slot = at<&engine::Axis::torque_forever>, .need = required, .range = kTorque, .per_si = kMilli,
     .meaning = "what it can give for ever"},
    {.name = "codes_full_scale", .slot = at<&engine::Axis::codes_full_scale>, .need = required, .range = {1, 2147483647},
     .meaning = "code of the torque limit"},
};

constexpr Key kHaply[]{
    {.name = "id", .slot = at<&HaplyWiring::id>, .range = {1, 255},
     .meaning = "of the device on the board"},
    {.name = "port_1", .slot = in<HaplyWiring, [](auto& r) -> auto& { return r.port[0]; }>, .range = kPort,
     .meaning = "of pivot 1"},
    {.name = "port_2", .slot = in<HaplyWiring, [](auto& r) -> auto& { return r.port[1]; }>, .range = kPort,
     .meaning = "of pivot 2"},
    {.name = "motor_1", .slot = is<HaplyWiring, kWays, [](auto& r) -> auto& { return r.motor_clockwise[0]; }>,
     .meaning = "which way a positive torque turns"},
    {.name = "motor_2", .slot = is<HaplyWiring, kWays, [](auto& r) -> auto& { return r.motor_clockwise[1]; }>,
     .meaning = "the same at pivot 2"},
    {.name = "encoder_1", .slot = is<HaplyWiring, kWays, [](auto& r) -> auto& { return r.encoder_clockwise[0]; }>,
     .meaning = "which way counts grow"},
    {.name = "encoder_2", .slot = is<HaplyWiring, kWays, [](auto& r) -> auto& { return r.encoder_clockwise[1]; }>,
     .meaning = "the same at pivot 2"},
    {.name = "grip_pin", .slot = [](void* r) -> Slot { return whole_of(record_at<HaplyWiring>(r).grip_pin); }, .range = {54, 65},
     .meaning = "analogue input that tells a held handle; left out: none"},
    {.name = "grip_threshold_adc", .slot = at<&HaplyWiring::grip_threshold>, .range = {0, 4095},
     .meaning = "the handle is held from this value up"},
};

constexpr Key kBoard[]{
    {.name = "id", .slot = [](void* r) -> Slot { return whole_of(record_at<OpenWiring>(r).id); }, .range = {0, 4294967295},
     .meaning = "the board's own; left out: any board"},
    {.name = "watchdog_ms", .slot = at<&OpenWiring::watchdog>, .range = {5, 50}, .per_si = kMilli,
     .meaning = "without a torque for so long the board stops"},
    {.name = "channel_1", .slot = in<OpenWiring, [](auto& r) -> auto& { return r.channel[0]; }>, .range = kPort,
     .meaning = "of pivot 1, motor and encoder"},
    {.name = "channel_2", .slot = in<OpenWiring, [](auto& r) -> auto& { return r.channel[1]; }>, .range = kPort,
     .meaning = "of pivot 2"},
    {.name = "motor_1", .slot = is<OpenWiring, kWays, [](auto& r) -> auto& { return r.motor_clockwise[0]; }>,
     .meaning = "which way a positive torque turns"},
    {.name = "motor_2", .slot = is<OpenWiring, kWays, [](auto& r) -> auto& { return r.motor_clockwise[1]; }>,
     .meaning = "the same at pivot 2"},
    {.name = "encoder_1", .slot = is<OpenWiring, kWays, [](auto& r) -> auto& { return r.encoder_clockwise[0]; }>,
     .meaning = "which way counts grow"},
    {.name = "encoder_2", .slot = is<OpenWiring, kWays, [](auto& r) -> auto& { return r.encoder_clockwise[1]; }>,
     .meaning = "the same at pivot 2"},
};

constexpr Key kComedi[]{
    {.name = "counter_subdevice", .slot = at<&ComediWiring::counter_subdevice>, .range = kChannel,
     .meaning = "of the card's counters"},
    {.name = "counter_1", .slot = in<ComediWiring, [](auto& r) -> auto& { return r.counter[0]; }>, .range = kChannel,
     .meaning = "channel of pivot 1"},
    {.name = "counter_2", .slot = in<ComediWiring, [](auto& r) -> auto& { return r.counter[1]; }>, .range = kChannel,
     .meaning = "channel of pivot 2"},
    {.name = "turns_1", .slot = is<ComediWiring, kWays, [](auto& r) -> auto& { return r.counter_clockwise[0]; }>,
     .meaning = "which way counts grow"},
    {.name = "turns_2", .slot = is<ComediWiring, kWays, [](auto& r) -> auto& { return r.counter_clockwise[1]; }>,
     .meaning = "the same at pivot 2"},
    {.name = "output_subdevice", .slot = at<&ComediWiring::output_subdevice>, .range = kChannel,
     .meaning = "of the card's analogue outputs"},
    {.name = "output_1", .slot = in<ComediWiring, [](auto& r) -> auto& { return r.output[0]; }>, .range = kChannel,
     .meaning = "channel of pivot 1"},
    {.name = "output_2", .slot = in<ComediWiring, [](auto& r) -> auto& { return r.output[1]; }>, .range = kChannel,
     .meaning = "channel of pivot 2"},
    {.name = "output_range", .slot = at<&ComediWiring::range>, .range = kChannel,
     .meaning = "of the outputs, by its number"},
    {.name = "volts_per_n_m_1", .slot = in<ComediWiring, [](auto& r) -> auto& { return r.volts_per_newton_metre[0]; }>, .range = kVolts,
     .meaning = "of motor 1; negative: it turns the other way"},
    {.name = "volts_per_n_m_2", .slot = in<ComediWiring, [](auto& r) -> auto& { return r.volts_per_newton_metre[1]; }>, .range = kVolts,
     .meaning = "of motor 2"},
};

constexpr double kGrams = 1e3;
constexpr double kGramSquareCm = 1e7;  // g cm^2

using engine::RigRecord;

constexpr Key kRecord[]{
    {.name = "device", .slot = at<&RigRecord::device>, .need = required, .form = Form::free,
     .meaning = "that was commissioned, as --device has it"},
    {.name = "program", .slot = at<&RigRecord::program>, .need = required, .form = Form::free,
     .meaning = "version of the program that did it"},
    {.name = "calibration_sha256", .slot = at<&RigRecord::calibration>, .need = required, .form = Form::free,
     .meaning = "of the calibration's canonical text"},
    {.name = "handle_g", .slot = in<RigRecord, [](auto& r) -> auto& { return r.dynamics.handle_mass; }>, .need = required, .range = {0, 1e4}, .per_si = kGrams,
     .meaning = "handle and free links, lumped at the handle"},
    {.name = "inertia_1_g_cm2", .slot = in<RigRecord, [](auto& r) -> auto& { return r.dynamics.inertia.x; }>, .need = required, .range = {0, 1e7}, .per_si = kGramSquareCm,
     .meaning = "driven link 1 with its motor"},
    {.name = "inertia_2_g_cm2", .slot = in<RigRecord, [](auto& r) -> auto& { return r.dynamics.inertia.y; }>, .need = required, .range = {0, 1e7}, .per_si = kGramSquareCm,
     .meaning = "driven link 2 with its motor"},
    {.name = "damping_1_mn_m_s", .slot = in<RigRecord, [](auto& r) -> auto& { return r.dynamics.damping.x; }>, .need = required, .range = {0, 1e4}, .per_si = kMilli,
     .meaning = "at motor 1, by rad/s"},
    {.name = "damping_2_mn_m_s", .slot = in<RigRecord, [](auto& r) -> auto& { return r.dynamics.damping.y; }>, .need = required, .range = {0, 1e4}, .per_si = kMilli,
     .meaning = "at motor 2, by rad/s"},
    {.name = "friction_1_mn_m", .slot = in<RigRecord, [](auto& r) -> auto& { return r.dynamics.friction.x; }>, .need = required, .range = {0, 1e4}, .per_si = kMilli,
     .meaning = "dry, at motor 1"},
    {.name = "friction_2_mn_m", .slot = in<RigRecord, [](auto& r) -> auto& { return r.dynamics.friction.y; }>, .need = required, .range = {0, 1e4}, .per_si = kMilli,
     .meaning = "dry, at motor 2"},
    {.name = "pulse_n", .slot = at<&RigRecord::force>, .need = required, .range = {0.01, 0.3},
     .meaning = "force of the pulses that open a session"},
    {.name = "damping_n_s_per_m", .slot = at<&RigRecord::damping>, .need = required, .range = {0, 1e3},
     .meaning = "at the handle, the least in the workspace, less a fifth"},
    {.name = "friction_n", .slot = at<&RigRecord::friction>, .need = required, .range = {0, 1e3},
     .meaning = "dry, at the handle, the least where it was pushed"},
    {.name = "round_trip_ms", .slot = at<&RigRecord::round_trip>, .need = required, .range = {0, 1e3}, .per_si = kMilli,
     .meaning = "from a question to its answer; 0: the device is not asked"},
    {.name = "rate_hz", .slot = at<&RigRecord::rate_hz>, .need = required, .range = {0, 1e4},
     .meaning = "at which every tick has a new reading, one tick old"},
    {.name = "stiffness_n_per_m", .slot = at<&RigRecord::stiffness>, .need = required, .range = {0, 1e6},
     .meaning = "usable at 1 kHz"},
    {.name = "mark_mm", .slot = at<&RigRecord::mark>, .range = {-1000, 1000}, .per_si = kMilli,
     .meaning = "where the handle is brought at each opening; left out: the operator's word"},
};
// clang-format on

/// The hash stands in the last line, over all bytes before it.
constexpr std::string_view kSeal = "# sha256 ";

std::string sealed(const std::string& text) {
    return fmt::format("{}{}{}\n", text, kSeal, sha256_hex(text));
}

bool seal_holds(const std::string& text) {
    const std::size_t at = text.rfind(kSeal);
    return at != std::string::npos && sealed(text.substr(0, at)) == text;
}

Calibration read_pantograph(TableReader& table) {
    Machine calibration;
    PantographSpec& machine = calibration.pantograph;
    table.read(kPantograph, &calibration);
    constexpr std::size_t kLongestName = 64;
    if (!table.broken() && (machine.name.empty() || machine.name.size() > kLongestName)) {
        table.refuse("name", fmt::format("name is {}: give 1 to {} bytes", shown(machine.name),
                                         kLongestName));
    }
    bool parts_broken = false;
    const auto part = [&](std::string_view name, bool required, Keys keys, auto&& record) {
        if (auto reader = table.table(name)) {
            reader->read(keys, record());
            reader->refuse_unknown();
            parts_broken = parts_broken || reader->broken();
        } else if (required && !table.broken()) {
            table.refuse(name, fmt::format("the machine {} has no table [pantograph.{}]: add it",
                                           shown(machine.name), name));
        }
    };
    part("linkage", true, kLinkage, [&] { return &machine.linkage; });
    part("axis_1", true, kAxis, [&] { return &machine.axes[0]; });
    part("axis_2", true, kAxis, [&] { return &machine.axes[1]; });
    part("haply", false, kHaply, [&] { return &calibration.haply.emplace(); });
    part("board", false, kBoard, [&] { return &calibration.board.emplace(); });
    part("comedi", false, kComedi, [&] { return &calibration.comedi.emplace(); });
    table.refuse_unknown();
    if (!parts_broken) {
        table.attempt([&] { check(calibration); });
    }
    return calibration;
}

}  // namespace

std::vector<TableText> calibration_reference() {
    return {{"[[pantograph]]", "once for each machine", kPantograph},
            {"[pantograph.linkage]", "required", kLinkage},
            {"[pantograph.axis_1]", "and [pantograph.axis_2], required", kAxis},
            {"[pantograph.haply]", "of a Haply board", kHaply},
            {"[pantograph.board]", "of an open board", kBoard},
            {"[pantograph.comedi]", "of a DAQ card", kComedi},
            {"[commissioning]", "written by palpate commission", kRecord}};
}

namespace {

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
        Calibration calibration = read_pantograph(table);
        const std::string& name = calibration.pantograph.name;
        if (std::any_of(found.begin(), found.end(),
                        [&](const Calibration& other) { return other.pantograph.name == name; })) {
            table.refuse("name", fmt::format("two machines are called {}: give each its own name",
                                             shown(name)));
        }
        found.push_back(std::move(calibration));
    }
    if (auto reader = top.table("commissioning")) {
        reader->read(kRecord, &record.emplace());
        reader->refuse_unknown();
    }
    if (found.empty() && problems.none()) {
        problems.add({}, "the file holds no machine: add a [[pantograph]] table");
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

RigFile load_rig(const std::string& name_or_file) {
    std::error_code ignored;
    if (std::filesystem::exists(name_or_file, ignored)) {
        const std::string text = read_text(name_or_file, kMostDocument);
        RigFile rig;
        auto found = parse_rig(text, name_or_file, rig.record);
        if (found.size() != 1) {
            throw ProtocolError(
                fmt::format("{}:1:1: the file holds {} machines: leave one, or name a shipped one",
                            name_or_file, found.size()));
        }
        if (rig.record && !seal_holds(text)) {
            throw ProtocolError(fmt::format(
                "{}:1:1: the file was changed after the rig was commissioned: run palpate "
                "commission again, or take the table [commissioning] out",
                name_or_file));
        }
        rig.calibration = std::move(found.front());
        return rig;
    }
    std::string names;
    std::vector<std::string> known;
    for (const Calibration& shipped :
         parse_calibrations(shipped_pantographs(), "pantographs.toml")) {
        if (shipped.pantograph.name == name_or_file) {
            return {.calibration = shipped};
        }
        known.push_back(shipped.pantograph.name);
        names += (names.empty() ? "" : ", ") + shipped.pantograph.name;
    }
    throw ProtocolError(
        fmt::format("{}:1:1: there is no such calibration: give a file, or one of {}{}",
                    name_or_file, names, suggestion(name_or_file, known, "")));
}

std::string to_toml(const Calibration& calibration) {
    std::string text = fmt::format("format = {}\n", kCalibrationFormat);
    const auto append = [&text](std::string_view heading, Keys keys, const void* record) {
        text += fmt::format("\n{}\n{}", heading, toml_lines(keys, record));
    };
    const Machine whole(calibration);
    const PantographSpec& machine = calibration.pantograph;
    append("[[pantograph]]", kPantograph, &whole);
    append("[pantograph.linkage]", kLinkage, &machine.linkage);
    append("[pantograph.axis_1]", kAxis, &machine.axes[0]);
    append("[pantograph.axis_2]", kAxis, &machine.axes[1]);
    if (calibration.haply) {
        append("[pantograph.haply]", kHaply, &*calibration.haply);
    }
    if (calibration.board) {
        append("[pantograph.board]", kBoard, &*calibration.board);
    }
    if (calibration.comedi) {
        append("[pantograph.comedi]", kComedi, &*calibration.comedi);
    }
    return text;
}

std::string calibration_id(const Calibration& calibration) {
    return sha256_hex(to_toml(calibration));
}

std::string to_toml(const Calibration& calibration, const RigRecord& record) {
    return sealed(
        fmt::format("{}\n[commissioning]\n{}", to_toml(calibration), toml_lines(kRecord, &record)));
}

}  // namespace palpate::protocols
