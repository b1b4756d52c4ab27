#include "data/verify/simulated_answer.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "protocols/observer/simulated_observer.hpp"
#include "protocols/running/trial_scene.hpp"

namespace palpate::data {
namespace {

/// exp() and log() of two C libraries differ in the last bits, and reaction times with them.
constexpr double kSameTime = 1e-12;

}  // namespace

void check_simulated_answer(const SessionFrame& frame,
                            const StoredRow& trial,
                            const StoredRow& response,
                            const StoredTrace& trace,
                            std::size_t number,
                            Findings& findings) {
    const std::int64_t felt = trial.integer("ticks");
    if (!frame.simulated || frame.old || response.text("input") != "simulated" || !trace.whole ||
        felt < 0 || felt > static_cast<std::int64_t>(trace.ticks.size())) {
        return;
    }
    protocols::SimulatedObserver observer(frame.protocol,
                                          {.protocol_hash = frame.protocol_hash,
                                           .participant = frame.key.participant,
                                           .session = frame.key.session,
                                           .purpose = {},
                                           .seed = frame.seed},
                                          frame.plan.picture_order, [] { return true; });
    observer.feel(std::span(trace.ticks).first(static_cast<std::size_t>(felt)));
    const auto pictures = protocols::make_pictures(frame.protocol, frame.plan.picture_order);
    const protocols::Choice choice =
        observer.choose({.number = number}, protocols::which_of(pictures));
    findings.expect("response", "place", response, static_cast<std::int64_t>(choice.place));
    if (!(std::fabs(response.real("reaction_s") - choice.reaction_s) <= kSameTime)) {
        findings.expect("response", "reaction_s", response, choice.reaction_s);
    }
    findings.expect("response", "uncertainty_s", response, choice.uncertainty_s);
}

}  // namespace palpate::data
