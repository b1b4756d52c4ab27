#pragma once

#include "protocols/design/object_outline.hpp"
#include "protocols/trial/trial_scene.hpp"

namespace palpate::protocols {

/// The compiled scene of what is felt in the plane.
inline engine::Scene make_scene(const Protocol& protocol, const Presentation& felt) {
    return {outline_of(protocol, felt.object), make_felt_scene(protocol, felt).plane()->spec()};
}
/// The same of a condition.
inline engine::Scene make_scene(const Protocol& protocol, const Condition& condition) {
    return make_scene(protocol,
                      Presentation{.object = protocol.objects.at(condition.object),
                                   .friction = protocol.frictions.at(condition.friction)});
}

/// Which of the pictures?
inline Question which_of(std::span<const Picture> pictures) {
    return {.kind = ResponseKind::identification,
            .text = {},
            .pictures = pictures,
            .answers = pictures.size(),
            .labels = {},
            .confidence = false,
            .confirm = false,
            .timeout_s = 0.0};
}

}  // namespace palpate::protocols
