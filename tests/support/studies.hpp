#pragma once

#include "data/store/session_store.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "data/verify/verify.hpp"
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

/// A file of its own, empty, gone at the end.
struct NewDatabase : private TemporaryFolder, data::Database {
    NewDatabase() : data::Database(TemporaryFolder::file("a.sqlite"), data::Access::write) {}
};

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

/// A session in a file of its own, and its recorder. Nobody holds it.
struct SmallSession {
    explicit SmallSession(const protocols::Protocol& protocol = small_protocol())
        : spec(session_spec(protocol)) {}

    protocols::TrialId begin(std::size_t position) {
        return begin_trial(recorder, spec.protocol, spec.plan.trials.at(position));
    }
    /// A whole trial at a position of the plan.
    protocols::TrialId record(std::size_t position,
                              const protocols::TrialResult& result,
                              std::span<const engine::TickRecord> ticks = {}) {
        const protocols::TrialId trial = begin(position);
        recorder.append(trial, ticks);
        recorder.end_trial(trial, result);
        return trial;
    }

    TemporaryFolder folder;
    data::SessionSpec spec;
    data::Database database{folder.file("a.sqlite"), data::Access::write};
    std::int64_t id = data::open_session(database, spec).id;
    protocols::SessionProgress progress{spec.protocol, spec.plan, data::session_stream(spec)};
    data::SqliteRecorder recorder{database, spec.protocol, id};
};

/// The rows of `sql`, a line each; a space after every value.
[[nodiscard]] std::string lines(data::Database& database, const std::string& sql);
/// How many rows `from` gives: a table, with its joins and WHERE.
[[nodiscard]] std::int64_t count(data::Database& database, const std::string& from);
/// All findings, a line each. @param missing  also of what is missing
[[nodiscard]] std::string text_of(const data::Verification& found, bool missing = true);
/// What verify finds different in a file with made-up provenance, a line each.
[[nodiscard]] std::string differences(data::Database& database);

/// SHA-256 (hex) of everything a database says, wall-clock columns (*_utc), random names (uuid),
/// chains, provenance and what zlib made of the traces left out: two runs of the same plan on the
/// same hand give the same hash, in every build and on every machine. Rows go in by primary key,
/// values with their type and length.
[[nodiscard]] std::string content_hash(data::Database& database);

}  // namespace palpate::tests
