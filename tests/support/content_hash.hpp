#pragma once

#include <string>

#include "data/store/database.hpp"

namespace palpate::tests {

/// SHA-256 (hex) of everything a database says, wall-clock columns (*_utc), random names (uuid),
/// chains, provenance and what zlib made of the traces left out: two runs of the same plan on the
/// same hand give the same hash, in every build and on every machine. Rows go in by primary key,
/// values with their type and length.
[[nodiscard]] std::string content_hash(data::Database& database);

}  // namespace palpate::tests
