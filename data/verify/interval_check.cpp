#include "data/verify/interval_check.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "protocols/session/recorder.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "data/store/written_rows.hpp"
#include "data/verify/replay_check.hpp"

namespace palpate::data {
namespace {

using protocols::Presentation;

/// How far apart exp() of two C libraries may be.
constexpr double kExpError = 4e-16;

/// With the decays that were recorded.
std::unique_ptr<engine::FeltScene> scene_of(const SessionFrame& frame,
                                            const Presentation& felt,
                                            const StoredRow& row,
                                            Findings& findings) {
    constexpr std::string_view table = "presentation";
    std::unique_ptr<engine::FeltScene> scene(
        new engine::FeltScene(make_felt_scene(frame.protocol, felt)));
    const auto check_decay = [&](std::string_view column, double here) {
        const double stored = row.real(column);
        if (!(std::fabs(stored - here) <= kExpError * here)) {
            findings.expect(table, column, row, here);
        } else if (stored != here) {
            findings.missing(
                fmt::format("{}.{}", table, column),
                fmt::format("{} by exp() of this machine, {} stored and used", here, stored));
        }
    };
    check_decay("slip_decay", scene->decay().slip);
    check_decay("heal_decay", scene->decay().heal);
    scene->restore_decay({.slip = row.real("slip_decay"), .heal = row.real("heal_decay")});
    return scene;
}

std::optional<std::size_t> index_of(const std::vector<protocols::ObjectSpec>& objects,
                                    const std::string& name) {
    const auto found = std::find_if(objects.begin(), objects.end(),
                                    [&](const auto& object) { return object.name == name; });
    return found == objects.end()
             ? std::nullopt
             : std::optional(static_cast<std::size_t>(found - objects.begin()));
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

void read_chunks(Database& database,
                 std::int64_t trial,
                 std::int64_t interval,
                 bool traceless,
                 CheckedInterval& one,
                 Findings& findings) {
    try {
        one.chunks = stored_chunks(database, trial, interval);
        if (traceless) {
            one.trace.whole = false;  // nothing is known of what nobody kept
            if (!one.chunks.views.empty()) {
                findings.differs("trace_chunk", "ticks", "none: the session kept none");
            }
        }
    } catch (const TraceError& e) {
        one.trace.whole = false;
        findings.differs("trace_chunk", e.what(), "a chunk that can be read");
    }
}

}  // namespace

std::vector<CheckedInterval> check_intervals(Database& database,
                                             const SessionFrame& frame,
                                             const StoredRow& trial,
                                             std::span<const Presentation> expected,
                                             bool answered,
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
        one.scene = scene_of(frame, expected[i], rows[i], findings);
        read_chunks(database, id, static_cast<std::int64_t>(i + 1), frame.traceless, one, findings);
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
    findings.expect("response", "chosen_place", response, pictures ? Value(answer) : Value());
    findings.expect("response", "chosen_object", response,
                    pictures ? Value(frame.pictures[place]) : Value());
    const auto right = is_right(frame.protocol, frame.plan, planned, felt, place);
    findings.expect("response", "correct", response,
                    right ? Value(std::int64_t{*right ? 1 : 0}) : Value());
    if (!frame.protocol.response.confidence) {
        findings.expect("response", "confidence", response, Value());
    }
    if (response.null("confidence")) {
        findings.expect("response", "confidence_reaction_s", response, Value());
    }
    check_presses(frame.protocol, response, findings);
    return true;
}

protocols::RuleAnswer rule_answer(const SessionFrame& frame,
                                  const StoredRow& response,
                                  const protocols::PlannedTrial& planned,
                                  double stimulus) {
    const protocols::Response given{
        .place = static_cast<std::size_t>(response.integer("answer_code")),
        .object = index_of(frame.protocol.objects, response.text("chosen_object"))};
    return {.run = planned.adaptive->run,
            .stimulus = stimulus,
            .outcome = outcome_of(frame.protocol, planned, given)};
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

}  // namespace palpate::data
