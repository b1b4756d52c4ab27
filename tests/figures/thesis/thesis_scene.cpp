#include "tests/figures/thesis/thesis_scene.hpp"

#include "engine/base/text.hpp"

namespace palpate::figures {
namespace {

const ThesisSpec& checked(const ThesisSpec& spec) {
    if (!(std::isfinite(spec.period) && spec.period > 0.0)) {
        throw std::invalid_argument("tick period is " + number_text(spec.period) +
                                    ": give seconds above 0");
    }
    if (spec.law > ThesisLaw::latched) {
        throw std::invalid_argument("the law has number " +
                                    std::to_string(static_cast<int>(spec.law)) +
                                    ": give frictionless, literal or latched");
    }
    return spec;
}

std::vector<CurveTracker> trackers_of(const std::vector<NurbsCurve<2>>& segments,
                                      const TrackerSpec& spec) {
    std::vector<CurveTracker> trackers;
    trackers.reserve(segments.size());
    for (const auto& segment : segments) {
        trackers.emplace_back(segment, spec);
    }
    return trackers;
}

Algorithm1Spec friction_of(const ThesisSpec& spec) {
    return {.variant = spec.law == ThesisLaw::latched ? Algorithm1Variant::latched
                                                      : Algorithm1Variant::literal,
            .stiffness = spec.stiffness,
            .mu_s = spec.mu_s,
            .mu_d = spec.mu_d,
            .epsilon = spec.epsilon,
            .dead_band = spec.dead_band};
}

bool usable(const Vec2& hip) noexcept {
    return std::fabs(hip.x) <= engine::kMaxCoordinate &&
           std::fabs(hip.y) <= engine::kMaxCoordinate;  // NaN: false
}

}  // namespace

ThesisScene::ThesisScene(std::vector<NurbsCurve<2>> segments, bool closed, const ThesisSpec& spec)
    : spec_(checked(spec)),
      trackers_(trackers_of(segments, spec.tracker)),
      releases_(trackers_of(segments, spec.release.value_or(spec.tracker))),
      regions_(segments, closed, spec.region),
      friction_(friction_of(spec)) {}

ThesisScene::Feet ThesisScene::track(ThesisState& state, const Vec2& hip) const noexcept {
    Feet feet;
    for (std::size_t i = 0; i < trackers_.size(); ++i) {
        if (!state.started) {
            state.cp[i] = trackers_[i].start(hip);
        }
        feet[i] = trackers_[i].step(state.cp[i], hip, spec_.period);
    }
    return feet;
}

void ThesisScene::seat(ThesisState& state,
                       std::size_t segment,
                       const TrackedFoot& foot) const noexcept {
    state.go_segment = segment;
    state.go_u = foot.u;
    state.go = {.point = foot.point, .tangent = foot.tangent, .normal = foot.normal};
    state.release = releases_[segment].start_at(foot.u);
}

/// The released GO: one step of its own tracker. HIP in another region: it starts from the end
/// there.
void ThesisScene::follow(ThesisState& state, const Vec2& hip) const noexcept {
    if (state.go_segment != state.active) {
        const NurbsCurve<2>& curve = releases_[state.active].curve();
        state.release = regions_.after(state.go_segment) == state.active
                          ? releases_[state.active].start_at(curve.front())
                      : regions_.before(state.go_segment) == state.active
                          ? releases_[state.active].start_at(curve.back())
                          : releases_[state.active].start(hip);
        state.go_segment = state.active;
    }
    const TrackedFoot foot = releases_[state.active].step(state.release, hip, spec_.period);
    state.go_u = foot.u;
    state.go = {.point = foot.point, .tangent = foot.tangent, .normal = foot.normal};
}

void ThesisScene::end_contact(ThesisState& state,
                              const TrackedFoot& cp,
                              const Vec2& velocity) const noexcept {
    state.touching = false;
    friction_.no_contact(state.friction, velocity);
    seat(state, state.active, cp);
}

ThesisTick ThesisScene::tick(ThesisState& state, const Vec2& hip) const noexcept {
    if (!usable(hip)) {
        state = {};
        return {.refused = true};
    }
    const Vec2 velocity = state.started ? (hip - state.last_hip) / spec_.period : Vec2{0.0, 0.0};
    const Feet tracked = track(state, hip);
    const std::span<const TrackedFoot> feet(tracked.data(), trackers_.size());

    const bool first = !state.started;
    state.started = true;
    state.last_hip = hip;
    const std::size_t nearest = regions_.nearest(state.active, feet, hip, !state.touching);
    if (first || (!state.touching && regions_.rule() == RegionRule::nearest_feature)) {
        state.active = nearest;
    } else {
        state.active = regions_.next(state.active, feet, hip, state.friction.locked);
    }
    const TrackedFoot& cp = feet[state.active];
    ThesisTick out{.cp_segment = state.active, .cp_u = cp.u, .cp = cp.point};

    if (!regions_.inside(nearest, feet, hip)) {
        end_contact(state, cp, velocity);
    } else if (spec_.law == ThesisLaw::frictionless) {
        state.touching = true;
        seat(state, state.active, cp);
        out.mode = Mode::slip;
        out.force = spec_.stiffness * (cp.point - hip);
        out.fn = glm::dot(out.force, cp.normal);
        out.ft = glm::dot(out.force, cp.tangent);
        out.psi = cp.psi;
    } else {
        state.touching = true;
        if (state.friction.dynamic) {
            follow(state, hip);
        } else if (state.friction.seat) {
            seat(state, state.active, cp);
            state.friction.seat = false;
        }
        const Algorithm1Force f = friction_.contact(state.friction, state.go, hip, velocity);
        if (f.fn > 0.0) {
            out.mode = f.mode;
            out.force = f.force;
            out.fn = f.fn;
            out.ft = f.ft;
            out.mu = f.mu;
            out.psi = f.psi;
        } else {
            end_contact(state, cp, velocity);  // GO's own normal carries nothing any more
        }
    }
    out.segment = state.go_segment;
    out.u = state.go_u;
    out.go = state.go.point;
    return out;
}

}  // namespace palpate::figures
