#include "protocols/file/calibration_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "engine/base/sha256.hpp"
#include "engine/math/elementary.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/file/read_text.hpp"
#include "protocols/file/table_view.hpp"
#include "protocols/file/toml_text.hpp"
#include "protocols/library/shipped.hpp"

namespace palpate::protocols {
namespace {

using engine::Calibration;

constexpr int kCalibrationFormat = 1;
constexpr double kMilli = 1000.0;                 // mm, mN m
constexpr double kDegrees = 180.0 / engine::kPi;  // of a radian
constexpr std::size_t kLongestName = 64;
constexpr std::array<std::string_view, 2> kSides{"right", "left"};
constexpr std::array<std::string_view, 2> kWays{"anticlockwise", "clockwise"};

// Wide: check() of the engine refuses what no machine can be. These only keep the units apart.
constexpr Range kLength{.lowest = 0.0, .highest = 2000.0, .above = true};
constexpr Range kTorque{.lowest = 0.0, .highest = 1e6, .above = true};

template <class Integer>
Integer whole(TableView& table, std::string_view key, const Range& range, Integer otherwise) {
    const double value = table.number(key, range, static_cast<double>(otherwise));
    if (std::isfinite(value) && value != std::floor(value)) {
        table.refuse(key, fmt::format("{} is {}: give a whole number", key, value));
    }
    return table.broken() ? otherwise : static_cast<Integer>(value);
}

bool is(TableView& table,
        std::string_view key,
        std::span<const std::string_view> words,
        bool otherwise) {
    return table.choice(key, words, otherwise ? 1U : 0U) == 1U;
}

std::optional<engine::Vec2> place(TableView& table, std::string_view key) {
    const std::vector<double> xy = table.numbers_or_none(key);
    if (xy.empty()) {
        return std::nullopt;
    }
    if (xy.size() != 2) {
        table.refuse(key, fmt::format("{} has {} coordinates: give [x, y]", key, xy.size()));
        return std::nullopt;
    }
    return engine::Vec2{xy[0] / kMilli, xy[1] / kMilli};
}

engine::FiveBar read_linkage(TableView& table) {
    engine::FiveBar linkage;
    linkage.driven_1 = table.required_number("driven_1_mm", kLength) / kMilli;
    linkage.driven_2 = table.required_number("driven_2_mm", kLength) / kMilli;
    linkage.free_1 = table.required_number("free_1_mm", kLength) / kMilli;
    linkage.free_2 = table.required_number("free_2_mm", kLength) / kMilli;
    linkage.base = table.required_number("base_mm", {.lowest = 0.0, .highest = 2000.0}) / kMilli;
    linkage.mode = {.elbow_1_left = is(table, "elbow_1", kSides, true),
                    .elbow_2_left = is(table, "elbow_2", kSides, false),
                    .handle_left = is(table, "handle", kSides, true)};
    table.refuse_unknown();
    return linkage;
}

engine::Axis read_axis(TableView& table) {
    engine::Axis axis;
    axis.counts_per_turn =
        table.required_number("counts_per_turn", {.lowest = 0.0, .highest = 1e9, .above = true});
    axis.zero = table.required_number("zero_deg", {.lowest = -720.0, .highest = 720.0}) / kDegrees;
    axis.torque_limit = table.required_number("torque_limit_mn_m", kTorque) / kMilli;
    axis.torque_forever = table.required_number("torque_forever_mn_m", kTorque) / kMilli;
    axis.codes_full_scale =
        table.required_number("codes_full_scale", {.lowest = 1.0, .highest = 2147483647.0});
    table.refuse_unknown();
    return axis;
}

engine::HaplyWiring read_haply(TableView& table) {
    engine::HaplyWiring wiring;
    wiring.id = whole<std::uint8_t>(table, "id", {.lowest = 1.0, .highest = 255.0}, wiring.id);
    const Range ports{.lowest = 1.0, .highest = 2.0};
    wiring.port = {whole<std::uint8_t>(table, "port_1", ports, 1),
                   whole<std::uint8_t>(table, "port_2", ports, 2)};
    wiring.motor_clockwise = {is(table, "motor_1", kWays, false),
                              is(table, "motor_2", kWays, false)};
    wiring.encoder_clockwise = {is(table, "encoder_1", kWays, false),
                                is(table, "encoder_2", kWays, false)};
    const auto pin = whole<std::uint8_t>(table, "grip_pin", {.lowest = 54.0, .highest = 65.0}, 0);
    if (pin != 0) {
        wiring.grip_pin = pin;
    }
    wiring.grip_threshold = table.number("grip_threshold_adc", {.lowest = 0.0, .highest = 4095.0},
                                         wiring.grip_threshold);
    table.refuse_unknown();
    return wiring;
}

engine::ComediWiring read_comedi(TableView& table) {
    engine::ComediWiring wiring;
    const Range channel{.lowest = 0.0, .highest = 65535.0};
    const auto number = [&](std::string_view key, std::uint32_t otherwise) {
        return whole<std::uint32_t>(table, key, channel, otherwise);
    };
    wiring.counter_subdevice = number("counter_subdevice", wiring.counter_subdevice);
    wiring.counter = {number("counter_1", wiring.counter[0]),
                      number("counter_2", wiring.counter[1])};
    wiring.counter_clockwise = {is(table, "turns_1", kWays, false),
                                is(table, "turns_2", kWays, false)};
    wiring.output_subdevice = number("output_subdevice", wiring.output_subdevice);
    wiring.output = {number("output_1", wiring.output[0]), number("output_2", wiring.output[1])};
    wiring.range = number("output_range", wiring.range);
    const Range volts{.lowest = -1e6, .highest = 1e6};
    wiring.volts_per_newton_metre = {
        table.number("volts_per_n_m_1", volts, wiring.volts_per_newton_metre[0]),
        table.number("volts_per_n_m_2", volts, wiring.volts_per_newton_metre[1])};
    table.refuse_unknown();
    return wiring;
}

Calibration read_pantograph(TableView table) {
    Calibration calibration;
    engine::PantographSpec& machine = calibration.pantograph;
    machine.name = table.required_text("name");
    if (!table.broken() && (machine.name.empty() || machine.name.size() > kLongestName)) {
        table.refuse("name", fmt::format("name is {}: give 1 to {} bytes", shown(machine.name),
                                         kLongestName));
    }
    machine.origin = place(table, "origin_mm").value_or(engine::Vec2{});
    machine.turn = table.number("turn_deg", {.lowest = -360.0, .highest = 360.0}, 0.0) / kDegrees;
    calibration.home = place(table, "home_mm");
    const double damping = table.number("damping_n_s_per_m", {.lowest = 0.0, .highest = 1e3}, -1.0);
    if (damping >= 0.0) {
        machine.damping = damping;
    }
    machine.motor_time = table.number("motor_time_s", {.lowest = 0.0, .highest = 1e5}, 0.0);
    machine.clearance =
        table.number("clearance_mm", {.lowest = 0.0, .highest = 50.0, .above = true}, 1.0) / kMilli;

    bool parts_broken = false;
    const auto part = [&](std::string_view name, bool required, auto&& read) {
        if (auto view = table.table(name)) {
            read(*view);
            parts_broken = parts_broken || view->broken();
        } else if (required && !table.broken()) {
            table.refuse(name, fmt::format("the machine {} has no table [pantograph.{}]: add it",
                                           shown(machine.name), name));
        }
    };
    part("linkage", true, [&](TableView& t) { machine.linkage = read_linkage(t); });
    part("axis_1", true, [&](TableView& t) { machine.axes[0] = read_axis(t); });
    part("axis_2", true, [&](TableView& t) { machine.axes[1] = read_axis(t); });
    part("haply", false, [&](TableView& t) { calibration.haply = read_haply(t); });
    part("comedi", false, [&](TableView& t) { calibration.comedi = read_comedi(t); });
    table.refuse_unknown();
    if (!parts_broken) {
        table.attempt([&] { check(calibration); });
    }
    return calibration;
}

/// "key = value" lines of one table.
class Writer {
public:
    explicit Writer(std::string& text) : text_(&text) {}

