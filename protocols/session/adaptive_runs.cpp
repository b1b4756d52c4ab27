#include "protocols/session/adaptive_runs.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "protocols/design/adaptive_plan.hpp"
#include "protocols/design/factorial.hpp"

namespace palpate::protocols {

AdaptiveRuns::AdaptiveRuns(const Protocol& protocol, const StreamKey& session) {
    if (!protocol.procedure) {
        return;
    }
    for (std::size_t run = 0; run < protocol.runs.size(); ++run) {
        begun_.emplace_back(*protocol.procedure->rule.spec, stream(run_key(session, run)));
    }
    procedures_ = begun_;
}

double AdaptiveRuns::next(std::size_t run) const {
    const Procedure& procedure = procedures_.at(run);
    if (procedure.finished()) {
        throw std::logic_error(fmt::format("run {} has ended", run));
    }
    return procedure.next().front();
}

void AdaptiveRuns::update(const RuleAnswer& answer) {
    procedures_.at(answer.run).update(std::span(&answer.stimulus, 1), answer.outcome);
}

AdaptiveStep AdaptiveRuns::step_after(const RuleAnswer& answer) const {
    const Procedure& procedure = procedures_.at(answer.run);
    return {
        .answer = answer, .estimates = procedure.estimates(), .state_hash = procedure.state_hash()};
}

std::optional<double> stimulus_for(const Protocol& protocol,
                                   const PlannedTrial& planned,
                                   const AdaptiveRuns& runs) {
    if (!planned.adaptive) {
        return std::nullopt;
    }
    return planned.phase == Phase::practice ? protocol.procedure->practice_stimulus
                                            : runs.next(planned.adaptive->run);
}

std::size_t outcome_of(const Protocol& protocol,
                       const PlannedTrial& planned,
                       const Response& response) {
    switch (protocol.response.kind) {
        case ResponseKind::two_interval:
            return response.place + 1 == planned.adaptive->comparison ? 1 : 0;
        case ResponseKind::identification: {
            const std::vector<std::size_t> pictured = objects_of(protocol, true);
            const auto found = std::find(pictured.begin(), pictured.end(), response.object);
            return static_cast<std::size_t>(found - pictured.begin());
        }
        case ResponseKind::yes_no:
        case ResponseKind::rating:
            break;
    }
    return response.place;
}

std::optional<bool> is_right(const Protocol& protocol,
                             const Plan& plan,
                             const PlannedTrial& planned,
                             std::span<const Presentation> felt,
                             std::size_t place) {
    if (protocol.response.kind == ResponseKind::identification && !planned.adaptive) {
        const auto& pictures = plan.picture_order;
        const bool pictured =
            std::find(pictures.begin(), pictures.end(), planned.condition.object) != pictures.end();
        return pictured ? std::optional(pictures.at(place) == planned.condition.object)
                        : std::nullopt;
    }
    if (protocol.response.kind != ResponseKind::two_interval || felt.size() != 2) {
        return std::nullopt;
    }
    const double first = varied_value(*protocol.procedure, felt[0]);
    const double second = varied_value(*protocol.procedure, felt[1]);
    if (first == second) {
        return std::nullopt;
    }
    return (second > first) == (place == 1);
}

}  // namespace palpate::protocols
