#pragma once

#include <memory>
#include <vector>

#include "engine/geometry/outline.hpp"
#include "engine/geometry/vec.hpp"
#include "engine/surface/surface_closest.hpp"
#include "protocols/protocol/protocol.hpp"

namespace palpate::protocols {

/// Where the hand begins, m. Without surfaces z is 0.
[[nodiscard]] engine::Vec3 start_of(const Protocol& protocol);

/// Where the handle has to be for a trial to begin: within start_radius_mm of the start, and
/// outside every object of the study. It knows nothing of the trial that comes: what it says tells
/// nothing of it.
class StartGate {
public:
    /// Of no study: open everywhere.
    StartGate() = default;
    /// By the protocol's start and radius, and all objects that its trials may present.
    explicit StartGate(const Protocol& protocol);

    /// Where the handle is to be, object frame, m, and within what distance.
    [[nodiscard]] const engine::Vec3& start() const noexcept { return start_; }
    [[nodiscard]] double radius() const noexcept { return radius_; }
    /// The start has a height.
    [[nodiscard]] bool in_space() const noexcept { return in_space_; }
    [[nodiscard]] bool lets_begin(const engine::Vec3& place) const;

private:
    /// Of any object of the study.
    [[nodiscard]] bool inside(const engine::Vec3& place) const;

    engine::Vec3 start_{};
    double radius_ = 0.0;  ///< m, 0: anywhere
    bool in_space_ = false;
    std::vector<std::shared_ptr<const engine::Outline>> outlines_;
    std::vector<engine::SurfaceFeet> surfaces_;
};

}  // namespace palpate::protocols
