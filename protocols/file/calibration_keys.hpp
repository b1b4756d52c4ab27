#pragma once

#include <vector>

#include "engine/commissioning/rig_record.hpp"
#include "engine/device/calibration.hpp"
#include "protocols/file/schema.hpp"

/// What a calibration file may say: rows of its tables.
namespace palpate::protocols {

/// A table of a machine. The first one of each kind is [[pantograph]] or [[gantry]] itself, the
/// others lie in it: [pantograph.linkage], ...
struct MachineTable {
    std::string_view name;
    Keys keys;
    /// What it fills; null if the machine has none, and none is to be made.
    void* (*record)(engine::Calibration& machine, bool make);
    bool required = true;
};
/// Of one kind of machine, in the order of its files.
[[nodiscard]] std::span<const MachineTable> machine_tables(bool gantry) noexcept;

/// As its file begins: all defaults, but its frame is the linkage's.
[[nodiscard]] engine::Calibration begun_pantograph();

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

/// What [commissioning] says: of any machine, of a pantograph, of each straight axis.
struct RecordKeys {
    Keys any;      ///< engine::RigRecord
    Keys linkage;  ///< LinkageRecord
    Keys axis;     ///< AxisRecord
};
extern const RecordKeys kRecordKeys;

/// What a calibration file may say, for people.
[[nodiscard]] std::vector<TableText> calibration_reference();

}  // namespace palpate::protocols
