#pragma once

#include <cstdint>
#include <string_view>

namespace palpate::data {

/// Columns of the virtual table `sample`, in their order.
enum class SampleColumn : std::uint8_t {
    trial_id,
    interval,
    tick,
    t_s,
    x_m,
    y_m,
    vx_m_per_s,
    vy_m_per_s,
    cp_x_m,
    cp_y_m,
    go_x_m,
    go_y_m,
    mode,
    segment,
    u,
    mu,
    fn_n,
    ft_n,
    rendered_x_n,
    rendered_y_n,
    fx_n,
    fy_n,
    lateness_us,
    flags,
    count_1,
    count_2,
    code_1,
    code_2,
    count_of_columns
};

/// What a query needs of the ticks: bit i is column i.
using SampleColumns = std::uint64_t;

[[nodiscard]] constexpr SampleColumns bit(SampleColumn column) noexcept {
    return SampleColumns{1} << static_cast<unsigned>(column);
}

/// Columns that need HIP, and the tick before.
inline constexpr SampleColumns kVelocityColumns =
    bit(SampleColumn::vx_m_per_s) | bit(SampleColumn::vy_m_per_s);
inline constexpr SampleColumns kHipColumns =
    bit(SampleColumn::x_m) | bit(SampleColumn::y_m) | kVelocityColumns;
/// Columns that follow from the hand's whole path: they need a replay.
inline constexpr SampleColumns kReplayedColumns =
    bit(SampleColumn::cp_x_m) | bit(SampleColumn::cp_y_m) | bit(SampleColumn::go_x_m) |
    bit(SampleColumn::go_y_m) | bit(SampleColumn::mode) | bit(SampleColumn::segment) |
    bit(SampleColumn::u) | bit(SampleColumn::mu) | bit(SampleColumn::fn_n) |
    bit(SampleColumn::ft_n) | bit(SampleColumn::rendered_x_n) | bit(SampleColumn::rendered_y_n);

/// The table as SQL: its columns with their comments.
[[nodiscard]] std::string_view sample_declaration() noexcept;

}  // namespace palpate::data
