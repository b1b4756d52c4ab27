#include "protocols/running/trial_scene.hpp"

#include "protocols/design/adaptive_plan.hpp"

namespace palpate::protocols {

namespace {

stimuli::TwoCurve curves_of(const Protocol& protocol, const ObjectSpec& object) {
    return {.a = protocol.outline.a,
            .vertex = protocol.outline.vertex,
            .b = protocol.outline.b,
            .curvature = object.curvature};
}

}  // namespace

stimuli::TwoCurve object_of(const Protocol& protocol, std::size_t object) {
    return curves_of(protocol, protocol.objects.at(object));
}

engine::Scene make_scene(const Protocol& protocol, const Condition& condition) {
    return make_scene(protocol,
                      Presentation{.object = protocol.objects.at(condition.object),
                                   .friction = protocol.frictions.at(condition.friction)});
}

engine::Scene make_scene(const Protocol& protocol, const Presentation& felt) {
    const FrictionSpec& friction = felt.friction;
    const ApparatusSpec& apparatus = protocol.apparatus;
    return {stimuli::make_outline(curves_of(protocol, felt.object)),
            {.stiffness = apparatus.stiffness,
             .damping = apparatus.damping,
             .period = 1.0 / apparatus.rate_hz,
             .friction = {.mu_s = friction.mu_s,
                          .mu_d = friction.mu_d,
                          .tau_slip = friction.tau_slip,
                          .tau_heal = friction.tau_heal},
             .slew = {.speed = apparatus.vertex_slew, .radius = apparatus.vertex_radius}}};
}

std::vector<Picture> make_pictures(const Protocol& protocol, std::span<const std::size_t> order) {
    std::vector<Picture> pictures;
    pictures.reserve(order.size());
    for (const std::size_t object : order) {
        pictures.push_back({.outline = stimuli::silhouette(object_of(protocol, object))});
    }
    return pictures;
}

Question question_of(const Protocol& protocol, std::span<const Picture> pictures) {
    const ResponseSpec& response = protocol.response;
    const bool labelled =
        response.kind == ResponseKind::yes_no || response.kind == ResponseKind::rating;
    return {
        .kind = response.kind,
        .text = response.question,
        .pictures = pictures,
        .answers = answers_of(protocol),
        .labels = labelled ? std::vector{response.low, response.high} : std::vector<std::string>(),
        .confidence = response.confidence};
}

}  // namespace palpate::protocols
