#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocols/session/recorder.hpp"
#include "data/store/session_store.hpp"
#include "tests/support/process.hpp"
#include "tests/support/random.hpp"

/// Small studies and made-up ticks for tests.
namespace palpate::tests {

/// Three objects, friction off and on, `repetitions` each: 6 trials a repetition, no practice.
[[nodiscard]] protocols::Protocol small_protocol(std::size_t repetitions = 1);

/// Of sessions in tests.
inline const std::string kSecret = kRunSecret;

[[nodiscard]] data::SessionSpec session_spec(const protocols::Protocol& protocol,
                                             std::string participant = "P01",
                                             std::size_t number = 1);

/// Ticks full of arbitrary bits (NaN payloads too), in order from `first`.
[[nodiscard]] std::vector<engine::TickRecord> random_ticks(std::uint64_t seed,
                                                           std::size_t count,
                                                           std::int64_t first = 0);

/// Every field that a servo fills the same, bit for bit.
[[nodiscard]] bool same_bits(const engine::TickRecord& a, const engine::TickRecord& b);

/// Begins a trial and its first interval, as a session does.
[[nodiscard]] protocols::TrialId begin_trial(protocols::Recorder& recorder,
                                             const protocols::Protocol& protocol,
                                             const protocols::PlannedTrial& planned,
                                             const protocols::SceneConstants& scene = {});

/// A complete, plausible result.
[[nodiscard]] protocols::TrialResult answered(std::size_t object,
                                              bool correct,
                                              std::int64_t ticks = 0);

/// The rows of `sql`, a line each; a space after every value.
[[nodiscard]] std::string lines(data::Database& database, const std::string& sql);
/// How many rows `from` gives: a table, with its joins and WHERE.
[[nodiscard]] std::int64_t count(data::Database& database, const std::string& from);
/// What verify finds different in a file with made-up provenance, a line each.
[[nodiscard]] std::string differences(data::Database& database);

}  // namespace palpate::tests
