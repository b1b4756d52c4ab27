#pragma once

#include <cstdint>
#include <string>

struct sqlite3;

namespace palpate::data {

/// When a file was last written to, ns since 1970; 0: there is none.
[[nodiscard]] std::int64_t written_ns(const std::string& name);

/// Of what is read as one that cannot change, opened with "written" in its URI as written_ns() was:
/// it was written to since then, and what was read may be of two moments. False for all else.
[[nodiscard]] bool written_since(sqlite3* handle);

}  // namespace palpate::data
