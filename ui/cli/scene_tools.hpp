#pragma once

#include <functional>

#include "protocols/file/scene_file.hpp"

/// What the offline tools compute, as CSV texts. Column names carry the units; numbers are written
/// in the fewest digits that read back as the same double.
namespace palpate::ui {

/// What a tick in the plane answers: a row of render's table but for its time.
struct PlaneTick {
    /// Where the god-object stopped elsewhere than at the first place in its cone, and whether that
    /// is proven.
    struct Marks {
        bool held = false;      ///< by an open end or a border
        bool slewed = false;    ///< the budget of the vertex slew ended the walk
        bool unproven = false;  ///< the search was broken off
    };

    engine::Mode mode = engine::Mode::free;
    engine::SegmentPlace place{};  ///< of the closest point
    engine::Vec2 cp{};             ///< m
    engine::Vec2 go{};             ///< m
    double fn = 0.0;               ///< N
    double ft = 0.0;               ///< N
    engine::Vec2 force{};          ///< on the user, N
    Marks marks{};
};

/// The contact after HIP moved to `hip` (m), `period` s after the tick before.
using PlaneFeel = std::function<PlaneTick(const engine::Vec2& hip, double period)>;
/// That of a scene, for ticks of `period` s. @throws std::invalid_argument if its curves do not
/// make an object
using MakePlaneFeel = PlaneFeel (*)(const protocols::SceneFile& scene, double period);

}  // namespace palpate::ui
