#pragma once

#include "engine/surface/surface_ground.hpp"

namespace palpate::engine {

/// Where the god-object is within the normals of a convex edge, from those of its own patch (angle
/// 0) to those of the patch beyond.
struct SurfaceFan {
    bool on = false;
    SurfacePlace beyond{};  ///< the same point on the other patch
    double angle = 0.0;     ///< of the felt normal from that of its own patch, rad
};

/// The vertex slew of one tick on a surface, as god_object.hpp has it for outlines.
struct SurfaceSlew {
    Vec3 from{};             ///< HIP one tick ago, relative to the object's origin, m
    double budget = 1e300;   ///< travel allowed in this tick, m
    double radius = 0.0;     ///< m of budget per radian of a fan
    double used = 0.0;       ///< m
    double direction = 0.0;  ///< in which the fan is turned in this tick: +1, -1, 0 not yet

    /// There is a budget; and it is used up, but for 1e-9 of it.
    [[nodiscard]] bool limited() const noexcept { return budget < 1e299; }
    [[nodiscard]] bool spent() const noexcept { return limited() && used >= budget * (1.0 - 1e-9); }
};

/// What a turn of the felt normal came to.
struct FanTurn {
    enum class End : std::uint8_t {
        rests,   ///< within the cone of the felt normal
        spent,   ///< outside of it, and the budget is used up
        back,    ///< turned back to its own patch
        beyond,  ///< turned to the other patch
        ended,   ///< the normal that points at HIP lies in the fan: the contact ends
    };
    End end = End::rests;
    SurfaceSpot spot{};  ///< with the felt normal; on its patch after `back` and `beyond`
};

/// The patch of `b` falls away from that of `a`, by more than rounding, at a point that they share.
[[nodiscard]] bool falls_away(const SurfaceSpot& a, const SurfaceSpot& b) noexcept;

/// Lets the god-object slide along a convex edge, and turns its normal through the fan there while
/// HIP drives it on: by `radius` of budget per radian, beginning at the moment of the tick at which
/// HIP, on its straight way, began to. Along the edge it goes on as fast, over the ends of patches;
/// a corner of several edges holds it until the fan is left.
[[nodiscard]] FanTurn turn_in_fan(SurfaceGround& ground,
                                  const SurfacePlace& place,
                                  SurfaceFan& fan,
                                  SurfaceSlew& slew) noexcept;

}  // namespace palpate::engine
