#pragma once

#include <cstdint>
#include <string>

#include "data/store/adaptive_store.hpp"

namespace palpate::data {

/// A run of a session as palpate procedure reads it.
struct ExportedRun {
    std::string
        procedure;  ///< a procedure file: the protocol's rule, and where the run's stream begins
    std::string responses;  ///< CSV: stimulus,response, in the order of the answers
};

/// Answers that were marked later are left out: what is replayed is the rule as it stands at the
/// end.
/// @param run  from 0
/// @throws StoreError if there is no such session or run
[[nodiscard]] ExportedRun exported_run(Database& database, std::int64_t session, std::int64_t run);

}  // namespace palpate::data
