#include "data/trace/columns.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstring>

#include <fmt/format.h>

namespace palpate::data {
namespace {

using engine::TickRecord;

static_assert(std::endian::native == std::endian::little,
              "trace columns are copied as they lie in memory");

constexpr std::size_t kSecond = sizeof(std::int32_t);

template <class Field, std::size_t kAt>
Field field(const TickRecord& tick) {
    Field value{};
    std::memcpy(&value, reinterpret_cast<const std::byte*>(&tick) + kAt, sizeof value);
    return value;
}

template <class Field, std::size_t kAt>
TickValue number(const TickRecord& tick) {
    if constexpr (std::floating_point<Field>) {
        return static_cast<double>(field<Field, kAt>(tick));
    } else {
        return std::int64_t{field<Field, kAt>(tick)};
    }
}

TickValue time_of(const TickRecord& tick) {
    return seconds_of(tick.time_ns);
}
TickValue mode_of(const TickRecord& tick) {
    return to_string(tick.mode);
}

template <class Field, std::size_t kAt>
constexpr TraceColumn column(std::string_view name,
                             std::string_view unit,
                             std::string_view meaning) {
    constexpr bool real = std::floating_point<Field>;
    constexpr std::string_view memory = real ? (sizeof(Field) == 8 ? "f64le" : "f32le")
                                      : sizeof(Field) == 8 ? "i64le"
                                      : sizeof(Field) == 4 ? "i32le"
                                      : sizeof(Field) == 2 ? "i16le"
                                                           : "u8";
    return {
        name, real ? "real" : "integer", unit, meaning, number<Field, kAt>, memory, sizeof(Field),
        kAt};
}

/// A column that says its field in another way.
constexpr TraceColumn said(TraceColumn column,
                           std::string_view type,
                           TickValue (*value)(const TickRecord&)) {
    column.type = type;
    column.value = value;
    return column;
}

constexpr std::array kColumns{
    column<std::int64_t, offsetof(TickRecord, tick)>(
        "tick", "1", "number of the tick in its interval, from 0; a jump: ticks were lost"),
    said(column<std::int64_t, offsetof(TickRecord, time_ns)>(
             "time_s",
             "s",
             "since the interval's first deadline, on the servo's clock, in whole ns"),
         "real",
         time_of),
    column<std::int32_t, offsetof(TickRecord, counts)>(
        "count_1", "1", "encoder of motor 1 as read"),
    column<std::int32_t, offsetof(TickRecord, counts) + kSecond>(
        "count_2", "1", "encoder of motor 2 as read"),
    column<std::int32_t, offsetof(TickRecord, codes)>("code_1", "1", "as written to motor 1"),
    column<std::int32_t, offsetof(TickRecord, codes) + kSecond>(
        "code_2", "1", "as written to motor 2"),
    column<float, offsetof(TickRecord, lateness_us)>("lateness_us", "us", "wake-up minus deadline"),
    column<std::uint8_t, offsetof(TickRecord, flags)>(
        "flags",
        "1",
        "sum of 1 saturated, 2 late, 4 ramped, 8 fault, 16 skipped (out of reach: nothing was "
        "computed), "
        "32 force cut, 64 force slew (it changed as fast as it may), 128 stale (no new reading)"),
    said(column<std::uint8_t, offsetof(TickRecord, mode)>(
             "mode", "", "of the contact: free, stuck, slip, transition"),
         "text",
         mode_of),
    column<std::int16_t, offsetof(TickRecord, segment)>(
        "segment",
        "1",
        "under the god-object: i >= 0 segment i, from 0; -1 - j vertex j, at the end of segment j; "
        "in "
        "space the surface, from 0"),
    column<double, offsetof(TickRecord, u)>("u",
                                            "1 or rad",
                                            "of the god-object: its segment's own parameter (0 to "
                                            "1, or its knots); on a vertex its angle, rad"),
    column<double, offsetof(TickRecord, hip)>(
        "hip_x_m", "m", "haptic interaction point (HIP): the handle, to the right"),
    column<double, offsetof(TickRecord, hip.y)>("hip_y_m", "m", "handle, away from the person"),
    column<double, offsetof(TickRecord, cp)>(
        "cp_x_m",
        "m",
        "closest point of the outline, to the right; out of contact the last one looked for"),
    column<double, offsetof(TickRecord, cp.y)>(
        "cp_y_m", "m", "closest point, away from the person"),
    column<double, offsetof(TickRecord, go)>("go_x_m", "m", "god-object, to the right"),
    column<double, offsetof(TickRecord, go.y)>("go_y_m", "m", "god-object, away from the person"),
    column<double, offsetof(TickRecord, force)>("rendered_x_n",
                                                "N",
                                                "rendered force on the hand, K (GO - HIP) and "
                                                "damping, to the right; less where flags has 32"),
    column<double, offsetof(TickRecord, force.y)>(
        "rendered_y_n", "N", "rendered force on the hand, away from the person"),
    column<double, offsetof(TickRecord, command)>(
        "commanded_x_n",
        "N",
        "commanded force: asked of the device, after the safety chain, to the right"),
    column<double, offsetof(TickRecord, command.y)>(
        "commanded_y_n", "N", "commanded force, away from the person"),
    column<double, offsetof(TickRecord, normal_force)>(
        "rendered_normal_n", "N", "rendered force along the outward normal at the god-object"),
    column<double, offsetof(TickRecord, tangential_force)>(
        "rendered_tangential_n", "N", "rendered force along the direction of travel"),
    column<double, offsetof(TickRecord, mu)>("mu", "1", "friction coefficient in force"),
    column<std::int32_t, offsetof(TickRecord, counts) + 2 * kSecond>(
        "count_3", "1", "encoder of motor 3 as read; this and what follows: 0 in the plane"),
    column<std::int32_t, offsetof(TickRecord, codes) + 2 * kSecond>(
        "code_3", "1", "as written to motor 3"),
    column<double, offsetof(TickRecord, v)>(
        "v", "1", "of the god-object, its surface's other parameter beside u"),
    column<double, offsetof(TickRecord, hip.z)>("hip_z_m", "m", "handle, up"),
    column<double, offsetof(TickRecord, cp.z)>("cp_z_m", "m", "closest point, up"),
    column<double, offsetof(TickRecord, go.z)>("go_z_m", "m", "god-object, up"),
    column<double, offsetof(TickRecord, force.z)>(
        "rendered_z_n", "N", "rendered force on the hand, up"),
    column<double, offsetof(TickRecord, command.z)>("commanded_z_n", "N", "commanded force, up"),
};

constexpr std::size_t total_bytes() {
    std::size_t total = 0;
    for (const TraceColumn& column : kColumns) {
        total += column.size;
    }
    return total;
}
static_assert(total_bytes() == sizeof(TickRecord), "a field of TickRecord has no column");

constexpr StoredColumn whole(
    std::string_view name, std::string_view unit, double scale, Rule rule, std::size_t size) {
    const std::string_view type = size == 8 ? "i64le" : size == 4 ? "i32le" : "u8";
    return {name, type, unit, scale, rule, 0, size, 0};
}

constexpr StoredColumn exact(std::string_view name,
                             std::string_view unit,
                             std::uint8_t part,
                             std::size_t offset,
                             std::string_view type = "f64le",
                             std::size_t size = 8) {
    return {name, type, unit, 1.0, Rule::exact, part, size, offset};
}

constexpr std::array kStored{
    whole("tick", "1", 1.0, Rule::after, 8),
    whole("time_ns", "s", 1e-9, Rule::clock, 8),
    whole("count_1", "1", 1.0, Rule::line, 4),
    whole("count_2", "1", 1.0, Rule::line, 4),
    whole("code_1", "1", 1.0, Rule::line, 4),
    whole("code_2", "1", 1.0, Rule::line, 4),
    whole("lateness_ns", "s", 1e-9, Rule::plain, 4),
    whole("flags", "1", 1.0, Rule::flip, 1),  // the only one of a byte
    whole("hip_x_100nm", "m", 1e-7, Rule::line, 4),
    whole("hip_y_100nm", "m", 1e-7, Rule::line, 4),
    whole("commanded_x_100un", "N", 1e-4, Rule::line, 4),
    whole("commanded_y_100un", "N", 1e-4, Rule::line, 4),
    whole("count_3", "1", 1.0, Rule::line, 4),
    whole("code_3", "1", 1.0, Rule::line, 4),
    whole("hip_z_100nm", "m", 1e-7, Rule::line, 4),
    whole("commanded_z_100un", "N", 1e-4, Rule::line, 4),
    exact("hip_x_m", "m", part_hip, offsetof(TickRecord, hip)),
    exact("hip_y_m", "m", part_hip, offsetof(TickRecord, hip.y)),
    exact("go_x_m", "m", part_contact, offsetof(TickRecord, go)),
    exact("go_y_m", "m", part_contact, offsetof(TickRecord, go.y)),
    exact("rendered_x_n", "N", part_contact, offsetof(TickRecord, force)),
    exact("rendered_y_n", "N", part_contact, offsetof(TickRecord, force.y)),
    exact("rendered_normal_n", "N", part_contact, offsetof(TickRecord, normal_force)),
    exact("rendered_tangential_n", "N", part_contact, offsetof(TickRecord, tangential_force)),
    exact("mu", "1", part_contact, offsetof(TickRecord, mu)),
    exact("u", "1 or rad", part_contact, offsetof(TickRecord, u)),
    exact("segment", "1", part_contact, offsetof(TickRecord, segment), "i16le", 2),
    exact("mode", "1", part_contact, offsetof(TickRecord, mode), "u8", 1),
    exact("commanded_x_xor_rendered", "N", part_command, offsetof(TickRecord, command), "u64le"),
    exact("commanded_y_xor_rendered", "N", part_command, offsetof(TickRecord, command.y), "u64le"),
    exact("lateness_us", "us", part_lateness, offsetof(TickRecord, lateness_us), "f32le", 4),
    exact("hip_z_m", "m", part_hip, offsetof(TickRecord, hip.z)),
    exact("go_z_m", "m", part_contact, offsetof(TickRecord, go.z)),
    exact("rendered_z_n", "N", part_contact, offsetof(TickRecord, force.z)),
    exact("v", "1", part_contact, offsetof(TickRecord, v)),
    exact("commanded_z_xor_rendered", "N", part_command, offsetof(TickRecord, command.z), "u64le"),
};
static_assert(kStored.size() == kAllColumns);
static_assert(kStored[kStoredColumns - 1].rule != Rule::exact);
static_assert(kStored[kStoredColumns].rule == Rule::exact);

}  // namespace

std::span<const TraceColumn> trace_columns() noexcept {
    return kColumns;
}

std::span<const StoredColumn> stored_columns() noexcept {
    return kStored;
}

std::string_view to_string(Rule rule) noexcept {
    constexpr std::array<std::string_view, 6> kWords{"plain", "flip", "after",
                                                     "clock", "line", "exact"};
    return kWords[static_cast<std::size_t>(rule)];
}

std::string_view part_name(std::uint8_t part) noexcept {
    constexpr std::array<std::string_view, 4> kWords{"hip", "contact", "command", "lateness"};
    return part == 0 ? "" : kWords[static_cast<std::size_t>(std::countr_zero(part))];
}

constexpr std::string_view kSaid = R"(CREATE TABLE sample (
    -- Every servo tick of every trial, ordered by trial_id, interval and tick. Frame: the object's. What
    -- follows from the hand's path is computed again by the trial's own scene, and refused if it is not
    -- what was recorded. Ask for the trials and the columns needed only (trial_id = 7, BETWEEN, IN, a join).
    -- The ticks after done, while the force goes out, are here too: trial and presentation count those with
    -- tick < presentation.ticks. Commanded forces are in whole steps of 100 uN, as chunks hold them.
    trial_id INTEGER,  -- trial.trial_id
    interval INTEGER,  -- 1; 2: the second of a trial with two
)";

std::string sample_declaration() {
    std::string sql(kSaid);
    for (const TraceColumn& column : trace_columns()) {
        std::string type(column.type);
        std::ranges::transform(type, type.begin(), [](char c) { return c - 'a' + 'A'; });
        sql += fmt::format("    {} {},  -- {}\n", column.name, type, column.meaning);
    }
    return sql +
           "    hip_vx_m_per_s REAL,  -- of HIP: (x - x of the stored tick before) / (t - t of "
           "it); NULL: no tick "
           "before\n"
           "    hip_vy_m_per_s REAL,  -- the same in y\n"
           "    hip_vz_m_per_s REAL  -- the same in z\n)";
}

}  // namespace palpate::data
