#pragma once

#include "engine/realtime/tick_record.hpp"
#include "protocols/design/plan.hpp"
#include "tests/support/std.hpp"

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

}  // namespace palpate::bench
