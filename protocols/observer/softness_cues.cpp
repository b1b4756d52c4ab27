#include "protocols/observer/softness_cues.hpp"

#include <algorithm>

#include "protocols/design/object_outline.hpp"
#include "protocols/observer/curvature_cues.hpp"

namespace palpate::protocols {

/// The shape at rest.
struct SoftnessCues::Rest {
    std::shared_ptr<const engine::Outline> outline;
    engine::OutlineFeet feet;

    explicit Rest(std::shared_ptr<const engine::Outline> shape)
        : outline(std::move(shape)), feet(*outline) {}
};

SoftnessCues::SoftnessCues(const Protocol& protocol) {
    const auto felt = std::find_if(
        protocol.objects.begin(), protocol.objects.end(),
        [&](const ObjectSpec& object) { return object.name == protocol.procedure->object; });
    rest_ = std::make_shared<const Rest>(outline_of(protocol, *felt));
}

void SoftnessCues::add(std::span<const engine::TickRecord> ticks) noexcept {
    for (const engine::TickRecord& tick : ticks) {
        const double force = glm::length(tick.force);
        if (++tick_ % kEach != 0 || force < kFeltForce) {
            continue;
        }
        const engine::ClosestPoint nearest = rest_->feet.closest(engine::Vec2(tick.hip));
        if (nearest.inside) {
            product_ += force * nearest.distance;
            squares_ += force * force;
        }
    }
}

std::optional<double> SoftnessCues::softness() const noexcept {
    return product_ > 0.0 ? std::optional(product_ / squares_) : std::nullopt;
}

}  // namespace palpate::protocols
