#pragma once

#include <filesystem>
#include <vector>

namespace palpate::data {

/// Writes analysis.R and analysis.py (pandas) into a folder of `export --format csv`: they load its
/// tables, give text columns of fixed words their levels, frictions and objects theirs in the order
/// of least static friction and of curvature, take the main trials that count of one kind of
/// sessions, and print each person's share correct under each friction. To be read and changed:
/// neither is ever written over.
/// @return what was written
/// @throws std::invalid_argument if the folder is no such export, or one of the two is there
/// @throws CsvError if its trials cannot be read
std::vector<std::filesystem::path> write_starters(const std::filesystem::path& folder);

}  // namespace palpate::data
