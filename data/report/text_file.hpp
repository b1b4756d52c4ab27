#pragma once

#include <filesystem>
#include <string_view>

namespace palpate::data {

/// Writes `text`, replacing what was there; whole and on the disk, or not at all.
/// @throws std::runtime_error with the path if the file cannot be written whole
void write_text_file(const std::filesystem::path& path, std::string_view text);

}  // namespace palpate::data
