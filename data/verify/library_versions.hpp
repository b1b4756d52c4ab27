#pragma once

#include <string>
#include <utility>
#include <vector>

namespace palpate::data {

/// Of the libraries that this room alone uses, as they run: SQLite, zlib, libsodium.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace palpate::data
