#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "engine/safety/trip.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/procedure/procedure_state.hpp"
#include "protocols/trial/observer.hpp"
#include "protocols/trial/presentation.hpp"

/// The port to whatever keeps the data. Every call but append() is durable when it returns, or
/// throws.
namespace palpate::protocols {

/// What became of an attempt. The database has the words of to_string().
enum class Outcome : std::uint8_t {
    complete,     ///< felt and answered
    timed_out,    ///< exploration reached the time-out, then answered
    aborted,      ///< ended by the experimenter or a signal; run again on resume
    interrupted,  ///< found unfinished when the session was opened again; run again
    faulted,      ///< the force went off by itself; run again later in its block
    unanswered,   ///< felt, and nobody answered in time; run again later in its block
};

/// "complete", "timed_out", ...: the enumerator's name.
[[nodiscard]] std::string_view to_string(Outcome outcome) noexcept;
/// Of an attempt that is stored without an answer: one that never ended counts as interrupted.
[[nodiscard]] Outcome without_answer(std::string_view word) noexcept;

/// Three of a sample's values: so large that a tenth, a half, nine tenths of all are no larger. 0
/// of none.
struct Deciles {
    double p10 = 0.0;
    double p50 = 0.0;
    double p90 = 0.0;
};

/// Numbers of a trial's ticks that analysts ask for first. Computed while the trial runs, from its
/// first tick to done; the ramp out of the force is in the trace, but not in here.
struct TrialSummary {
    std::int64_t ticks = 0;
    std::int64_t contact_ticks = 0;
    std::int64_t slip_ticks = 0;  ///< slip or transition
    std::int64_t late_ticks = 0;
    std::int64_t saturated_ticks = 0;
    std::int64_t skipped_ticks = 0;    ///< HIP was out of reach: a comparison instead of a tick
    std::int64_t slewed_ticks = 0;     ///< the slew limit held the force back
    std::int64_t stale_ticks = 0;      ///< without a new reading
    double path_length_m = 0.0;        ///< of HIP
    double mean_normal_force_n = 0.0;  ///< over contact ticks, 0 without contact
    double max_normal_force_n = 0.0;
    double energy_j = 0.0;                   ///< work done on the user, sum F[k] . (h[k+1] - h[k])
    engine::Vec2 start{};                    ///< HIP at the first tick, m
    std::int64_t strokes = 0;                ///< along the surface, see StrokeCounter
    std::int64_t strokes_before_vertex = 0;  ///< of these: counted on segment 0
    std::int64_t strokes_after_vertex = 0;   ///< counted on segment 1
    std::int64_t reversals = 0;              ///< strokes that came back on the one before
    double mean_speed_m_per_s = 0.0;         ///< of HIP in contact: its path by its time, or 0
    std::int64_t before_vertex_ticks = 0;    ///< in contact with segment 0: up to vertex 0
    std::int64_t after_vertex_ticks = 0;     ///< with segment 1: from vertex 0 on
    std::int64_t vertex_ticks = 0;           ///< in contact on vertex 0 itself
    std::int64_t stick_events = 0;           ///< times that a sliding god-object stuck again
    bool sticks = true;                      ///< there is friction: without, nothing can stick
    Deciles speed{};                         ///< m/s, see TrialMeter
    Deciles normal_force{};                  ///< N, rendered, of contact ticks
    double covered_share = 0.0;         ///< share of the outline that was visited, see OutlineCover
    std::int64_t contact_episodes = 0;  ///< times that HIP came into contact
    double worst_episode_j = 0.0;       ///< of engine::EnergyLedger, <= 0: passive
    std::optional<double> first_contact_s;  ///< since the first tick
};

/// What was answered, and whether it was right.
struct Response : Choice {
    std::optional<std::size_t> object{};  ///< of a picture: index into Protocol::objects
    std::optional<bool> correct{};        ///< none: the answer is neither right nor wrong
};

/// An answer that a rule takes in.
struct RuleAnswer {
    std::size_t run = 0;
    double stimulus = 0.0;    ///< what was shown, as the rule counts
    std::size_t outcome = 0;  ///< 0 ... Procedure::outcomes() - 1
    std::string track{};      ///< Procedure::track() when it was shown
};

/// The same with what the rule says afterwards.
struct AdaptiveStep {
    RuleAnswer answer{};
    std::vector<Estimate> estimates{};
    std::string state_hash;  ///< Procedure::state_hash() with this answer
};

/// What became of one interval of a trial.
struct IntervalResult {
    double done_s = 0.0;  ///< first tick of the interval -> done (or time-out)
    double done_uncertainty_s = 0.0;
    TrialSummary summary{};
};

/// The force went off by itself.
struct Fault {
    engine::Trip cause = engine::Trip::none;
    std::string text;                      ///< what happened and what to do, a sentence
    std::vector<engine::TickRecord> last;  ///< up to the trip, oldest first, at most 100
};

/// All that is kept of an attempt beside its ticks.
struct TrialResult {
    Outcome outcome = Outcome::complete;
    double done_s = 0.0;  ///< first tick -> done (or time-out), of all intervals added up
    double done_uncertainty_s = 0.0;
    TrialSummary summary{};                   ///< of all intervals together
    std::vector<IntervalResult> intervals{};  ///< as far as the trial came
    std::optional<Response> response{};       ///< none unless complete or timed_out
    std::optional<Fault> fault{};             ///< none unless faulted
    std::optional<AdaptiveStep> step{};       ///< none unless a rule took in the answer
    std::string invalid{};  ///< why an answer does not count, a phrase; empty: it does, or none is
    bool begun = true;      ///< false: the desk wanted something first, nothing is recorded
};

/// Constants of the compiled scene that needed exp, kept because exp differs between machines.
struct SceneConstants {
    double slip_decay = 0.0;  ///< exp(-T/tau_slip), 0 for a sharp drop
    double heal_decay = 0.0;  ///< exp(-T/tau_heal)
};

/// trial.trial_id of the database.
using TrialId = std::int64_t;

/// What can happen beside the trials. The database has the words of to_string().
enum class EventKind : std::uint8_t {
    rest,           ///< "break": before the trial at `position`
    pause,          ///< by the experimenter, before the trial at `position`
    go_on,          ///< after a pause or a trouble; `duration_s`, of a trouble since its last
                    ///< rig check, which has what went before; `value`: the cause
    abort,          ///< before the trial at `position`
    gave_up,        ///< before the trial at `position`, after `count` tries in vain
    fault,          ///< of `trial` at `position`; `value`: its cause
    reconnect,      ///< the device works again, after `count` tries; `value`: whether it began anew
    invalid,        ///< the answer of `trial` at `position` breaks a rule of the protocol
    note,           ///< somebody noted it
    mark,           ///< the answer of `trial` does not count after all; the text is the reason
    redo,           ///< `part` begins again; `count` answers do not count any more
    interrupted,    ///< `trial` was found unfinished
    timing,         ///< how late the ticks were
    ticks_lost,     ///< `count` of them, in `trial` at `position`
    masking,        ///< of the masking noise; `duration_s`: that there was none
    display_lost,   ///< the participant's screen is gone
    device,         ///< the session goes on with the device `value`
    experimenter,   ///< "operator": the session goes on with `value`
    provenance,     ///< the session goes on with `value` of `key`
    participant,    ///< `value` was noted of the participant's `key`
    planned_again,  ///< before its first trial the session became another one
    stop,           ///< somebody wanted no force, in `trial` or between trials; `value`: by what
    reveal,         ///< from here on the experimenter sees what is felt; `value`: who asked for it
};
inline constexpr std::size_t kEventKinds = 23;

/// The word of a kind, as the database has it.
[[nodiscard]] std::string_view to_string(EventKind kind) noexcept;
/// @throws std::invalid_argument for other words
[[nodiscard]] EventKind event_kind(std::string_view word);

/// Something that happened: what programs go by is the kind and its numbers. The sentence is for
/// people, and no program reads it again.
struct Event {
    EventKind kind = EventKind::note;
    std::string text{};
    std::optional<TrialId> trial{};
    std::optional<std::size_t> position{};  ///< in the plan, from 0
    std::optional<std::size_t> part{};      ///< 0: practice; else 1 + block
    std::optional<std::int64_t> count{};
    std::optional<double> duration_s{};
    std::string key{};
    std::string value{};
    /// When it happened or was asked for, as monotonic_ns(); 0: when it is stored.
    std::int64_t when_ns{};

