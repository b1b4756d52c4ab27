#pragma once

#include "protocols/design/plan.hpp"
#include "tests/bench/data/trace_store.hpp"
#include "tests/bench/timing.hpp"

namespace palpate::bench {

/// The default study and its plan, with trials as a simulated pantograph at 1 kHz makes them:
/// encoder counts, friction and tremor.
struct MadeStudy {
    protocols::Protocol protocol;
    std::string hash;
    protocols::SessionKey key;
    protocols::Plan plan;
};

[[nodiscard]] MadeStudy made_study();

/// The ticks of the trial at `position`, `seconds` long: a hand that strokes to and fro. Wake-ups
/// are late by a seeded exponential of mean 8 us in whole ns, as on an idle machine: a virtual
/// clock's zeros would take no room in any store.
[[nodiscard]] std::vector<engine::TickRecord> made_trial(const MadeStudy& study,
                                                         std::size_t position,
                                                         double seconds);

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
