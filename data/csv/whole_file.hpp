#pragma once

#include <filesystem>
#include <string_view>

namespace palpate::data {

/// Writes the text so that the file is either whole or as it was: to a file beside it, synced, then
/// renamed. An empty path means standard output. @throws std::runtime_error with file, why and remedy
void write_whole(const std::filesystem::path& file, std::string_view text);

}  // namespace palpate::data
