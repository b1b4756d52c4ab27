#pragma once

#include <filesystem>
#include <string_view>

namespace palpate::ui {

/// What was built or installed with this program: a file in its folder, or in ../lib/palpate.
/// @param name    of the file, "palpate_sample.so"
/// @param target  that builds it, for the message
/// @throws std::runtime_error if it is in neither
[[nodiscard]] std::filesystem::path beside_program(std::string_view name, std::string_view target);

}  // namespace palpate::ui
