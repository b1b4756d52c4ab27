#include "protocols/trial/presentation.hpp"

#include "engine/base/refuse.hpp"
#include "protocols/design/adaptive_plan.hpp"

namespace palpate::protocols {
namespace {

constexpr double kMillimetre = 1e-3;

}  // namespace

void feel_stimulus(const AdaptiveSpec& spec, double stimulus, Presentation& felt) {
    const double value = felt_value(spec, stimulus);
    switch (spec.varies) {
        case Varies::curvature:
            felt.object.curvature = value;
            return;
        case Varies::mu:
            felt.friction.mu_d = value * (felt.friction.mu_d / felt.friction.mu_s);
            felt.friction.mu_s = value;
            return;
        case Varies::compliance:
            felt.object.compliance = value * kMillimetre;
    }
}

double varied_value(const AdaptiveSpec& spec, const Presentation& felt) {
    switch (spec.varies) {
        case Varies::curvature:
            return felt.object.curvature;
        case Varies::mu:
            return felt.friction.mu_s;
        case Varies::compliance:
            break;
    }
    return felt.object.compliance / kMillimetre;
}

std::vector<Presentation> presentations_of(const Protocol& protocol,
                                           const PlannedTrial& planned,
                                           std::optional<double> stimulus) {
    refuse_if(
        planned.adaptive.has_value() != stimulus.has_value(), "{}",
        stimulus ? "a stimulus for a trial without a rule" : "no stimulus for a trial of a rule");
    const auto felt = [&](std::size_t interval, std::size_t friction) {
        return Presentation{.interval = interval,
                            .object = protocol.objects.at(planned.condition.object),
                            .friction = protocol.frictions.at(friction)};
    };
    if (!planned.adaptive) {
        return {felt(1, planned.condition.friction)};
    }
    const std::size_t comparison = planned.adaptive->comparison;
    std::vector<Presentation> intervals{felt(comparison, planned.condition.friction)};
    intervals.front().stimulus = stimulus;
    feel_stimulus(*protocol.procedure, *stimulus, intervals.front());
    if (intervals_of(protocol) == 2) {
        intervals.insert(comparison == 2 ? intervals.begin() : intervals.end(),
                         felt(3 - comparison, planned.adaptive->standard_friction));
    }
    return intervals;
}

}  // namespace palpate::protocols
