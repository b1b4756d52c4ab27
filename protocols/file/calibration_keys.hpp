#pragma once

#include <vector>

#include "engine/commissioning/rig_record.hpp"
#include "engine/device/calibration.hpp"
#include "protocols/file/schema.hpp"

/// What a calibration file may say: rows of its tables.
namespace palpate::protocols {

/// As a file begins: its frame is the linkage's.
struct Machine : engine::Calibration {
    /// All defaults, but an origin of 0; or what a calibration has.
    Machine() { pantograph.origin = {}; }
    explicit Machine(const engine::Calibration& from) : engine::Calibration(from) {}
};

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

/// The tables by name, each with the record that it fills.
struct CalibrationKeys {
    Keys pantograph;      ///< Machine
    Keys linkage;         ///< engine::FiveBar
    Keys axis;            ///< engine::Axis
    Keys haply;           ///< engine::HaplyWiring
    Keys board;           ///< engine::OpenWiring
    Keys comedi;          ///< engine::ComediWiring
    Keys gantry;          ///< engine::GantrySpec
    Keys straight_axis;   ///< engine::StraightAxis
    Keys gantry_board;    ///< engine::OpenWiring
    Keys record;          ///< engine::RigRecord
    Keys linkage_record;  ///< LinkageRecord
    Keys axis_record;     ///< AxisRecord
};
extern const CalibrationKeys kCalibrationKeys;

/// What a calibration file may say, for people.
[[nodiscard]] std::vector<TableText> calibration_reference();

}  // namespace palpate::protocols
