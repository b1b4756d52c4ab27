#include "data/verify/summary_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include <fmt/format.h>

#include "engine/safety/safety_limits.hpp"
#include "protocols/running/trial_meter.hpp"
#include "data/store/people.hpp"
#include "data/trace/columns.hpp"
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
std::int64_t ramped_at_the_end(const std::vector<TickRecord>& ticks) {
    const auto first = std::find_if(ticks.rbegin(), ticks.rend(), [](const TickRecord& tick) {
        return (tick.flags & engine::tick_ramped) == 0;
    });
    return first - ticks.rbegin();
}

/// How many ticks were felt, or what is stored of it where nothing tells.
std::int64_t felt_ticks(const SessionFrame& frame,
                        const StoredRow& trial,
                        const StoredTrace& trace,
                        Findings& findings) {
    const auto all = static_cast<std::int64_t>(trace.ticks.size());
    const std::int64_t stored = trial.integer("ticks");
    const bool tripped = all > 0 && trips(trace.ticks.back());
    if (trial.text("outcome") == "faulted" && on_virtual_clock(trace)) {
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
    const std::int64_t most = std::max<std::int64_t>(0, all - ramp);
    return on_virtual_clock(trace) ? most : std::clamp<std::int64_t>(stored, 0, most);
}

/// A column that older schemas did not have.
void expect_later(std::string_view column,
                  const StoredRow& trial,
                  const Value& recomputed,
                  const SessionFrame& frame,
                  Findings& findings) {
    if (frame.old && trial.null(column)) {
        findings.missing(fmt::format("trial.{}", column), "an older palpate did not store it");
        return;
    }
    findings.expect("trial", column, trial, recomputed);
}

void check_done(const StoredRow& trial,
                std::int64_t felt,
                std::int64_t period_ns,
                bool exact,
                Findings& findings) {
    if (exact) {
        findings.expect("trial", "done_s", trial, static_cast<double>(felt * period_ns) * 1e-9);
    } else if (!(trial.real("done_s") >= 0.0)) {
        findings.differs("trial.done_s", to_text(trial.at("done_s")), "0 or more");
    }
    if (exact || trial.text("outcome") != "complete") {
        findings.expect("trial", "done_uncertainty_s", trial, 0.0);
    } else if (!(trial.real("done_uncertainty_s") >= 0.0)) {
        findings.differs("trial.done_uncertainty_s", to_text(trial.at("done_uncertainty_s")),
                         "0 or more");
    }
}

/// A column of a tick as SQL has it.
Value value_of(const TickRecord& tick, const TraceColumn& column) {
    const auto* at = reinterpret_cast<const std::byte*>(&tick) + column.offset;
    const auto value = [at](auto sample) {
        std::memcpy(&sample, at, sizeof sample);
        return sample;
    };
    if (column.type == "f64le") {
        return value(double{});
    }
    if (column.type == "f32le") {
        return static_cast<double>(value(float{}));
    }
    if (column.type == "i64le") {
        return value(std::int64_t{});
    }
    if (column.type == "i32le") {
        return std::int64_t{value(std::int32_t{})};
    }
    if (column.type == "i16le") {
        return std::int64_t{value(std::int16_t{})};
    }
    return std::int64_t{value(std::uint8_t{})};
}

void check_fault_row(const StoredRow& row, const TickRecord& tick, Findings& findings) {
    for (const TraceColumn& column : trace_columns()) {
        const Value traced = value_of(tick, column);
        if (!same(row.at(column.name), traced)) {
            findings.add({.kind = FindingKind::differs,
                          .trial = {},
                          .tick = tick.tick,
                          .what = fmt::format("fault_tick.{}", column.name),
                          .stored = to_text(row.at(column.name)),
                          .recomputed = to_text(traced)});
        }
    }
}

}  // namespace

