// Figure 2.1.6: force against penetration depth.
#include "engine/rendering/scene.hpp"
#include "tests/figures/drawing.hpp"
#include "tests/figures/make.hpp"

namespace palpate::figures {
namespace {

using engine::Vec2;

constexpr std::array<double, 3> kStiffness{100.0, 500.0, 1000.0};  // N/m
constexpr double kBegin = 0.003;                                   // m outside, to begin with
constexpr double kDeepest = 0.009;                                 // m
constexpr double kSpeed = 0.02;                                    // m/s
constexpr double kAt = 0.45;                                       // u on the first curve

struct Press {
    std::vector<double> t;
    std::vector<double> depth;  ///< m, < 0 outside
    std::vector<double> force;  ///< N
};

/// In along the curve's normal and out again.
Press press(double stiffness) {
    const auto curves = curves_of(three_curves());
    const auto outline = std::make_shared<const engine::Outline>(curves, true);
    const engine::Scene scene(outline, {.stiffness = stiffness, .period = kTick});
    const engine::Jet<2> jet = curves.front().at(kAt);
    const Vec2 normal = engine::perp(jet.first) / glm::length(jet.first);
    const double way = kBegin + kDeepest;
    const int ticks = static_cast<int>(2.0 * way / (kSpeed * kTick) + 0.5);
    engine::ContactState state;
    Press out;
    for (int i = 0; i <= ticks; ++i) {
        const double gone = i * kSpeed * kTick;
        const double below = (gone < way ? gone : 2.0 * way - gone) - kBegin;
        const engine::Contact contact = scene.tick(state, jet.point - below * normal);
        out.t.push_back(i * kTick);
        out.depth.push_back(below);
        out.force.push_back(glm::length(contact.force));
    }
    return out;
}

}  // namespace

MadeFigure make_press() {
    Panel in_time = time_panel("(a) Force over time", "force", "N", 260.0);
    Panel over_depth{.title = "(b) Force against depth",
                     .x = {.label = "penetration depth", .unit = "mm"},
                     .y = {.label = "force", .unit = "N"},
                     .height = 260.0};
    std::vector<CsvColumn> table;
    for (const double stiffness : kStiffness) {
        const Press run = press(stiffness);
        const std::string name = fmt::format("K = {:g} N/m", stiffness);
        in_time.series.push_back({.name = name, .x = run.t, .y = run.force});
        Series line{.name = name, .x = {}, .y = run.force};
        for (const double depth : run.depth) {
            line.x.push_back(kMillimetres * depth);
        }
        over_depth.series.push_back(line);
        if (table.empty()) {
            table = {{"time_s", run.t}, {"depth_m", run.depth}};
        }
        table.push_back({fmt::format("force_at_{:g}_n_per_m_n", stiffness), run.force});
    }
    Figure figure{.id = "fig_2_1_6",
                  .title = "Figure 2.1.6: force against penetration depth",
                  .panels = {in_time, over_depth},
                  .columns = 2,
                  .share_x = false,
                  .width = 900.0};
    figure.caption = fmt::format(
        "HIP goes {:g} mm into the first curve of the object of figure 2.1.4 along its normal, "
        "at {:g} mm/s, and out again; no friction. Outside the force is zero, inside it is the "
        "stiffness times the depth, on the way in as on the way out.",
        kMillimetres * kDeepest, kMillimetres * kSpeed);
    return {svg(figure), {{"", table}}};
}

}  // namespace palpate::figures
