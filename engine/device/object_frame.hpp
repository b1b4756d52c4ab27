#pragma once

#include "engine/geometry/vec.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {

/// The object frame in the linkage's frame: moved by `origin`, then turned by `turn`.
class ObjectFrame {
public:
    /// @param origin  of the object frame, in the linkage's frame, m
    /// @param turn    from the linkage's x axis to the object frame's, rad
    ObjectFrame(const Vec2& origin, double turn) noexcept : origin_(origin), turn_(sin_cos(turn)) {}

    /// A vector of the linkage's frame, seen from the object frame.
    [[nodiscard]] Vec2 to_object(const Vec2& v) const noexcept {
        return Vec2{turn_.cos * v.x + turn_.sin * v.y, turn_.cos * v.y - turn_.sin * v.x};
    }
    [[nodiscard]] Vec2 to_linkage(const Vec2& v) const noexcept {
        return Vec2{turn_.cos * v.x - turn_.sin * v.y, turn_.sin * v.x + turn_.cos * v.y};
    }
    [[nodiscard]] Vec2 point_to_object(const Vec2& p) const noexcept {
        return to_object(p - origin_);
    }
    [[nodiscard]] Vec2 point_to_linkage(const Vec2& p) const noexcept {
        return origin_ + to_linkage(p);
    }

private:
    Vec2 origin_;
    SinCos turn_;
};

}  // namespace palpate::engine
