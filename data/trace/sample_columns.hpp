#pragma once

#include <cstdint>
#include <string>

namespace palpate::data {

/// Columns of the virtual table `sample`, in their order: whose the tick is, those of
/// trace_columns(), velocity.
enum class SampleColumn : std::uint8_t {
    trial_id,
    interval,
    tick,
    time_s,
    count_1,
    count_2,
    code_1,
    code_2,
    lateness_us,
    flags,
    mode,
    segment,
    u,
    hip_x_m,
    hip_y_m,
    cp_x_m,
    cp_y_m,
    go_x_m,
    go_y_m,
    rendered_x_n,
    rendered_y_n,
    commanded_x_n,
    commanded_y_n,
    rendered_normal_n,
    rendered_tangential_n,
    mu,
    count_3,
    code_3,
    v,
    hip_z_m,
    cp_z_m,
    go_z_m,
    rendered_z_n,
    commanded_z_n,
    hip_vx_m_per_s,
    hip_vy_m_per_s,
    hip_vz_m_per_s,
    count_of_columns
};

/// What a query needs of the ticks: bit i is column i.
using SampleColumns = std::uint64_t;

/// The bit of a column. @pre column < count_of_columns, below 64
[[nodiscard]] constexpr SampleColumns bit(SampleColumn column) noexcept {
    return SampleColumns{1} << static_cast<unsigned>(column);
}

/// Columns that need HIP, and the tick before.
inline constexpr SampleColumns kVelocityColumns = bit(SampleColumn::hip_vx_m_per_s) |
                                                  bit(SampleColumn::hip_vy_m_per_s) |
                                                  bit(SampleColumn::hip_vz_m_per_s);
inline constexpr SampleColumns kHipColumns = bit(SampleColumn::hip_x_m) |
                                             bit(SampleColumn::hip_y_m) |
                                             bit(SampleColumn::hip_z_m) | kVelocityColumns;
/// Columns of commanded forces.
inline constexpr SampleColumns kCommandColumns = bit(SampleColumn::commanded_x_n) |
                                                 bit(SampleColumn::commanded_y_n) |
                                                 bit(SampleColumn::commanded_z_n);
/// Columns that no force needs: looked for where they are asked for.
inline constexpr SampleColumns kClosestColumns =
    bit(SampleColumn::cp_x_m) | bit(SampleColumn::cp_y_m) | bit(SampleColumn::cp_z_m);
/// Columns that follow from the hand's whole path: they need a replay.
inline constexpr SampleColumns kReplayedColumns =
    kClosestColumns | bit(SampleColumn::go_x_m) | bit(SampleColumn::go_y_m) |
    bit(SampleColumn::mode) | bit(SampleColumn::segment) | bit(SampleColumn::u) |
    bit(SampleColumn::mu) | bit(SampleColumn::rendered_normal_n) |
    bit(SampleColumn::rendered_tangential_n) | bit(SampleColumn::rendered_x_n) |
    bit(SampleColumn::rendered_y_n) | bit(SampleColumn::v) | bit(SampleColumn::go_z_m) |
    bit(SampleColumn::rendered_z_n);

/// The table as SQL: its columns with their comments.
[[nodiscard]] std::string sample_declaration();

}  // namespace palpate::data
