#pragma once

#include "tests/bench/data/made_trials.hpp"
#include "tests/bench/data/stopwatch.hpp"
#include "tests/bench/data/trace_store.hpp"

namespace palpate::bench {

/// palpate's own file: what a session writes, chunks while a trial runs, one commit at its end,
/// asked through the virtual table `sample`.
[[nodiscard]] std::unique_ptr<TraceStore> own_store(const std::string& folder,
                                                    const MadeStudy& study);

/// Simulate, encode, decode, replay: million samples/s in memory; replay is of everything, hashes
/// checked. And the time in which a file's schema is compared at open, ms.
[[nodiscard]] std::vector<Figure> measure_own(
    const MadeStudy& study,
    const std::vector<std::vector<engine::TickRecord>>& made,
    const Stopwatch& watch);

}  // namespace palpate::bench
