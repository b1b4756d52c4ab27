#pragma once

#include <string>

namespace palpate::ui {

/// The linker's build id of the program that runs, in hexadecimal: a hash of its code and data. Two
/// programs with the same one are the same. "unknown" if it was linked without.
[[nodiscard]] std::string build_id();

}  // namespace palpate::ui
