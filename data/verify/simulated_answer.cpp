#include "data/verify/simulated_answer.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "protocols/design/session_plan.hpp"
#include "protocols/observer/simulated_observer.hpp"
#include "protocols/trial/trial_scene.hpp"

namespace palpate::data {
namespace {

/// exp() and log() of two C libraries differ in the last bits, and reaction times with them.
constexpr double kSameTime = 1e-12;

}  // namespace

void check_simulated_answer(const SessionFrame& frame,
                            const StoredRow& response,
                            std::span<const CheckedInterval> intervals,
                            std::size_t done,
                            Findings& findings) {
    const auto usable = [](const CheckedInterval& one) {
        const std::int64_t felt = one.row.integer("ticks");
        return one.trace.whole && felt >= 0 &&
               felt <= static_cast<std::int64_t>(one.trace.ticks.size());
    };
    if (!frame.simulated || response.text("input") != "simulated" ||
        !std::all_of(intervals.begin(), intervals.end(), usable)) {
        return;
    }
    protocols::SimulatedObserver observer(
        frame.protocol, session_stream(frame.protocol_hash, frame.key, frame.seed),
        frame.plan.picture_order, [] { return true; },
        frame.person.value_or(protocols::Person{.spec = frame.protocol.observer}));
    for (std::size_t i = 0; i < intervals.size(); ++i) {
        static_cast<void>(observer.ready({.interval = i + 1}));
        observer.feel(std::span(intervals[i].trace.ticks)
                          .first(static_cast<std::size_t>(intervals[i].row.integer("ticks"))));
    }
    const auto pictures = protocols::make_pictures(frame.protocol, frame.plan.picture_order);
    const protocols::Choice choice =
        observer.choose({.done = done}, question_of(frame.protocol, pictures));
    findings.expect("response", "answer_code", response, static_cast<std::int64_t>(choice.place));
    findings.expect("response", "confidence", response,
                    choice.confidence ? Value(std::int64_t{*choice.confidence}) : Value());
    if (choice.confidence && !(std::fabs(response.real("confidence_reaction_s") -
                                         choice.confidence_reaction_s) <= kSameTime)) {
        findings.expect("response", "confidence_reaction_s", response,
                        choice.confidence_reaction_s);
    }
    if (!(std::fabs(response.real("reaction_s") - choice.reaction_s) <= kSameTime)) {
        findings.expect("response", "reaction_s", response, choice.reaction_s);
    }
    findings.expect("response", "reaction_uncertainty_s", response, choice.uncertainty_s);
    findings.expect("response", "early_presses", response, std::int64_t{0});
}

}  // namespace palpate::data
