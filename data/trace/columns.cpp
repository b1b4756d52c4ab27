#include "data/trace/columns.hpp"

#include <array>
#include <bit>
#include <cstddef>

#include "engine/realtime/tick_record.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;

static_assert(std::endian::native == std::endian::little,
              "trace columns are copied as they lie in memory");

constexpr std::size_t kY = sizeof(double);
constexpr std::size_t kSecond = sizeof(std::int32_t);

constexpr std::array kColumns{
    TraceColumn{"tick", "i64le", "1", 8, offsetof(TickRecord, tick)},
    TraceColumn{"time_ns", "i64le", "ns", 8, offsetof(TickRecord, time_ns)},
    TraceColumn{"count_1", "i32le", "1", 4, offsetof(TickRecord, counts)},
    TraceColumn{"count_2", "i32le", "1", 4, offsetof(TickRecord, counts) + kSecond},
    TraceColumn{"code_1", "i32le", "1", 4, offsetof(TickRecord, codes)},
    TraceColumn{"code_2", "i32le", "1", 4, offsetof(TickRecord, codes) + kSecond},
    TraceColumn{"lateness_us", "f32le", "us", 4, offsetof(TickRecord, lateness_us)},
    TraceColumn{"flags", "u8", "1", 1, offsetof(TickRecord, flags)},
    TraceColumn{"mode", "u8", "1", 1, offsetof(TickRecord, mode)},
    TraceColumn{"feature", "i16le", "1", 2, offsetof(TickRecord, feature)},
    TraceColumn{"parameter", "f64le", "1 or rad", 8, offsetof(TickRecord, parameter)},
    TraceColumn{"hip_x_m", "f64le", "m", 8, offsetof(TickRecord, hip)},
    TraceColumn{"hip_y_m", "f64le", "m", 8, offsetof(TickRecord, hip) + kY},
    TraceColumn{"cp_x_m", "f64le", "m", 8, offsetof(TickRecord, cp)},
    TraceColumn{"cp_y_m", "f64le", "m", 8, offsetof(TickRecord, cp) + kY},
    TraceColumn{"go_x_m", "f64le", "m", 8, offsetof(TickRecord, go)},
    TraceColumn{"go_y_m", "f64le", "m", 8, offsetof(TickRecord, go) + kY},
    TraceColumn{"fx_n", "f64le", "N", 8, offsetof(TickRecord, force)},
    TraceColumn{"fy_n", "f64le", "N", 8, offsetof(TickRecord, force) + kY},
    TraceColumn{"command_x_n", "f64le", "N", 8, offsetof(TickRecord, command)},
    TraceColumn{"command_y_n", "f64le", "N", 8, offsetof(TickRecord, command) + kY},
    TraceColumn{"fn_n", "f64le", "N", 8, offsetof(TickRecord, normal_force)},
    TraceColumn{"ft_n", "f64le", "N", 8, offsetof(TickRecord, tangential_force)},
    TraceColumn{"mu", "f64le", "1", 8, offsetof(TickRecord, mu)},
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

}  // namespace palpate::data
