#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "engine/device/calibration.hpp"
#include "engine/device/device.hpp"
#include "protocols/file/calibration_file.hpp"
#include "ui/rig/device_choice.hpp"

namespace palpate::ui {

/// The machine that `choice` is: what --calibration names, or, without it, the Mk-II for sim and
/// comedi and the 2DIY gen3 for Haply and open boards. Of a rig that was commissioned with another
/// device its damping is not known. Read it once: the file may be another one a question later.
/// @throws protocols::ProtocolError as protocols::load_rig
[[nodiscard]] protocols::RigFile rig_file_of(const DeviceChoice& choice,
                                             const std::string& name_or_file);

/// Opens a device that a person holds, or the pointer. Make it before threads: a Haply board's
/// guard is forked.
/// @param period  s between ticks
/// @throws std::invalid_argument if the calibration is of another kind of device or `choice` is
/// simulated
/// @throws std::runtime_error if it cannot be opened: what, and the remedy
[[nodiscard]] std::unique_ptr<engine::Device> open_device(const DeviceChoice& choice,
                                                          const engine::Calibration& calibration,
                                                          double period);

/// Opens what --device of `palpate calibrate` names. Its readings count from wherever its encoders
/// were when it was switched on: the zeros of `calibration` are a guess.
///
/// `sim` is a simulated machine whose encoders are off by angles that the calibration has to find.
/// @throws std::invalid_argument for a device that is not known, naming those that are
[[nodiscard]] std::unique_ptr<engine::Device> open_for_calibration(
    const std::string& device, const engine::Calibration& calibration);

/// Brings the handle of a simulated machine in the plane to `place`, object frame, m.
/// @return false for a device that a person has to move
bool bring_handle(engine::Device& device, const engine::Vec2& place);

/// X_MM,Y_MM in the object's frame; X_MM,Y_MM,Z_MM of a machine of three axes.
/// @param word  what it was given as, for the message
/// @return m   @throws std::invalid_argument with both
template <int kAxes = 2>
[[nodiscard]] engine::Vec<kAxes> parse_place(const std::string& text, const std::string& word);

/// "480,300,120". @return none: it is no three numbers
[[nodiscard]] std::optional<engine::Vec3> three_numbers(const std::string& text);

/// As many digits of a calibration's id tell it from others, for people.
inline constexpr std::size_t kShownId = 12;

}  // namespace palpate::ui
