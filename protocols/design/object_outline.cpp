#include "protocols/design/object_outline.hpp"

#include <algorithm>

#include "engine/surface/nurbs_surface.hpp"

namespace palpate::protocols {

stimuli::TwoCurve object_of(const Protocol& protocol, const ObjectSpec& spec) {
    const OutlineSpec& outline = protocol.outline;
    const stimuli::Pose pose = spec.pose();
    if (pose == stimuli::Pose{}) {
        return {
            .a = outline.a, .vertex = outline.vertex, .b = outline.b, .curvature = spec.curvature};
    }
    return {.a = placed(pose, outline.a),
            .vertex = placed(pose, outline.vertex),
            .b = placed(pose, outline.b),
            .curvature = spec.curvature / spec.size};
}

std::shared_ptr<const engine::Outline> outline_of(const Protocol& protocol,
                                                  const ObjectSpec& spec) {
    return spec.segments.empty() ? stimuli::make_outline(object_of(protocol, spec))
                                 : stimuli::make_outline(spec.segments, spec.pose());
}

std::shared_ptr<const engine::Outline> outline_of(const Protocol& protocol, std::size_t object) {
    return outline_of(protocol, protocol.objects.at(object));
}

std::shared_ptr<const engine::NurbsSurface> surface_of(const Protocol& protocol,
                                                       const ObjectSpec& spec) {
    return stimuli::make_surface({.size = protocol.surface.value().size,
                                  .curvature_x = spec.curvature,
                                  .curvature_y = spec.cross_curvature});
}

std::vector<engine::Vec2> silhouette_of(const Protocol& protocol, std::size_t object) {
    const ObjectSpec& spec = protocol.objects.at(object);
    if (protocol.surface) {
        return stimuli::drawing_of(*surface_of(protocol, spec)).border;
    }
    return spec.segments.empty() ? stimuli::silhouette(object_of(protocol, spec))
                                 : stimuli::silhouette(*outline_of(protocol, object));
}

std::vector<engine::Vec2> plan_of(const Protocol& protocol, std::size_t object) {
    return protocol.surface ? stimuli::border_of(*surface_of(protocol, protocol.objects.at(object)))
                            : silhouette_of(protocol, object);
}

std::optional<double> curvature_of(const ObjectSpec& object) noexcept {
    return object.segments.empty() ? std::optional(object.curvature / object.size) : std::nullopt;
}

bool differ_in_curvature_alone(const Protocol& protocol) noexcept {
    return !protocol.surface && std::ranges::all_of(protocol.objects, [](const ObjectSpec& one) {
        return one.segments.empty() && one.pose() == stimuli::Pose{};
    });
}

}  // namespace palpate::protocols
