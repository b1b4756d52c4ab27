#include "data/verify/summary_check.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "engine/safety/safety_limits.hpp"
#include "protocols/session/trial_meter.hpp"
#include "data/store/written_rows.hpp"
#include "data/verify/replay_check.hpp"

namespace palpate::data {
namespace {

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
    if (faulted && on_virtual_clock(trace)) {
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
    return on_virtual_clock(trace) ? max : std::clamp<std::int64_t>(stored, 0, max);
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

bool all_whole(std::span<const CheckedInterval> intervals) {
    return std::all_of(intervals.begin(), intervals.end(),
                       [](const CheckedInterval& one) { return one.trace.whole; });
}

}  // namespace

std::vector<protocols::TrialSummary> check_summary(const SessionFrame& frame,
                                                   const StoredRow& trial,
                                                   std::span<const CheckedInterval> intervals,
                                                   bool answered_by_numbers,
                                                   bool force,
                                                   Findings& findings) {
    std::vector<protocols::TrialSummary> felt;
    if (!all_whole(intervals) || intervals.empty()) {
        return felt;  // said already, or nothing was begun
    }
    const auto period_ns = engine::tick_period_ns(frame.protocol.apparatus.rate_hz);
    const std::string outcome = trial.text("outcome");
    protocols::TrialSummary sum;
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
                   answered_by_numbers && on_virtual_clock(trace), findings);
        sum = i == 0 ? one : together(sum, one);
    }
    check_shared("trial", trial, sum, force, findings);
    findings.expect("trial", "done_s", trial, intervals.back().row.at("done_s"));
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
