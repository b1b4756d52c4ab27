#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/bench/data/made_trials.hpp"
#include "tests/bench/data/trace_store.hpp"

namespace palpate::bench {

/// palpate's own file: what a session writes, chunks while a trial runs, one commit at its end,
/// asked through the virtual table `sample`.
[[nodiscard]] std::unique_ptr<TraceStore> own_store(const std::string& folder,
                                                    const MadeStudy& study);

/// Million samples a second, in memory. Replay is of everything, hashes checked.
struct Own {
    double encode = 0.0;
    double decode = 0.0;           ///< of one stored column
    double replay = 0.0;           ///< trials side by side on all cores
    double replay_one = 0.0;       ///< one trial after the other, a thread beside it
    double schema_ms = 0.0;        ///< a file's schema compared at open, processor time, median
    double schema_first_ms = 0.0;  ///< and the first time in a program
};

[[nodiscard]] Own measure_own(const MadeStudy& study,
                              const std::vector<std::vector<engine::TickRecord>>& made);

}  // namespace palpate::bench
