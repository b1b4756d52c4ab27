#pragma once

#include <memory>
#include <string>

#include "engine/device/calibration.hpp"
#include "engine/device/device.hpp"
#include "ui/rig/device_choice.hpp"

namespace palpate::ui {

/// The machine that `choice` is: what --calibration names, or, without it, the Mk-II for sim and
/// comedi and the 2DIY gen3 for Haply and open boards.
/// @throws protocols::ProtocolError as protocols::load_calibration
[[nodiscard]] engine::Calibration calibration_of(const DeviceChoice& choice,
                                                 const std::string& name_or_file);

/// What the device calls itself once it is opened (engine::Device::name()); an emulated board
/// without its port, which is another one each time.
/// @param machine  engine::Calibration::name()
/// @param surface  of a simulated hand: it moves in space
[[nodiscard]] std::string device_name(const DeviceChoice& choice,
                                      const std::string& machine,
                                      bool surface);

/// Opens a device that a person holds, or the pointer. Make it before threads: a Haply board's
/// guard is forked.
/// @param period  s between ticks
/// @throws std::invalid_argument if the calibration is of another kind of device or `choice` is
/// simulated
/// @throws std::runtime_error if it cannot be opened: what, and the remedy
[[nodiscard]] std::unique_ptr<engine::Device> open_device(const DeviceChoice& choice,
                                                          const engine::Calibration& calibration,
                                                          double period);

}  // namespace palpate::ui
