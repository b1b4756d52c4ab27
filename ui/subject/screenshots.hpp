#pragma once

#include <span>
#include <string>
#include <vector>

#include "protocols/trial/observer.hpp"
#include "ui/subject/window.hpp"

namespace palpate::ui {

/// Draws every subject screen off any display and writes welcome, ready, explore, choose, break,
/// trouble and end as PNG files into `directory`, which must exist. Returns their names.
/// @throws std::runtime_error if a file cannot be written
std::vector<std::string> write_screenshots(const std::string& directory,
                                           std::span<const protocols::Picture> pictures,
                                           const WindowOptions& options);

}  // namespace palpate::ui
