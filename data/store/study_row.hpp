#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "data/store/database.hpp"

namespace palpate::data {

/// A value that is not the one that was chained, or not what follows from another.
struct ChainBreak {
    std::int64_t trial = 0;  ///< 0: of the session as a whole
    std::string what;        ///< table.column; of an event which
    std::string stored;
    std::string recomputed;
};

/// Where a study's row does not follow from its text: the SHA-256, by which its sessions know it,
/// the name and the title. No seal of a session is over the text.
[[nodiscard]] std::vector<ChainBreak> study_breaks(Database& database, std::int64_t study);

/// @throws StoreError if a study is not what its text says (study_breaks())
void require_study(Database& database, std::int64_t study);

}  // namespace palpate::data
