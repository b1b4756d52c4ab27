#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "engine/safety/safety_limits.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "protocols/session/recorder.hpp"
#include "protocols/session/trial_meter.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "data/store/written_rows.hpp"
#include "data/verify/trial_check.hpp"

namespace palpate::data {
namespace {

using protocols::Presentation;

constexpr double kExpError = 4e-16;    ///< so far apart exp() of two C libraries may be
constexpr std::size_t kMaxKnown = 64;  ///< scenes: a rule makes a new one with every trial

/// With the decays that were recorded.
std::shared_ptr<const engine::FeltScene> scene_of(const SessionFrame& frame,
                                                  const Presentation& felt,
                                                  const StoredRow& row,
                                                  std::vector<KnownScene>& known,
                                                  Findings& findings) {
    const double slip = row.real("slip_decay");
    const double heal = row.real("heal_decay");
    auto found = std::ranges::find_if(known, [&](const KnownScene& one) {
        const auto& decay = one.scene->decay();
        return one.felt == felt && decay.slip == slip && decay.heal == heal;
    });
    if (found == known.end()) {
        const std::shared_ptr<engine::FeltScene> scene(
            new engine::FeltScene(make_felt_scene(frame.protocol, felt)));
        const auto here = scene->decay();
        scene->restore_decay({.slip = slip, .heal = heal});
        if (known.size() == kMaxKnown) {
            known.clear();
        }
        found = known.insert(known.end(), KnownScene{felt, {here.slip, here.heal}, scene});
    }
    const auto check_decay = [&](std::string_view column, double here) {
        const double stored = row.real(column);
        if (!(std::fabs(stored - here) <= kExpError * here)) {
            findings.expect("presentation", column, row, here);
        } else if (stored != here) {
            findings.missing(
                fmt::format("presentation.{}", column),
                fmt::format("{} by exp() of this machine, {} stored and used", here, stored));
        }
    };
    check_decay("slip_decay", found->here.slip_decay);
    check_decay("heal_decay", found->here.heal_decay);
    return found->scene;
}

/// A person's answer within the guard time would have been none; and what is asked to be confirmed
/// was.
void check_presses(const protocols::Protocol& protocol,
                   const StoredRow& response,
                   Findings& findings) {
    constexpr double kRounding = 1e-6;
    const double guard = protocol.timing.guard;
    for (const std::string part : {"", "confidence_"}) {
        const bool asked = part.empty() || !response.null("confidence");
        const bool confirmed = asked && protocol.response.confirm;
        const double reaction = response.real(part + "reaction_s");
        if (asked && response.text("input") != "simulated" && reaction < guard - kRounding) {
            findings.differs(fmt::format("response.{}reaction_s", part),
                             fmt::format("{}", reaction),
                             fmt::format("{} or more, the guard time", guard));
        }
        for (const std::string column : {"first_choice_s", "confirmed_s", "changes"}) {
            if (response.null(part + column) == confirmed) {
                findings.differs(fmt::format("response.{}{}", part, column),
                                 to_text(response.at(part + column)),
                                 confirmed ? "not NULL" : "NULL");
            }
        }
        if (confirmed && response.integer(part + "changes") == 0) {
            findings.expect("response", part + "first_choice_s", response, reaction);
        }
    }
}

using engine::TickRecord;

/// As the flight recorder keeps them.
constexpr std::size_t kFaultTicks = 100;

/// As the servo counts them.
std::int64_t ramp_ticks(const protocols::Protocol& protocol) {
    const double step =
        engine::ramp_step(protocol.apparatus.force_ramp, 1.0 / protocol.apparatus.rate_hz);
    return static_cast<std::int64_t>(std::ceil(1.0 / step));
}

bool trips(const TickRecord& tick) noexcept {
    return (tick.flags & engine::tick_fault) != 0;
}

/// Ticks at the end with the force ramping.
std::int64_t ramped_at_the_end(std::span<const TickRecord> ticks) {
    const auto first = std::find_if(ticks.rbegin(), ticks.rend(), [](const TickRecord& tick) {
        return (tick.flags & engine::tick_ramped) == 0;
    });
    return first - ticks.rbegin();
}

/// How many ticks were felt, or what is stored of it where nothing tells.
std::int64_t felt_ticks(const SessionFrame& frame,
                        const StoredRow& row,
                        bool faulted,
                        const StoredTrace& trace,
                        Findings& findings) {
    const auto all = static_cast<std::int64_t>(trace.ticks.size());
    const std::int64_t stored = row.integer("ticks");
    const bool tripped = all > 0 && trips(trace.ticks.back());
    if (faulted && trace.on_virtual_clock) {
        return all;
    }
    if (tripped) {
        return std::clamp<std::int64_t>(stored, 0, all);
    }
    const std::int64_t ramp = ramp_ticks(frame.protocol);
    if (const std::int64_t found = ramped_at_the_end(trace.ticks); found < ramp) {
        findings.differs("trace", fmt::format("the last {} ticks ramp the force out", found),
                         fmt::format("at least {}: ticks are missing at the end", ramp));
    }
    const std::int64_t max = std::max<std::int64_t>(0, all - ramp);
    return trace.on_virtual_clock ? max : std::clamp<std::int64_t>(stored, 0, max);
}

/// @param pressed  somebody may have said done, also in a trial that was aborted or faulted later
void check_done(std::string_view table,
                const StoredRow& row,
                bool pressed,
                std::int64_t felt,
                std::int64_t period_ns,
                bool exact,
                Findings& findings) {
    const auto at_least_0 = [&](std::string_view column) {
        if (!(row.real(column) >= 0.0)) {
            findings.differs(fmt::format("{}.{}", table, column), to_text(row.at(column)),
                             "0 or more");
        }
    };
    if (exact) {
        findings.expect(table, "done_s", row, static_cast<double>(felt * period_ns) * 1e-9);
    } else {
        at_least_0("done_s");
    }
    if (exact || !pressed) {
        findings.expect(table, "done_uncertainty_s", row, 0.0);
    } else {
        at_least_0("done_uncertainty_s");
    }
}

/// Columns that trial and presentation share.
void check_shared(std::string_view table,
                  const StoredRow& row,
                  const protocols::TrialSummary& sum,
                  bool force,
                  Findings& findings) {
    Row made(table);
    set_summary(made, sum, force);
    findings.expect(made, row);
}

protocols::TrialSummary summary_of(const SessionFrame& frame,
                                   const CheckedInterval& interval,
                                   std::int64_t felt) {
    protocols::TrialMeter meter(frame.protocol.apparatus.stiffness, *interval.scene);
    meter.add(std::span(interval.trace.ticks).first(static_cast<std::size_t>(felt)));
    return meter.summary();
}

}  // namespace

std::vector<CheckedInterval> check_intervals(Database& database,
                                             const SessionFrame& frame,
                                             const StoredRow& trial,
                                             std::span<const Presentation> expected,
                                             bool answered,
                                             std::vector<KnownScene>& known,
                                             Findings& findings) {
    const std::int64_t id = trial.integer("trial_id");
    const auto rows =
        rows_of(database, "SELECT * FROM presentation WHERE trial_id = ?1 ORDER BY interval", id);
    // A trial can be cut off before any of its intervals begins.
    if (rows.size() > expected.size() || (rows.size() < expected.size() && answered)) {
        findings.differs("presentation", palpate::counted(rows.size(), "row"),
                         palpate::counted(expected.size(), "row"));
    }
    std::vector<CheckedInterval> intervals;
    for (std::size_t i = 0; i < std::min(rows.size(), expected.size()); ++i) {
        findings.expect(presentation_row(expected[i], {.slip_decay = rows[i].real("slip_decay"),
                                                       .heal_decay = rows[i].real("heal_decay")}),
                        rows[i]);
        CheckedInterval& one = intervals.emplace_back();
        one.row = rows[i];
        one.scene = scene_of(frame, expected[i], rows[i], known, findings);
        one.trace.whole = !frame.traceless;  // nothing is known of what nobody kept
        try {
            one.chunks = stored_chunks(database, id, static_cast<std::int64_t>(i + 1));
            if (frame.traceless && !one.chunks.views.empty()) {
                findings.differs("trace_chunk", "ticks", "none: the session kept none");
            }
        } catch (const TraceError& e) {
            one.trace.whole = false;
            findings.differs("trace_chunk", e.what(), "a chunk that can be read");
        }
    }
    return intervals;
}

void check_ticks(const SessionFrame& frame,
                 std::span<CheckedInterval> intervals,
                 std::int64_t period_ns,
                 Findings& findings) {
    for (CheckedInterval& one : intervals) {
        if (!one.trace.whole) {
            continue;  // said already
        }
        one.trace = check_trace(one.chunks.views, *one.scene, frame.machine, period_ns, findings,
                                std::move(one.trace.ticks));
        check_replay(*one.scene, one.trace, findings);
        if (frame.gantry) {
            check_counts(*frame.gantry, one.trace, findings);
        }
        check_times(one.trace, period_ns, findings);
        one.chunks = {};
    }
}

bool check_response(const SessionFrame& frame,
                    const StoredRow& response,
                    const protocols::PlannedTrial& planned,
                    std::span<const Presentation> felt,
                    Findings& findings) {
    if (response.text("input") == "simulated" && !frame.simulated) {
        findings.differs("response.input", "\"simulated\"", "a person's: the session is real");
    }
    const bool pictures = frame.protocol.response.kind == protocols::ResponseKind::identification;
    const std::int64_t answer = response.integer("answer_code");
    const std::size_t answers =
        pictures ? frame.pictures.size() : protocols::answers_of(frame.protocol);
    if (answer < 0 || answer >= static_cast<std::int64_t>(answers)) {
        findings.differs("response.answer_code", fmt::format("{}", answer),
                         fmt::format("one of {} {}", answers, pictures ? "pictures" : "answers"));
        return false;
    }
    const auto place = static_cast<std::size_t>(answer);
    Row made("response");
    made.set("chosen_place", pictures ? std::optional(answer) : std::nullopt)
        .set("chosen_object", pictures ? std::optional(frame.pictures[place]) : std::nullopt)
        .set("correct", is_right(frame.protocol, frame.plan, planned, felt, place));
    if (!frame.protocol.response.confidence) {
        made.set("confidence", std::monostate());
    }
    if (response.null("confidence")) {
        made.set("confidence_reaction_s", std::monostate());
    }
    findings.expect(made, response);
    check_presses(frame.protocol, response, findings);
    return true;
}

protocols::RuleAnswer rule_answer(const SessionFrame& frame,
                                  const StoredRow& response,
                                  const protocols::PlannedTrial& planned,
                                  double stimulus,
                                  const protocols::AdaptiveRuns& runs) {
    protocols::Response given;
    given.place = static_cast<std::size_t>(response.integer("answer_code"));
    const auto& objects = frame.protocol.objects;
    const auto chosen =
        std::ranges::find(objects, response.text("chosen_object"), &protocols::ObjectSpec::name);
    if (chosen != objects.end()) {
        given.object = static_cast<std::size_t>(chosen - objects.begin());
    }
    return {.run = planned.adaptive->run,
            .stimulus = stimulus,
            .outcome = outcome_of(frame.protocol, planned, given),
            .track = std::string(runs.of(planned.adaptive->run).track())};
}

void check_step(Database& database,
                std::int64_t trial,
                const std::optional<protocols::RuleAnswer>& answer,
                const protocols::AdaptiveRuns& runs,
                Findings& findings) {
    std::vector<Row> made;
    if (answer) {
        made.push_back(step_row(runs.step_after(*answer)));
    }
    findings.expect("adaptive_step", made,
                    rows_of(database, "SELECT * FROM adaptive_step WHERE trial_id = ?1", trial));
}

std::vector<protocols::TrialSummary> check_summary(const SessionFrame& frame,
                                                   const StoredRow& trial,
                                                   std::span<const CheckedInterval> intervals,
                                                   bool answered_by_numbers,
                                                   bool force,
                                                   Findings& findings) {
    std::vector<protocols::TrialSummary> felt;
    const auto is_whole = [](const CheckedInterval& one) {
        return one.trace.whole;
    };
    if (!std::ranges::all_of(intervals, is_whole) || intervals.empty()) {
        return felt;  // said already, or nothing was begun
    }
    const auto period_ns = engine::tick_period_ns(frame.protocol.apparatus.rate_hz);
    const std::string outcome = trial.text("outcome");
    protocols::TrialSummary sum;
    double done_s = 0.0;
    for (std::size_t i = 0; i < intervals.size(); ++i) {
        const StoredRow& row = intervals[i].row;
        const StoredTrace& trace = intervals[i].trace;
        const bool last = i + 1 == intervals.size();
        const std::int64_t ticks =
            felt_ticks(frame, row, last && outcome == "faulted", trace, findings);
        const protocols::TrialSummary& one =
            felt.emplace_back(summary_of(frame, intervals[i], ticks));
        check_shared("presentation", row, one, force, findings);
        const bool pressed = outcome != "timed_out" || intervals.size() > 1;
        check_done("presentation", row, pressed, ticks, period_ns,
                   answered_by_numbers && trace.on_virtual_clock, findings);
        sum = i == 0 ? one : together(sum, one);
        done_s += row.real("done_s");
    }
    check_shared("trial", trial, sum, force, findings);
    findings.expect("trial", "done_s", trial, done_s);
    findings.expect("trial", "done_uncertainty_s", trial,
                    intervals.back().row.at("done_uncertainty_s"));
    return felt;
}

void check_invalid(const SessionFrame& frame,
                   const StoredRow& trial,
                   const std::optional<std::string>& mark,
                   std::span<const protocols::TrialSummary> felt,
                   Findings& findings) {
    if (frame.replayed) {
        return;
    }
    std::string why = why_invalid(frame.protocol, felt, !frame.simulated);
    if (mark && why.empty()) {
        why = *mark;
    }
    findings.expect("trial", "invalid_reason", trial, why.empty() ? Value() : Value(why));
}

void check_fault_ticks(std::span<const StoredRow> rows,
                       const StoredRow& trial,
                       const StoredTrace& trace,
                       Findings& findings) {
    const bool faulted = trial.text("outcome") == "faulted";
    const std::size_t all = trace.ticks.size();
    const std::size_t expected = faulted ? std::min(all, kFaultTicks) : 0;
    if (!trace.whole) {
        return;
    }
    if (rows.size() != expected) {
        findings.differs("fault_tick", counted(rows.size(), "row"), counted(expected, "row"));
        return;
    }
    for (std::size_t i = 0; i < expected; ++i) {
        const TickRecord& tick = trace.ticks[all - expected + i];
        findings.expect(fault_row(tick), rows[i], {}, tick.tick);
    }
    if (faulted && (all == 0 || !trips(trace.ticks.back()))) {
        findings.differs("trial.outcome", "\"faulted\"", "no fault: the last tick has none");
    }
}

}  // namespace palpate::data