    void head(std::string_view table) { *text_ += fmt::format("\n{}\n", table); }
    void number(std::string_view key, double si, double per_si = 1.0) {
        line(key, toml_text(si, per_si));
    }
    void place(std::string_view key, const engine::Vec2& p) {
        line(key, fmt::format("[{}, {}]", toml_text(p.x, kMilli), toml_text(p.y, kMilli)));
    }
    void text(std::string_view key, const std::string& value) { line(key, toml_text(value)); }
    void word(std::string_view key, std::span<const std::string_view> words, bool second) {
        line(key, fmt::format("\"{}\"", words[second ? 1 : 0]));
    }

private:
    void line(std::string_view key, const std::string& value) {
        *text_ += fmt::format("{} = {}\n", key, value);
    }

    std::string* text_;
};

void write_linkage(Writer& out, const engine::FiveBar& linkage) {
    out.head("[pantograph.linkage]");
    out.number("driven_1_mm", linkage.driven_1, kMilli);
    out.number("driven_2_mm", linkage.driven_2, kMilli);
    out.number("free_1_mm", linkage.free_1, kMilli);
    out.number("free_2_mm", linkage.free_2, kMilli);
    out.number("base_mm", linkage.base, kMilli);
    out.word("elbow_1", kSides, linkage.mode.elbow_1_left);
    out.word("elbow_2", kSides, linkage.mode.elbow_2_left);
    out.word("handle", kSides, linkage.mode.handle_left);
}

void write_axis(Writer& out, std::string_view head, const engine::Axis& axis) {
    out.head(head);
    out.number("counts_per_turn", axis.counts_per_turn);
    out.number("zero_deg", axis.zero, kDegrees);
    out.number("torque_limit_mn_m", axis.torque_limit, kMilli);
    out.number("torque_forever_mn_m", axis.torque_forever, kMilli);
    out.number("codes_full_scale", axis.codes_full_scale);
}

void write_haply(Writer& out, const engine::HaplyWiring& wiring) {
    out.head("[pantograph.haply]");
    out.number("id", wiring.id);
    out.number("port_1", wiring.port[0]);
    out.number("port_2", wiring.port[1]);
    out.word("motor_1", kWays, wiring.motor_clockwise[0]);
    out.word("motor_2", kWays, wiring.motor_clockwise[1]);
    out.word("encoder_1", kWays, wiring.encoder_clockwise[0]);
    out.word("encoder_2", kWays, wiring.encoder_clockwise[1]);
    if (wiring.grip_pin) {
        out.number("grip_pin", *wiring.grip_pin);
    }
    out.number("grip_threshold_adc", wiring.grip_threshold);
}

void write_comedi(Writer& out, const engine::ComediWiring& wiring) {
    out.head("[pantograph.comedi]");
    out.number("counter_subdevice", wiring.counter_subdevice);
    out.number("counter_1", wiring.counter[0]);
    out.number("counter_2", wiring.counter[1]);
    out.word("turns_1", kWays, wiring.counter_clockwise[0]);
    out.word("turns_2", kWays, wiring.counter_clockwise[1]);
    out.number("output_subdevice", wiring.output_subdevice);
    out.number("output_1", wiring.output[0]);
    out.number("output_2", wiring.output[1]);
    out.number("output_range", wiring.range);
    out.number("volts_per_n_m_1", wiring.volts_per_newton_metre[0]);
    out.number("volts_per_n_m_2", wiring.volts_per_newton_metre[1]);
}

}  // namespace

std::vector<Calibration> parse_calibrations(std::string_view text, std::string_view file_name) {
    const Table file = parse_document(text, file_name);
    Problems problems;
    TableView top(file, "the calibration file", {}, problems);
    const double format = top.required_number("format", {});
    if (!top.broken() && format != kCalibrationFormat) {
        top.refuse("format", fmt::format("format is {}: this program reads format = {}", format,
                                         kCalibrationFormat));
    }
    std::vector<Calibration> found;
    for (TableView& table : top.tables("pantograph")) {
        Calibration calibration = read_pantograph(table);
        const std::string& name = calibration.pantograph.name;
        if (std::any_of(found.begin(), found.end(),
                        [&](const Calibration& other) { return other.pantograph.name == name; })) {
            table.refuse("name", fmt::format("two machines are called {}: give each its own name",
                                             shown(name)));
        }
        found.push_back(std::move(calibration));
    }
    if (found.empty() && problems.none()) {
        problems.add({}, "the file holds no machine: add a [[pantograph]] table");
    }
    top.refuse_unknown();
    problems.throw_if_any(file_name);
    return found;
}

Calibration load_calibration(const std::string& name_or_file) {
    std::error_code ignored;
    if (std::filesystem::exists(name_or_file, ignored)) {
        auto found = parse_calibrations(read_text(name_or_file, kMostDocument), name_or_file);
        if (found.size() != 1) {
            throw ProtocolError(
                fmt::format("{}:1:1: the file holds {} machines: leave one, or name a shipped one",
                            name_or_file, found.size()));
        }
        return found.front();
    }
    std::string names;
    std::vector<std::string> known;
    for (const Calibration& shipped :
         parse_calibrations(shipped_pantographs(), "pantographs.toml")) {
        if (shipped.pantograph.name == name_or_file) {
            return shipped;
        }
        known.push_back(shipped.pantograph.name);
        names += (names.empty() ? "" : ", ") + shipped.pantograph.name;
    }
    throw ProtocolError(
        fmt::format("{}:1:1: there is no such calibration: give a file, or one of {}{}",
                    name_or_file, names, suggestion(name_or_file, known, "")));
}

std::string to_toml(const Calibration& calibration) {
    const engine::PantographSpec& machine = calibration.pantograph;
    std::string text = fmt::format("format = {}\n", kCalibrationFormat);
    Writer out(text);
    out.head("[[pantograph]]");
    out.text("name", machine.name);
    out.place("origin_mm", machine.origin);
    out.number("turn_deg", machine.turn, kDegrees);
    if (calibration.home) {
        out.place("home_mm", *calibration.home);
    }
    if (machine.damping) {
        out.number("damping_n_s_per_m", *machine.damping);
    }
    out.number("motor_time_s", machine.motor_time);
    out.number("clearance_mm", machine.clearance, kMilli);
    write_linkage(out, machine.linkage);
    write_axis(out, "[pantograph.axis_1]", machine.axes[0]);
    write_axis(out, "[pantograph.axis_2]", machine.axes[1]);
    if (calibration.haply) {
        write_haply(out, *calibration.haply);
    }
    if (calibration.comedi) {
        write_comedi(out, *calibration.comedi);
    }
    return text;
}

std::string calibration_id(const Calibration& calibration) {
    return sha256_hex(to_toml(calibration));
}

}  // namespace palpate::protocols
