#include "data/trace/stored_columns.hpp"

#include <array>
#include <bit>

#include "engine/realtime/tick_record.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;

static_assert(std::endian::native == std::endian::little,
              "exact columns are copied as they lie in memory");

constexpr StoredColumn whole(
    std::string_view name, std::string_view unit, double scale, Rule rule, std::size_t size) {
    return {.name = name,
            .type = size == 8 ? "i64le"
                  : size == 4 ? "i32le"
                              : "u8",
            .unit = unit,
            .scale = scale,
            .rule = rule,
            .part = 0,
            .size = size,
            .offset = 0};
}

constexpr StoredColumn exact(std::string_view name,
                             std::string_view unit,
                             std::uint8_t part,
                             std::size_t offset,
                             std::string_view type = "f64le",
                             std::size_t size = 8) {
    return {.name = name,
            .type = type,
            .unit = unit,
            .scale = 1.0,
            .rule = Rule::exact,
            .part = part,
            .size = size,
            .offset = offset};
}

constexpr std::array kStored{
    whole("tick", "1", 1.0, Rule::after, 8),
    whole("time_ns", "s", 1e-9, Rule::clock, 8),
    whole("count_1", "1", 1.0, Rule::line, 4),
    whole("count_2", "1", 1.0, Rule::line, 4),
    whole("code_1", "1", 1.0, Rule::line, 4),
    whole("code_2", "1", 1.0, Rule::line, 4),
    whole("lateness_ns", "s", 1e-9, Rule::plain, 4),
    whole("flags", "1", 1.0, Rule::plain, 1),  // the only one of a byte
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

std::span<const StoredColumn> stored_columns() noexcept {
    return kStored;
}

std::string_view to_string(Rule rule) noexcept {
    switch (rule) {
        case Rule::plain:
            return "plain";
        case Rule::after:
            return "after";
        case Rule::clock:
            return "clock";
        case Rule::line:
            return "line";
        case Rule::exact:
            break;
    }
    return "exact";
}

std::string_view part_name(std::uint8_t part) noexcept {
    switch (part) {
        case part_hip:
            return "hip";
        case part_contact:
            return "contact";
        case part_command:
            return "command";
        case part_lateness:
            return "lateness";
        default:
            return "";
    }
}

}  // namespace palpate::data
