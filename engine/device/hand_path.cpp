#include "engine/device/hand_path.hpp"

#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

constexpr double kTremorHz = 9.0;
/// Share of a chord left out at A and at B, so that the hand stays on the two curves.
constexpr double kMargin = 0.12;
/// Clearance above the chord on the way down and up again, m: above every sagitta of the study.
constexpr double kClearance = 0.015;
/// How far beyond the vertex a stroke aims, m: more than friction and tremor hold the hand back.
constexpr double kOvershoot = 0.012;
/// Share of the chord below the vertex where the hand comes down on the other side.
constexpr double kLanding = 0.3;

Vec2 outward(const Vec2& from, const Vec2& to) {
    return perp((to - from) / glm::length(to - from));
}

}  // namespace

HandPath::HandPath(const Exploration& plan) : plan_(plan) {
    const Vec2 out_1 = outward(plan.a, plan.vertex);
    const Vec2 out_2 = outward(plan.vertex, plan.b);
    const Vec2 along_1 = -perp(out_1);  // unit, A to V
    const Vec2 along_2 = -perp(out_2);  // unit, V to B
    const Vec2 press_1 = -plan.press_depth * out_1;
    const Vec2 press_2 = -plan.press_depth * out_2;
    const Vec2 on_1 = plan.a + kMargin * (plan.vertex - plan.a);
    const Vec2 on_2 = plan.b + kMargin * (plan.vertex - plan.b);

    // Up one side, over the vertex into the open, down on the other side: no hand goes through a
    // tip.
    const Vec2 over_1 = plan.vertex + press_1 + kOvershoot * along_1;
    const Vec2 over_2 = plan.vertex + press_2 - kOvershoot * along_2;
    const Vec2 landing_1 = plan.vertex + kLanding * (plan.a - plan.vertex) + press_1;
    const Vec2 landing_2 = plan.vertex + kLanding * (plan.b - plan.vertex) + press_2;

    std::vector<Vec2> corners{plan.start, on_1 + kClearance * out_1, on_1 + press_1};
    for (int i = 0; i < plan.sweeps; ++i) {
        const bool towards_b = i % 2 == 0;
        corners.push_back(towards_b ? over_1 : over_2);
        corners.push_back(towards_b ? landing_2 : landing_1);
        corners.push_back(towards_b ? on_2 + press_2 : on_1 + press_1);
    }
    const bool at_b = plan.sweeps % 2 == 1;
    corners.push_back(at_b ? on_2 + kClearance * out_2 : on_1 + kClearance * out_1);

    way_ = TimedWay<2>(std::move(corners), plan.speed);
}

HandPath::Intention HandPath::at(double t) const noexcept {
    return at(t, t)[0];
}

std::array<HandPath::Intention, 2> HandPath::at(double t, double later) const noexcept {
    const auto phase = [this](double at) {
        return 2.0 * kPi * kTremorHz * at + plan_.tremor_phase;
    };
    std::array<Intention, 2> now{way_.at(t), way_.at(later)};
    const auto [first, second] = sin_cos(phase(t), phase(later));
    now[0].position += plan_.tremor * Vec2{first.sin, first.cos};
    now[1].position += plan_.tremor * Vec2{second.sin, second.cos};
    return now;
}

}  // namespace palpate::engine
