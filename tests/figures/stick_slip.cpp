// Figure 3.3.1: a stick-slip transition in a run of the servo loop with the simulated device and
// hand.
#include "engine/contact/certified_tracker.hpp"
#include "engine/device/simulated_pantograph.hpp"
#include "engine/realtime/servo.hpp"
#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/figures/drawing.hpp"
#include "tests/figures/make.hpp"
#include "tests/support/outlines.hpp"

namespace palpate::figures {
namespace {

using namespace palpate::engine;

constexpr double kTransition = 0.095;  // s: how long the thesis' transition takes
/// tau_slip for it: mu counts as relaxed (Mode::slip) when 1/1000 of mu_s - mu_d is left.
const double kTauSlip = kTransition / std::log(1000.0);
constexpr double kBefore = 0.06;  // s shown before the contact
constexpr double kAfter = 0.15;   // s shown after the transition

std::vector<TickRecord> recorded() {
    const engine::Scene scene(
        stimuli::make_outline({.curvature = 5.0}),
        {.friction = {.mu_s = 0.7, .mu_d = 0.5, .tau_slip = kTauSlip, .tau_heal = 0.1},
         .slew = tests::kStudySlew});
    engine::SimulatedPantograph device({}, kTick);
    engine::VirtualServo servo(
        device, {.limits = {.max_force = 10.0, .ramp_step = engine::ramp_step(0.2, kTick)}});
    device.begin({});
    servo.begin(scene);
    std::vector<TickRecord> ticks;
    std::array<TickRecord, 256> buffer;
    while (!device.hand_is_done() && servo.advance() == engine::ServoStatus::running) {
        while (const std::size_t n = servo.ring().pop(buffer)) {
            ticks.insert(ticks.end(), buffer.begin(),
                         buffer.begin() + static_cast<std::ptrdiff_t>(n));
        }
    }
    servo.end();
    engine::TrackState track;
    for (TickRecord& tick : ticks) {
        if (tick.mode == Mode::free) {  // the servo did not look at each
            tick.go = engine::Vec3(scene.closest(track, engine::Vec2(tick.hip)).point, 0.0);
        }
    }
    return ticks;
}

double time_of(const TickRecord& tick) {
    return 1e-9 * static_cast<double>(tick.time_ns);
}

/// Contact, break-away and relaxed mu, as ticks.
struct Passage {
    std::size_t touch = 0;
    std::size_t release = 0;
    std::size_t relaxed = 0;
};

/// The first contact that sticks, breaks away once and slides on until mu is relaxed.
Passage first_passage(const std::vector<TickRecord>& ticks) {
    Passage at;
    for (std::size_t i = 1; i < ticks.size(); ++i) {
        const Mode before = ticks[i - 1].mode;
        const Mode now = ticks[i].mode;
        if (before == Mode::free && now != Mode::free) {
            at = {.touch = i, .release = 0, .relaxed = 0};
        }
        if (now == Mode::transition && before == Mode::stuck) {
            at.release = i;
        }
        if (now == Mode::slip && before == Mode::transition && at.touch > 0 && at.release > 0) {
            at.relaxed = i;
            return at;
        }
    }
    throw std::runtime_error("the simulated hand made no stick-slip transition");
}

std::vector<TickRecord> window(const std::vector<TickRecord>& ticks, const Passage& at) {
    const auto before = static_cast<std::size_t>(kBefore / kTick);
    const auto after = static_cast<std::size_t>(kAfter / kTick);
    const std::size_t from = at.touch > before ? at.touch - before : 0;
    const std::size_t to = std::min(at.relaxed + after, ticks.size());
    return {ticks.begin() + static_cast<std::ptrdiff_t>(from),
            ticks.begin() + static_cast<std::ptrdiff_t>(to)};
}

/// Friction over time, > 0 where it acts as at the break-away, between the bounds of its cone.
Panel force_panel(const std::vector<TickRecord>& ticks, double sign) {
    constexpr Look kBound{Ink::vermillion, 1.2, Stroke::dashed};
    Panel panel = time_panel("(a) Friction force", "F_T", "N", 240.0);
    panel.series.push_back(over_time(
        "friction", ticks, [sign](const TickRecord& t) { return sign * t.tangential_force; }, {},
        &time_of));
    for (const double side : {1.0, -1.0}) {
        panel.series.push_back(over_time(
            "± μ F_N", ticks, [side](const TickRecord& t) { return side * t.mu * t.normal_force; },
            kBound, &time_of));
    }
    return panel;
}

}  // namespace

MadeFigure make_stick_slip() {
    const std::vector<TickRecord> all = recorded();
    const Passage at = first_passage(all);
    const std::vector<TickRecord> ticks = window(all, at);
    const double t_touch = time_of(all[at.touch]);
    const double t_release = time_of(all[at.release]);
    const double t_relaxed = time_of(all[at.relaxed]);
    const std::vector<Shade> shades{{t_touch, t_release, "stuck", Ink::sky},
                                    {t_release, t_relaxed, "transition", Ink::orange}};
    const double sign = all[at.release].tangential_force < 0.0 ? -1.0 : 1.0;
    Panel force = force_panel(ticks, sign);
    force.shades = shades;
    force.markers = {{t_touch, sign * all[at.touch].tangential_force, "contact"},
                     {t_release, sign * all[at.release].tangential_force, "slips"},
                     {t_relaxed, sign * all[at.relaxed].tangential_force, "relaxed"}};
    Panel mu = time_panel("(b) Coefficient of friction", "μ", "", 150.0);
    mu.y.low = 0.47;
    mu.y.high = 0.73;
    mu.series = {over_time(
        "", ticks, [](const TickRecord& t) { return t.mode == Mode::free ? std::nan("") : t.mu; },
        {}, &time_of)};
    mu.shades = shades;
    Figure figure{.id = "fig_3_3_1",
                  .title = "Figure 3.3.1: a stick-slip transition with the simulated device",
                  .panels = {force, mu},
                  .width = 860.0};
    figure.caption = fmt::format(
        "Ticks recorded from the 1 kHz servo loop with the simulated pantograph (encoder counts, "
        "motor limits) and hand on the convex object of the study, K = 1000 N/m. Contact at "
        "{:.3f} s, break-away at {:.3f} s, μ relaxed at {:.3f} s: the transition takes {:.0f} "
        "ms. tau_slip was set to {:.4g} ms, for which μ falls to a thousandth of its way in "
        "{:.0f} ms, the length of the transition that the thesis shows.",
        t_touch, t_release, t_relaxed, 1e3 * (t_relaxed - t_release), 1e3 * kTauSlip,
        1e3 * kTransition);
    std::vector<CsvColumn> table{
        column("time_s", ticks, &time_of), column("mode", ticks, &TickRecord::mode),
        column("friction_n", ticks, &TickRecord::tangential_force),
        column("normal_n", ticks, &TickRecord::normal_force), column("mu", ticks, &TickRecord::mu)};
    add_vectors(table, "hip", "m", ticks, [](const TickRecord& t) { return Vec2(t.hip); });
    add_vectors(table, "go", "m", ticks, [](const TickRecord& t) { return Vec2(t.go); });
    return {svg(figure), {{"", table}}};
}

}  // namespace palpate::figures
