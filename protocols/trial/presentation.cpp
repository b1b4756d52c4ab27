#include "protocols/trial/presentation.hpp"

#include "engine/base/refuse.hpp"
#include "protocols/design/adaptive_plan.hpp"

namespace palpate::protocols {
namespace {

Presentation comparison_of(const Protocol& protocol, const PlannedTrial& planned, double stimulus) {
    const AdaptiveSpec& spec = *protocol.procedure;
    Presentation felt{.interval = planned.adaptive->comparison,
                      .object = protocol.objects.at(planned.condition.object),
                      .friction = protocol.frictions.at(planned.condition.friction),
                      .stimulus = stimulus};
    feel_stimulus(spec, stimulus, felt);
    return felt;
}

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
    if (!planned.adaptive) {
        return {{.interval = 1,
                 .object = protocol.objects.at(planned.condition.object),
                 .friction = protocol.frictions.at(planned.condition.friction)}};
    }
    std::vector<Presentation> intervals{comparison_of(protocol, planned, *stimulus)};
    if (intervals_of(protocol) == 2) {
        const std::size_t other = 3 - planned.adaptive->comparison;
        intervals.insert(other == 1 ? intervals.begin() : intervals.end(),
                         {.interval = other,
                          .object = protocol.objects.at(planned.condition.object),
                          .friction = protocol.frictions.at(planned.adaptive->standard_friction)});
    }
    return intervals;
}

}  // namespace palpate::protocols
