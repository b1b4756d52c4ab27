#pragma once

#include <memory>
#include <string>

#include "engine/device/calibration.hpp"
#include "engine/device/device.hpp"

namespace palpate::engine {

/// A pantograph on the card at `file`, e.g. "/dev/comedi0". In a build without Comedi it only
/// throws.
/// @throws what ComediDevice throws
/// @throws std::runtime_error  in a build without Comedi: how to get one with it
[[nodiscard]] std::unique_ptr<Device> open_comedi(const std::string& file,
                                                  const Calibration& calibration);

}  // namespace palpate::engine
