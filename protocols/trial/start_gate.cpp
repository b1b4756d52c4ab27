#include "protocols/trial/start_gate.hpp"

#include <algorithm>
#include <iterator>

#include "engine/contact/closest_point.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "protocols/design/object_outline.hpp"

namespace palpate::protocols {

engine::Vec3 start_of(const Protocol& protocol) {
    return {protocol.apparatus.start, protocol.surface ? protocol.surface->start_height : 0.0};
}

StartGate::StartGate(const Protocol& protocol)
    : start_(start_of(protocol)),
      radius_(protocol.apparatus.start_radius),
      in_space_(protocol.surface.has_value()) {
    // Of what a rule may choose the flattest and the roundest: what lies in another lies in these.
    std::vector<ObjectSpec> objects = protocol.objects;
    std::ranges::move(extreme_objects(protocol), std::back_inserter(objects));
    for (const ObjectSpec& object : objects) {
        if (in_space_) {
            surfaces_.emplace_back(surface_of(protocol, object));
        } else {
            outlines_.push_back(outline_of(protocol, object));
        }
    }
}

bool StartGate::lets_begin(const engine::Vec3& place) const {
    return radius_ == 0.0 || (glm::length(place - start_) <= radius_ && !inside(place));
}

bool StartGate::inside(const engine::Vec3& place) const {
    return std::ranges::any_of(
               outlines_,
               [&](const auto& outline) {
                   return engine::OutlineFeet(*outline).closest(engine::Vec2(place)).inside;
               }) ||
           std::ranges::any_of(surfaces_,
                               [&](const auto& feet) { return feet.closest(place).inside; });
}

}  // namespace palpate::protocols
