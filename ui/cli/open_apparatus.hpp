#pragma once

#include <memory>

#include "ui/cli/rig.hpp"

namespace palpate::ui {

/// The device and servo that a session is felt on.
/// @throws std::invalid_argument, std::runtime_error with the remedy if the device cannot be opened
[[nodiscard]] std::unique_ptr<protocols::Apparatus> open_apparatus(const RigSpec& spec);

}  // namespace palpate::ui
