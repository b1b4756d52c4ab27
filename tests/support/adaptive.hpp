#pragma once

#include "protocols/observer/simulated_observer.hpp"
#include "protocols/session/session.hpp"
#include "protocols/trial/servo_apparatus.hpp"
#include "data/store/session_store.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "tests/support/adaptive_text.hpp"
#include "tests/support/studies.hpp"

/// Small sessions with a rule, felt by the simulated hand.
namespace palpate::tests {

/// Opens or resumes the session and runs it through `wrap(recorder)`.
template <class Wrap>
protocols::SessionEnd run_simulated(data::Database& database,
                                    const data::SessionSpec& spec,
                                    const Wrap& wrap) {
    const data::OpenedSession opened = data::open_session(database, spec);
    protocols::SimulatedApparatus apparatus(
        spec.protocol,
        protocols::DrawnHand(spec.protocol, spec.protocol_hash, spec.key, spec.seed));
    protocols::SimulatedObserver observer(spec.protocol, session_stream(spec),
                                          spec.plan.picture_order,
                                          [&] { return apparatus.hand_is_done(); });
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    auto&& port = wrap(recorder);
    return run_session(spec.protocol, spec.plan,
                       {.title = spec.protocol.title,
                        .participant = spec.key.participant,
                        .trials = spec.plan.trials.size(),
                        .next = opened.progress.pending().answered(),
                        .simulated = true,
                        .device = "test"},
                       opened.progress,
                       {.apparatus = apparatus, .observer = observer, .recorder = port});
}

inline protocols::SessionEnd run_simulated(data::Database& database,
                                           const data::SessionSpec& spec) {
    return run_simulated(database, spec, [](protocols::Recorder& recorder) -> protocols::Recorder& {
        return recorder;
    });
}

}  // namespace palpate::tests
