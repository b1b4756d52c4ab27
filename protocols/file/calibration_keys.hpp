#pragma once

#include "engine/commissioning/rig_record.hpp"
#include "engine/device/calibration.hpp"
#include "protocols/file/schema.hpp"

/// What a calibration file may say: rows of its tables.
namespace palpate::protocols {

/// As a file begins: its frame is the linkage's.
struct Machine : engine::Calibration {
    Machine() { pantograph.origin = {}; }
    explicit Machine(const engine::Calibration& from) : engine::Calibration(from) {}
};

/// Of Machine.
[[nodiscard]] Keys pantograph_keys() noexcept;
/// Of engine::FiveBar, Axis, HaplyWiring, OpenWiring, ComediWiring.
[[nodiscard]] Keys linkage_keys() noexcept;
[[nodiscard]] Keys axis_keys() noexcept;
[[nodiscard]] Keys haply_keys() noexcept;
[[nodiscard]] Keys board_keys() noexcept;
[[nodiscard]] Keys comedi_keys() noexcept;
/// Of engine::GantrySpec, StraightAxis, and OpenWiring again.
[[nodiscard]] Keys gantry_keys() noexcept;
[[nodiscard]] Keys straight_axis_keys() noexcept;
[[nodiscard]] Keys gantry_board_keys() noexcept;
/// Of engine::RigRecord.
[[nodiscard]] Keys record_keys() noexcept;

/// What a record says of a pantograph alone.
struct LinkageRecord {
    engine::HandleDynamics dynamics{};
    std::optional<engine::Vec2> mark{};
};
/// What it says of one straight axis.
struct AxisRecord {
    engine::AxisDynamics dynamics{};
    double mark = 0.0;
};
[[nodiscard]] Keys linkage_record_keys() noexcept;
[[nodiscard]] Keys axis_record_keys() noexcept;

}  // namespace palpate::protocols
