#include "protocols/session/stroke_counter.hpp"

#include <algorithm>

namespace palpate::protocols {
namespace {

/// t from F = fn n + ft t, where n is t turned to the left; not normalised. 0 without a force.
engine::Vec2 along(const engine::TickRecord& tick) noexcept {
    const double fn = tick.normal_force;
    const double ft = tick.tangential_force;
    const engine::Vec2 f(tick.force);
    return {ft * f.x + fn * f.y, ft * f.y - fn * f.x};
}

}  // namespace

engine::Vec2 StrokeCounter::step_to(const engine::TickRecord& tick) noexcept {
    const engine::Vec2 hip(tick.hip);
    const engine::Vec2 step = started_ ? hip - last_hip_ : engine::Vec2{};
    started_ = true;
    last_hip_ = hip;
    return step;
}

/// A tick in contact: after a lift a stroke begins anew.
void StrokeCounter::touch(const engine::TickRecord& tick) noexcept {
    if (tick.time_ns - last_contact_ > kLift) {
        direction_ = 0;
        place_ = low_ = high_ = 0.0;
    }
    last_contact_ = tick.time_ns;
}

void StrokeCounter::add(const engine::TickRecord& tick) noexcept {
    const engine::Vec2 step = step_to(tick);
    if (tick.mode == engine::Mode::free) {
        return;
    }
    touch(tick);
    segment_ = tick.segment >= 0 ? tick.segment : segment_;
    const engine::Vec2 t = along(tick);
    const double length = glm::length(t);
    if (length > 0.0) {
        go(glm::dot(step, t) / length);
    }
}

void StrokeCounter::add_along(const engine::TickRecord& tick, const engine::Vec2& axis) noexcept {
    const engine::Vec2 step = step_to(tick);
    if (tick.mode != engine::Mode::free) {
        touch(tick);
        go(glm::dot(step, axis));
    }
}

void StrokeCounter::go(double step) noexcept {
    place_ += step;
    low_ = std::min(low_, place_);
    high_ = std::max(high_, place_);
    if (direction_ <= 0 && place_ - low_ >= kStroke) {
        count(1);
        high_ = place_;
    } else if (direction_ >= 0 && high_ - place_ >= kStroke) {
        count(-1);
        low_ = place_;
    }
}

void StrokeCounter::count(int direction) noexcept {
    ++strokes_;
    reversals_ += direction_ != 0 ? 1 : 0;
    if (segment_ == 0 || segment_ == 1) {
        ++on_side_[static_cast<std::size_t>(segment_)];
    }
    direction_ = direction;
}

}  // namespace palpate::protocols
