#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocols/design/counterbalance.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/protocol/protocol.hpp"
#include "data/store/database.hpp"
#include "data/store/session_lock.hpp"
#include "data/store/stored_progress.hpp"

namespace palpate::data {

enum class RunKind : std::uint8_t { real, pilot, simulated };
/// "real", "pilot" or "simulated", as session.session_kind has it.
[[nodiscard]] std::string_view to_string(RunKind kind) noexcept;

/// All that a session is, before its first trial.
struct SessionSpec {
    protocols::Protocol protocol;
    std::string protocol_hash;
    protocols::Plan plan;
    protocols::SessionKey key;
    std::uint64_t seed = 0;
    RunKind kind = RunKind::simulated;
    std::string device;
    Resume resume = Resume::go_on;  ///< if it is there already
    std::string operator_name{};    ///< who runs it; empty: not given
    std::vector<std::pair<std::string, std::string>> provenance;
    std::string uuid{};         ///< empty: a random one
    bool other_device = false;  ///< it goes on also where its last trial was felt on another
};

/// Keys of session_provenance that say how a simulated session was made: kObserverKey, the text of
/// the observer file from which its participant was drawn; kTracesKey with kNoTraces: no ticks were
/// kept.
inline constexpr std::string_view kObserverKey = "observer";
inline constexpr std::string_view kTracesKey = "traces";
inline constexpr std::string_view kNoTraces = "none";

/// The key of the session's random streams; purpose and block are to be set.
[[nodiscard]] protocols::StreamKey session_stream(const SessionSpec& spec);

/// A session would go on with another device or calibration than its last trial had.
class OtherDevice : public StoreError {
public:
    using StoreError::StoreError;
};

/// A session that may run now, and how far it is.
struct OpenedSession {
    SessionLock lock;  ///< held from before anyone else could have opened it
    std::int64_t id = 0;
    bool resumed = false;
    bool finished = false;
    std::size_t next = 0;  ///< position to run first; as many as planned: nothing is left
    protocols::SessionProgress progress{};  ///< of all rows
    std::size_t interrupted = 0;            ///< attempts found running and marked so
    std::int64_t last_trial = 0;            ///< trial.id of the last one; 0: none
};

/// How far a session is, for whoever only looks.
struct SessionState {
    std::size_t number = 0;
    std::uint64_t seed = 0;
    /// "is finished", "was withdrawn", "was run under another code"; empty: it goes on
    std::string over{};
    bool begun = false;              ///< it has a trial
    std::string kind{};              ///< as to_string(RunKind)
    protocols::SessionKey run_as{};  ///< with which its orders were drawn
    std::string plan_hash{};
    std::int64_t id = 0;     ///< session.session_id
    std::int64_t study = 0;  ///< study.study_id
    std::string protocol_hash{};
    std::string protocol_toml{};
    std::string operator_name{};
};

/// The participant's session of a protocol (by the protocol's id), if there is one.
/// @param number  of the session; none: the last one
[[nodiscard]] std::optional<SessionState> find_session(Database& database,
                                                       std::string_view study,
                                                       std::string_view participant,
                                                       std::optional<std::size_t> number = {});

/// The text of another version of a protocol, that whoever had the last trial of a kind ran.
struct OtherVersion {
    std::int64_t people = 0;  ///< with a trial of it
    std::string protocol_toml;
};
/// @return none: nobody ran the protocol so far, or the last one ran this version
[[nodiscard]] std::optional<OtherVersion> other_version(Database& database,
                                                        std::string_view study,
                                                        std::string_view protocol_sha256,
                                                        RunKind kind);

/// Who has which row of a counterbalance.
struct RowsTaken {
    protocols::RowHistory pictures, frictions;

    friend bool operator==(const RowsTaken&, const RowsTaken&) = default;
};
/// @param kind  of the session that asks, as to_string(RunKind)
[[nodiscard]] RowsTaken rows_taken(Database& database,
                                   const protocols::Protocol& protocol,
                                   const protocols::SessionKey& key,
                                   std::string_view kind);

/// Makes the session with its complete plan in one transaction, or opens the one that is there.
/// Attempts left running by a killed program are marked interrupted; what they recorded stays. A
/// device or provenance other than before is an event: what was noted at the beginning stays too. A
/// session of which no trial has begun is made anew where it would be another one, and an event
/// "planned again" says so. Nobody else opens or runs the session until the returned lock is
/// released: `next` stays true as long.
/// @throws OtherDevice unless spec.other_device says that it may
/// @throws StoreError if the session has trials and was made from another protocol, plan, seed or
///         kind, or if a program holds its SessionLock, this one too, or if the answers so far do
///         not give the stored states of the protocol's rule: nothing changes
[[nodiscard]] OpenedSession open_session(Database& database, const SessionSpec& spec);

/// What plan_and_open_session() would refuse, before a device is touched: changes nothing.
/// @throws what that throws
void check_session(Database& database, SessionSpec spec);

/// open_session() with the plan that a session of spec.key has on this database, left in spec.plan:
/// its counterbalanced rows are those that the session, or the participant, already has, else those
/// that fewest others have. Of two rigs that begin at the same moment, the second sees the row that
/// the first took.
/// @param asks  in the same transaction, before anything changes: throws what stands against it
/// @throws what protocols::make_plan() and `asks` throw, too: nothing changes
[[nodiscard]] OpenedSession plan_and_open_session(Database& database,
                                                  SessionSpec& spec,
                                                  const std::function<void()>& asks = {});

/// Orders of levels, as names: of the pictures from left to right, or of the first friction blocks.
struct LevelOrders {
    std::vector<std::vector<std::string>> others;  ///< of every other participant who really ran
    std::vector<std::string> own;                  ///< empty: the participant has no session yet
};

/// What is counterbalanced: the row of the pictures; or the frictions of the first main blocks, one
/// round of them, which a session whose blocks mix frictions has not: its entry is empty.
enum class Balanced : std::uint8_t { pictures, frictions };

/// Who already ran the study (by the protocol's id) with which order.
///
/// `others` counts each participant with a real session once, by the first of these; what is
/// simulated, a pilot or withdrawn leaves the balance alone. `own` is the order of the session
/// itself if it is there, so that it goes on as it began, else that of the participant's first
/// session: where a real one asks, of those that `others` would count, else of any. A session
/// counts from its first trial on, and as long as a program runs it: whoever is at the welcome
/// screen has taken the row, whoever left there has not.
/// @param kind  of the session that asks, as to_string(RunKind)
[[nodiscard]] LevelOrders orders_of(Database& database,
                                    Balanced what,
                                    std::string_view study,
                                    const protocols::SessionKey& key,
                                    std::string_view kind = "real");

}  // namespace palpate::data