    friend bool operator==(const Event&, const Event&) = default;
};

/// Keeps a session; this one keeps nothing. One thread; calls come in the order of the session.
class Recorder {
public:
    Recorder() = default;
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;
    virtual ~Recorder() = default;

    /// A new attempt at a planned trial; nothing is felt before its first interval begins.
    [[nodiscard]] virtual TrialId begin_trial(const PlannedTrial& /*planned*/) {
        return ++attempts_;
    }
    /// The next interval of the running trial begins: its ticks are counted from 0.
    virtual void begin_interval(TrialId /*trial*/,
                                const Presentation& /*felt*/,
                                const SceneConstants& /*scene*/) {}
    /// The next ticks of the running interval, in order and without gaps. Durable with the next
    /// save().
    virtual void append(TrialId /*trial*/, std::span<const engine::TickRecord> /*ticks*/) {}
    /// Makes durable what was appended. @return false if it has to be tried again, nothing is lost
    virtual bool save() { return true; }
    virtual void end_trial(TrialId /*trial*/, const TrialResult& /*result*/) {}
    /// A mark also leaves its reason with the trial, which has ended and keeps its answer.
    virtual void event(const Event& /*event*/) {}
    /// All planned trials are done.
    virtual void finish_session() {}

private:
    TrialId attempts_ = 0;
};

}  // namespace palpate::protocols
