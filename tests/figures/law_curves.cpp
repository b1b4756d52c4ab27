// Figure 3.1.1: friction over speed by a stiction model, sharp and with the Stribeck effect, as
// runs on a line measure it.
#include "engine/rendering/scene.hpp"
#include "tests/figures/drawing.hpp"
#include "tests/figures/friction_run.hpp"
#include "tests/figures/make.hpp"

namespace palpate::figures {
namespace {

constexpr double kPullDepth = 0.005;    // m below the line
constexpr double kPullWay = 0.02;       // m along it, at one speed
constexpr double kPullStribeck = 0.01;  // m/s, of the law from the literature
constexpr double kPullSlowest = 1e-4;   // m/s
constexpr double kPullFastest = 0.1;    // m/s
constexpr int kPullSpeeds = 60;

struct Pulled {
    double static_share = 0.0;   ///< largest F_T / F_N on the way
    double dynamic_share = 0.0;  ///< at its end
};

/// HIP at `speed` along a line, constantly deep: friction over load.
Pulled pulled(const engine::SceneSpec& spec, double speed) {
    const auto line = tests::polyline({{-1.0, 0.0}, {1.0, 0.0}});
    const engine::Scene scene(line, spec);
    engine::ContactState state;
    Pulled out;
    // Long enough for the slowest spring to give way, and for mu to relax.
    const double seconds = std::max(kPullWay / speed, 0.5);
    for (int i = 0; i * kTick <= seconds; ++i) {
        const engine::Contact contact = scene.tick(state, {i * kTick * speed, -kPullDepth});
        const double share = contact.normal_force > 0.0
                               ? std::fabs(contact.tangential_force) / contact.normal_force
                               : 0.0;
        out.static_share = std::max(out.static_share, share);
        out.dynamic_share = share;
    }
    return out;
}

engine::SceneSpec pull_spec(const engine::LawTraits* kind) {
    engine::SceneSpec spec{.stiffness = kFrictionStiffness,
                           .period = kTick,
                           .friction = {.mu_s = kFrictionStatic, .mu_d = kFrictionDynamic}};
    spec.law.traits = kind;
    spec.law.stribeck_speed = kPullStribeck;
    return spec;
}

}  // namespace

MadeFigure make_law_curves() {
    std::vector<double> speeds;
    for (int i = 0; i < kPullSpeeds; ++i) {
        speeds.push_back(kPullSlowest *
                         std::pow(kPullFastest / kPullSlowest, i / (kPullSpeeds - 1.0)));
    }
    std::vector<CsvColumn> table{{"speed_m_per_s", speeds}};
    Figure figure{.id = "fig_3_1_1",
                  .title = "Figure 3.1.1: friction over speed by models of stiction",
                  .columns = 2,
                  .share_x = false,
                  .width = 940.0};
    const auto panel = [&](std::string title, const engine::SceneSpec& spec, const char* name) {
        Panel made{.title = std::move(title),
                   .x = {.label = "speed of HIP", .unit = "mm/s", .log = true},
                   .y = {.label = "F_T / F_N", .unit = "", .low = 0.0, .high = 0.8},
                   .height = 240.0};
        Series moving{.name = "while it slides"};
        Series largest{.name = "at break-away", .ink = Ink::vermillion, .stroke = Stroke::dashed};
        for (const double speed : speeds) {
            const Pulled one = pulled(spec, speed);
            moving.add(kMillimetres * speed, one.dynamic_share);
            largest.add(kMillimetres * speed, one.static_share);
        }
        made.series = {moving, largest};
        table.push_back({fmt::format("{}_sliding", name), moving.y});
        table.push_back({fmt::format("{}_breakaway", name), largest.y});
        figure.panels.push_back(made);
    };
    panel("(a) Stiction", pull_spec(nullptr), "stiction");
    panel("(b) Stiction with the Stribeck effect", pull_spec(engine::law_named("stribeck")),
          "stribeck");
    figure.caption = fmt::format(
        "HIP is drawn along a line, {:g} mm deep, at one speed after the other: what friction is "
        "of the load at break-away, and when it slides steadily. (a) Our law with a sharp drop: "
        "mu_s = {:g}, then mu_d = {:g} at any speed. (b) The law of stribeck, v_s = {:g} mm/s: "
        "friction falls with speed, and has no force of its own at rest.",
        kMillimetres * kPullDepth, kFrictionStatic, kFrictionDynamic, kMillimetres * kPullStribeck);
    return {svg(figure), {{"", table}}};
}

}  // namespace palpate::figures
