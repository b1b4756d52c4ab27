#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/commissioning/rig_record.hpp"
#include "engine/device/calibration.hpp"
#include "protocols/file/schema.hpp"

/// Calibration files: TOML text <-> engine::Calibration. protocols/library/pantographs.toml shows
/// every key. Lengths in mm, angles in degrees, torques in mN m.
namespace palpate::protocols {

/// Reads every [[pantograph]] of a file. Past this door check() of engine/device/calibration.hpp
/// holds for each, and no two have one name.
/// @param file_name  for messages only
/// @throws ProtocolError with a line for every problem: file:line:column: what, value, remedy
[[nodiscard]] std::vector<engine::Calibration> parse_calibrations(std::string_view text,
                                                                  std::string_view file_name);

/// The only machine of a file, or, if no such file is there, a shipped one by its name: haplet,
/// 2diy_gen2, 2diy_gen3, mk2.
/// @throws ProtocolError also if there is neither, or a file holds several
[[nodiscard]] engine::Calibration load_calibration(const std::string& name_or_file);

/// A calibration, and what commissioning found of the rig where it was commissioned.
struct RigFile {
    engine::Calibration calibration;
    std::optional<engine::RigRecord> record{};
};
/// As load_calibration(). A record that was changed by hand is no record.
/// @param also_changed  for whoever would write over it: such a record, too
/// @throws ProtocolError also for a record whose hash is another's
[[nodiscard]] RigFile load_rig(const std::string& name_or_file, bool also_changed = false);

/// The calibration's canonical text, the record, and the hash of both, as load_rig() reads them.
[[nodiscard]] std::string to_toml(const engine::Calibration& calibration,
                                  const engine::RigRecord& record);

/// The canonical text, a file with one machine: every key that is not left out for "none", in a
/// fixed order, numbers as short as they can be without changing the value. Read and written again
/// it is the same text. Of the doubles in SI, a few are no quotient of a double by 1000 or 180 /
/// pi, and are written as the nearest one that is.
[[nodiscard]] std::string to_toml(const engine::Calibration& calibration);

/// SHA-256 of the canonical text, 64 hexadecimal digits: comments and spelling do not matter.
[[nodiscard]] std::string calibration_id(const engine::Calibration& calibration);

}  // namespace palpate::protocols