void check_summary(const SessionFrame& frame,
                   const StoredRow& trial,
                   const StoredTrace& trace,
                   bool answered_by_numbers,
                   Findings& findings) {
    if (!trace.whole) {
        return;  // said already
    }
    const std::int64_t felt = felt_ticks(frame, trial, trace, findings);
    protocols::TrialMeter meter(frame.protocol.apparatus.stiffness);
    meter.add(std::span(trace.ticks).first(static_cast<std::size_t>(felt)));
    const protocols::TrialSummary sum = meter.summary();
    const auto expect = [&](std::string_view column, const Value& value) {
        findings.expect("trial", column, trial, value);
    };
    const auto later = [&](std::string_view column, const Value& value) {
        expect_later(column, trial, value, frame, findings);
    };
    expect("ticks", sum.ticks);
    expect("contact_ticks", sum.contact_ticks);
    expect("slip_ticks", sum.slip_ticks);
    expect("late_ticks", sum.late_ticks);
    expect("saturated_ticks", sum.saturated_ticks);
    expect("path_length_m", sum.path_length_m);
    expect("mean_normal_force_n", sum.mean_normal_force_n);
    expect("max_normal_force_n", sum.max_normal_force_n);
    expect("energy_j", sum.energy_j);
    expect("first_contact_s", sum.first_contact_s ? Value(*sum.first_contact_s) : Value());
    later("contact_episodes", sum.contact_episodes);
    later("worst_episode_j", sum.worst_episode_j);
    later("skipped_ticks", sum.skipped_ticks);
    later("slewed_ticks", sum.slewed_ticks);
    later("stale_ticks", sum.stale_ticks);
    const auto period_ns =
        static_cast<std::int64_t>(std::floor(1e9 / frame.protocol.apparatus.rate_hz + 0.5));
    check_done(trial, felt, period_ns, answered_by_numbers && on_virtual_clock(trace), findings);
}

void check_invalid(Database& database,
                   const SessionFrame& frame,
                   const StoredRow& trial,
                   const StoredTrace& trace,
                   Findings& findings) {
    if (!trace.whole || frame.replayed || (frame.old && trial.null("invalid"))) {
        return;
    }
    protocols::TrialMeter meter(frame.protocol.apparatus.stiffness);
    const auto felt = std::clamp<std::int64_t>(trial.integer("ticks"), 0,
                                               static_cast<std::int64_t>(trace.ticks.size()));
    meter.add(std::span(trace.ticks).first(static_cast<std::size_t>(felt)));
    std::string why = why_invalid(frame.protocol, meter.summary(), !frame.simulated);
    if (const auto mark = find_mark(database, trial.integer("id")); mark && why.empty()) {
        why = mark->reason;
    }
    findings.expect("trial", "invalid", trial, why.empty() ? Value() : Value(why));
}

void check_fault_ticks(Database& database,
                       const SessionFrame& frame,
                       const StoredRow& trial,
                       const StoredTrace& trace,
                       Findings& findings) {
    const bool faulted = trial.text("outcome") == "faulted";
    const auto rows = rows_of(database, "SELECT * FROM fault_tick WHERE trial = ?1 ORDER BY tick",
                              trial.integer("id"));
    const std::size_t all = trace.ticks.size();
    const std::size_t expected = faulted ? std::min(all, kFaultTicks) : 0;
    if (frame.old && faulted && rows.empty()) {
        findings.missing("fault_tick", "an older palpate did not store the ticks before a fault");
        return;
    }
    if (!trace.whole) {
        return;
    }
    if (rows.size() != expected) {
        findings.differs("fault_tick", fmt::format("{} rows", rows.size()),
                         fmt::format("{} rows", expected));
        return;
    }
    for (std::size_t i = 0; i < expected; ++i) {
        check_fault_row(rows[i], trace.ticks[all - expected + i], findings);
    }
    if (faulted && (all == 0 || !trips(trace.ticks.back()))) {
        findings.differs("trial.outcome", "\"faulted\"", "no fault: the last tick has none");
    }
}

}  // namespace palpate::data
