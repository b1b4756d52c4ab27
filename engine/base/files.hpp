#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace palpate {

/// Waits until the bytes of a file, or the names in a folder, are on the disk: a power cut from
/// here on does not lose them. A file's name is its folder's.
/// @return false: the disk refused, errno says why
[[nodiscard]] bool sync_to_disk(const std::filesystem::path& what);

/// The folder that holds a file's name.
[[nodiscard]] std::filesystem::path folder_of(const std::filesystem::path& file);

/// The first line of a file; empty if it cannot be read.
[[nodiscard]] std::string first_line(const std::filesystem::path& file);

/// Before long work: whether write_whole() could write it now. @throws as that
/// @param text the text that will be written, or how it will begin; empty: nothing is there yet
void require_writable(const std::filesystem::path& file, std::string_view text);

/// Writes the text so that the file is either whole or as it was: to a file beside it, synced, then
/// renamed. An empty path means standard output.
///
/// What is there is written over only if it is empty or of the text's own kind, as the same command
/// wrote it before: it begins with the same tag (<svg, <!DOCTYPE), the same head of a CSV, or the
/// same first three lines of a TOML file. Anything else stays: a database, somebody's table, a
/// protocol. Pipes and terminals have no kind.
/// @throws std::invalid_argument if a file of another kind is there, std::runtime_error if it cannot
///         be written; both with file, why and remedy
void write_whole(const std::filesystem::path& file, std::string_view text);

/// Writes a file that is not there yet, and syncs it: nobody's file is ever written over, whoever
/// comes first.
/// @throws std::invalid_argument if it is there or cannot be made, std::runtime_error if it did not
///         become whole: it is gone then
void write_new(const std::filesystem::path& file, std::string_view text);

/// Makes a folder and those around it, as far as they are not there.
/// @throws std::invalid_argument if that cannot be done
void make_folder(const std::filesystem::path& folder);

}  // namespace palpate
