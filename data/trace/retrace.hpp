#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/device/many_hips.hpp"
#include "engine/realtime/scene_view.hpp"
#include "engine/realtime/tick_record.hpp"
#include "data/trace/ticks.hpp"

namespace palpate::data {

/// HIP from encoder counts, as the device computed it: where the linkage has no pose HIP is the
/// last one.
class HipFromCounts {
public:
    /// @param machine  linkage, zeros and counts per turn of the readings
    explicit HipFromCounts(const engine::PantographSpec& machine);
    /// Of the next ticks, m, object frame. @param hips  as many as `counts`
    void at(std::span<const engine::Pantograph::Counts> counts,
            std::span<engine::Vec2> hips) noexcept;

private:
    engine::ManyHips machine_;
    engine::Vec2 last_{};
};

/// Part bits of what does not follow from the rest of the tick. Recorder and replay ask the same
/// question: what one answers, the other can rely on.
class Retrace {
public:
    /// @param machine  nothing: HIP follows from nothing; in space, where there is none, from its
    ///                 columns where it is a whole number of their steps
    /// @param scene    nothing: contacts follow from nothing; must outlive this
    Retrace(const std::optional<engine::PantographSpec>& machine, const engine::SceneView& scene);
    ~Retrace();

    /// The parts of the next recorded ticks that nothing else in a tick tells, into `parts`, as
    /// many.
    void parts(std::span<const engine::TickRecord> ticks, std::span<std::uint8_t> parts);

    /// The contacts of the next ticks, after HIP is known. Every tick, in order.
    void contacts(std::span<engine::TickRecord> ticks) noexcept;

private:
    [[nodiscard]] engine::Vec3 hip_of(const engine::TickRecord& tick, std::size_t i) const noexcept;

    std::optional<HipFromCounts> machine_;
    engine::SceneView scene_;
    std::unique_ptr<engine::FeltState> state_;  ///< never null
    Ticks again_;
    std::vector<engine::Pantograph::Counts> counts_;
    std::vector<engine::Vec2> hips_;  ///< of the counts, if there is a machine
};

}  // namespace palpate::data
