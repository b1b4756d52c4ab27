#pragma once

#include <filesystem>

namespace palpate::data {

/// Waits until the bytes of a file, or the names in a folder, are on the disk: a power cut from here on does
/// not lose them. A file's name is its folder's.
/// @return false: the disk refused, errno says why
[[nodiscard]] bool sync_to_disk(const std::filesystem::path& what);

/// The folder that holds a file's name.
[[nodiscard]] std::filesystem::path folder_of(const std::filesystem::path& file);

}  // namespace palpate::data
