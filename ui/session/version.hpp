#pragma once

namespace palpate::ui {

/// From CMake's project version.
inline constexpr const char* kVersion = PALPATE_VERSION;

}  // namespace palpate::ui
