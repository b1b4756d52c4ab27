#include "data/verify/replay_check.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "engine/realtime/felt_scene.hpp"
#include "data/trace/columns.hpp"
#include "data/trace/derived_hash.hpp"
#include "data/trace/retrace.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;

template <class T>
bool equal_bits(const T& a, const T& b) noexcept {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

std::string text_of(const engine::Vec3& v) {
    return fmt::format("({}, {}, {})", v.x, v.y, v.z);
}
std::string text_of(double value) {
    return fmt::format("{}", value);
}

/// Columns that follow from HIP, by what they are called in the trace.
struct Column {
    const char* name;
    bool (*same)(const TickRecord& stored, const TickRecord& again) noexcept;
    std::string (*text)(const TickRecord& tick);
};

template <auto Field>
bool same_field(const TickRecord& stored, const TickRecord& again) noexcept {
    return equal_bits(stored.*Field, again.*Field);
}
template <auto Field>
std::string field_text(const TickRecord& tick) {
    return text_of(tick.*Field);
}
template <auto Field>
constexpr Column column(const char* name) {
    return {name, same_field<Field>, field_text<Field>};
}

constexpr std::array kColumns{
    column<&TickRecord::force>("trace.force"),
    column<&TickRecord::go>("trace.go"),
    column<&TickRecord::mu>("trace.mu"),
    column<&TickRecord::normal_force>("trace.rendered_normal_n"),
    column<&TickRecord::tangential_force>("trace.rendered_tangential_n"),
    column<&TickRecord::u>("trace.u"),
    column<&TickRecord::v>("trace.v"),
    Column{"trace.segment", same_field<&TickRecord::segment>,
           [](const TickRecord& tick) {
               return fmt::format("{}", tick.segment);
           }},
    Column{"trace.mode", same_field<&TickRecord::mode>,
           [](const TickRecord& tick) {
               return std::string(to_string(tick.mode));
           }},
    Column{"trace.flags",
           [](const TickRecord& stored, const TickRecord& again) noexcept {
               return (stored.flags & engine::kSceneFlags) == (again.flags & engine::kSceneFlags);
           },
           [](const TickRecord& tick) {
               return fmt::format("{}", tick.flags & engine::kSceneFlags);
           }},
};

}  // namespace

void check_replay(const engine::SceneView& scene, const StoredTrace& trace, Findings& findings) {
    if (!trace.holds_contacts) {
        return;
    }
    std::array<Finding, kColumns.size()> found;
    for (Finding& finding : found) {
        finding.count = 0;
    }
    engine::FeltState state;
    for (const TickRecord& tick : trace.ticks) {
        TickRecord again;
        again.hip = tick.hip;
        engine::set_contacts(std::span(&again, 1), scene, state);
        for (std::size_t i = 0; i < kColumns.size(); ++i) {
            if (kColumns[i].same(tick, again) || found[i].count++ > 0) {
                continue;
            }
            found[i].tick = tick.tick;
            found[i].what = kColumns[i].name;
            found[i].stored = kColumns[i].text(tick);
            found[i].recomputed = kColumns[i].text(again);
        }
    }
    for (Finding& finding : found) {
        if (finding.count > 0) {
            findings.add(std::move(finding));
        }
    }
}

void check_counts(const engine::Gantry& gantry, const StoredTrace& trace, Findings& findings) {
    Finding finding;
    finding.what = "trace.hip";
    finding.count = 0;
    std::optional<engine::Vec3> before;
    for (const TickRecord& tick : trace.ticks) {
        const auto there = gantry.locate(tick.counts);
        const bool none = !there || tick.counts == engine::Gantry::Counts{};
        const bool kept = none && (!before || tick.hip == *before);
        before = tick.hip;
        if (kept || (there && *there == tick.hip) || finding.count++ > 0) {
            continue;
        }
        finding.tick = tick.tick;
        finding.stored = text_of(tick.hip);
        finding.recomputed = there ? text_of(*there) : "outside the workspace";
    }
    if (finding.count > 0) {
        findings.add(std::move(finding));
    }
}

bool on_virtual_clock(const StoredTrace& trace) noexcept {
    return std::all_of(trace.ticks.begin(), trace.ticks.end(),
                       [](const TickRecord& tick) { return tick.lateness_us == 0.0F; });
}

void check_times(const StoredTrace& trace, std::int64_t period_ns, Findings& findings) {
    const bool is_virtual = on_virtual_clock(trace);
    std::int64_t before = 0;
    for (const TickRecord& tick : trace.ticks) {
        const std::int64_t due = tick.tick * period_ns;
        if (is_virtual ? tick.time_ns != due : tick.time_ns < before) {
            findings.add({.kind = FindingKind::differs,
                          .trial = {},
                          .tick = tick.tick,
                          .what = "trace.time_s",
                          .stored = fmt::format("{}", seconds_of(tick.time_ns)),
                          .recomputed = is_virtual ? fmt::format("{}", due)
                                                   : fmt::format("at least {}", before)});
            return;
        }
        before = tick.time_ns;
    }
}

}  // namespace palpate::data
