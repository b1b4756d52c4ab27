#include "data/trace/columns.hpp"

#include <array>
#include <bit>
#include <cstddef>

namespace palpate::data {
namespace {

using engine::TickRecord;

static_assert(std::endian::native == std::endian::little,
              "trace columns are copied as they lie in memory");

constexpr std::size_t kY = sizeof(double);
constexpr std::size_t kSecond = sizeof(std::int32_t);

constexpr std::array kColumns{
    TraceColumn{"tick", "i64le", "1", 8, offsetof(TickRecord, tick),
                "number of the tick, from 0; a jump: ticks were lost"},
    TraceColumn{"time_ns", "i64le", "ns", 8, offsetof(TickRecord, time_ns),
                "since the first deadline, on the servo's clock"},
    TraceColumn{"count_1", "i32le", "1", 4, offsetof(TickRecord, counts),
                "encoder of motor 1 as read"},
    TraceColumn{"count_2", "i32le", "1", 4, offsetof(TickRecord, counts) + kSecond,
                "encoder of motor 2 as read"},
    TraceColumn{"code_1", "i32le", "1", 4, offsetof(TickRecord, codes), "as written to motor 1"},
    TraceColumn{"code_2", "i32le", "1", 4, offsetof(TickRecord, codes) + kSecond,
                "as written to motor 2"},
    TraceColumn{"lateness_us", "f32le", "us", 4, offsetof(TickRecord, lateness_us),
                "wake-up minus deadline"},
    TraceColumn{
        "flags", "u8", "1", 1, offsetof(TickRecord, flags),
        "sum of 1 saturated, 2 late, 4 ramped, 8 fault, 16 skipped, 32 held, 64 slewed, 128 stale"},
    TraceColumn{"mode", "u8", "1", 1, offsetof(TickRecord, mode),
                "0 free, 1 stuck, 2 slip, 3 transition"},
    TraceColumn{"feature", "i16le", "1", 2, offsetof(TickRecord, feature),
                "under the god-object: >= 0 the segment, -1 - j the vertex j"},
    TraceColumn{"parameter", "f64le", "1 or rad", 8, offsetof(TickRecord, parameter),
                "of the god-object on its segment, 0 to 1; on a vertex its angle, rad"},
    TraceColumn{"hip_x_m", "f64le", "m", 8, offsetof(TickRecord, hip), "handle, to the right"},
    TraceColumn{"hip_y_m", "f64le", "m", 8, offsetof(TickRecord, hip) + kY,
                "handle, away from the person"},
    TraceColumn{"cp_x_m", "f64le", "m", 8, offsetof(TickRecord, cp),
                "closest point of the outline, to the right"},
    TraceColumn{"cp_y_m", "f64le", "m", 8, offsetof(TickRecord, cp) + kY,
                "closest point of the outline, away from the person"},
    TraceColumn{"go_x_m", "f64le", "m", 8, offsetof(TickRecord, go), "god-object, to the right"},
    TraceColumn{"go_y_m", "f64le", "m", 8, offsetof(TickRecord, go) + kY,
                "god-object, away from the person"},
    TraceColumn{"fx_n", "f64le", "N", 8, offsetof(TickRecord, force),
                "force as rendered, on the hand, to the right"},
    TraceColumn{"fy_n", "f64le", "N", 8, offsetof(TickRecord, force) + kY,
                "force as rendered, on the hand, away from the person"},
    TraceColumn{"command_x_n", "f64le", "N", 8, offsetof(TickRecord, command),
                "force asked of the device, after the safety chain"},
    TraceColumn{"command_y_n", "f64le", "N", 8, offsetof(TickRecord, command) + kY,
                "its other component, away from the person"},
    TraceColumn{"fn_n", "f64le", "N", 8, offsetof(TickRecord, normal_force),
                "rendered force along the outward normal at the god-object"},
    TraceColumn{"ft_n", "f64le", "N", 8, offsetof(TickRecord, tangential_force),
                "rendered force along the direction of travel"},
    TraceColumn{"mu", "f64le", "1", 8, offsetof(TickRecord, mu), "friction coefficient in force"},
};

constexpr std::size_t total_bytes() {
    std::size_t total = 0;
    for (const TraceColumn& column : kColumns) {
        total += column.size;
    }
    return total;
}
static_assert(total_bytes() == sizeof(TickRecord), "a field of TickRecord has no column");

}  // namespace

std::span<const TraceColumn> trace_columns() noexcept {
    return kColumns;
}
std::size_t bytes_per_tick() noexcept {
    return total_bytes();
}

std::vector<std::byte> shuffled_columns(std::span<const TickRecord> ticks) {
    std::vector<std::byte> raw(ticks.size() * bytes_per_tick());
    std::byte* out = raw.data();
    for (const TraceColumn& column : trace_columns()) {
        for (std::size_t byte = 0; byte < column.size; ++byte) {
            for (const TickRecord& tick : ticks) {
                *out++ = reinterpret_cast<const std::byte*>(&tick)[column.offset + byte];
            }
        }
    }
    return raw;
}

}  // namespace palpate::data
