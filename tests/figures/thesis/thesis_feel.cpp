#include "ui/cli/scene_tools.hpp"
#include "tests/figures/thesis/thesis_scene.hpp"

namespace palpate::figures {
namespace {

using namespace palpate::protocols;

/// The thesis' trackers stand in the order of TrackerKind behind the certified one, for which two
/// steps of Newton are the nearest that its renderer knows.
TrackerSpec tracker_of(const protocols::SceneRenderer& renderer) {
    if (renderer.certified()) {
        return {.kind = TrackerKind::newton, .iterations = 2};
    }
    return {.kind = static_cast<TrackerKind>(static_cast<int>(renderer.tracker) - 1),
            .gain = renderer.gain,
            .sub_steps = renderer.sub_steps,
            .rate_hz = renderer.rate_hz,
            .iterations = renderer.iterations};
}
static_assert(static_cast<int>(Tracker::newton) - 1 == static_cast<int>(TrackerKind::newton));

ThesisSpec thesis_spec(const SceneFile& file, double period) {
    const std::string& law = file.friction.law;
    return {.stiffness = file.renderer.stiffness,
            .period = period,
            .tracker = tracker_of(file.renderer),
            .law = law == "thesis_literal" ? ThesisLaw::literal
                 : law == "thesis_latched" ? ThesisLaw::latched
                                           : ThesisLaw::frictionless,
            .mu_s = file.friction.set.mu_s,
            .mu_d = file.friction.set.mu_d,
            .dead_band = file.friction.dead_band};
}

}  // namespace

/// Declared by ui/cli/main.cpp, which hands it to `palpate render`.
ui::PlaneFeel thesis_feel(const SceneFile& file, double period) {
    const bool closed = protocols::outline_of(file).closed();
    const auto scene =
        std::make_shared<const ThesisScene>(file.curves, closed, thesis_spec(file, period));
    return [scene, state = ThesisState{}](const Vec2& hip, double /*period*/) mutable {
        const ThesisTick t = scene->tick(state, hip);
        return ui::PlaneTick{.mode = t.mode,
                             .place = {t.cp_segment, t.cp_u},
                             .cp = t.cp,
                             .go = t.go,
                             .fn = t.fn,
                             .ft = t.ft,
                             .force = t.force};
    };
}

}  // namespace palpate::figures
