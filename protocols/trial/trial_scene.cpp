#include "protocols/trial/trial_scene.hpp"

#include <utility>

#include "protocols/design/adaptive_plan.hpp"
#include "protocols/design/object_outline.hpp"

namespace palpate::protocols {
namespace {

engine::SceneSpec contact_of(const Protocol& protocol, const Presentation& felt) {
    const FrictionSpec& friction = felt.friction;
    const ApparatusSpec& apparatus = protocol.apparatus;
    engine::LawSpec law = friction.own;
    law.traits = engine::law_named(friction.law);
    return {.stiffness = apparatus.stiffness,
            .damping = apparatus.damping,
            .period = 1.0 / apparatus.rate_hz,
            .friction = {.mu_s = friction.mu_s,
                         .mu_d = friction.mu_d,
                         .tau_slip = friction.tau_slip,
                         .tau_heal = friction.tau_heal},
            .slew = {.speed = apparatus.vertex_slew, .radius = apparatus.vertex_radius},
            .law = law,
            .compliance = felt.object.compliance};
}

}  // namespace

engine::FeltScene make_felt_scene(const Protocol& protocol, const Presentation& felt) {
    if (!protocol.surface) {
        return {outline_of(protocol, felt.object), contact_of(protocol, felt)};
    }
    // The force needs no closest point, and a rim out of every reach leaves no border to come
    // round.
    return {surface_of(protocol, felt.object),
            engine::SurfaceSceneSpec{
                .contact = contact_of(protocol, felt), .look_in_contact = false, .skip_far = true}};
}

std::vector<Picture> make_pictures(const Protocol& protocol, std::span<const std::size_t> order) {
    std::vector<Picture> pictures;
    pictures.reserve(order.size());
    for (const std::size_t object : order) {
        if (protocol.surface) {
            stimuli::PatchDrawing drawing =
                stimuli::drawing_of(*surface_of(protocol, protocol.objects.at(object)));
            pictures.push_back({.outline = std::move(drawing.border),
                                .lines = std::move(drawing.lines),
                                .shade = std::move(drawing.shade),
                                .walls = std::move(drawing.walls)});
        } else {
            pictures.push_back({.outline = silhouette_of(protocol, object)});
        }
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
        .confidence = response.confidence,
        .confirm = response.confirm,
        .timeout_s = protocol.timing.answer_timeout};
}

}  // namespace palpate::protocols
