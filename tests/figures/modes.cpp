// Figure 3.1.2: the modes of our law and of the thesis', with how often a run went from one to
// another.
#include "tests/figures/friction_run.hpp"
#include "tests/figures/make.hpp"
#include "tests/figures/svg_diagram.hpp"

namespace palpate::figures {
namespace {

using engine::Mode;

constexpr std::size_t kModes = 4;
/// changes[a][b]: ticks of mode b that follow one of mode a.
using Changes = std::array<std::array<int, kModes>, kModes>;

Changes changes_of(const FrictionRun& run) {
    Changes changes{};
    for (std::size_t i = 1; i < run.size(); ++i) {
        ++changes.at(static_cast<std::size_t>(run[i - 1].mode))
              .at(static_cast<std::size_t>(run[i].mode));
    }
    return changes;
}

/// A transition as it is drawn, by the modes that it joins.
struct Edge {
    Mode from;
    Mode to;
    const char* condition;
    double bend = 0.0;
    double shift_x = 0.0;
    double shift_y = 0.0;
    double loop_x = 0.0;
    double loop_y = -1.0;
};

Transition drawn(const Edge& edge, std::size_t first_node, const Changes& changes) {
    const auto from = static_cast<std::size_t>(edge.from);
    const auto to = static_cast<std::size_t>(edge.to);
    const int times = changes.at(from).at(to);
    const bool loop = from == to;
    return {.from = first_node + from,
            .to = first_node + to,
            .condition = loop || times == 0 ? std::string(edge.condition)
                                            : fmt::format("{}\n{} ×", edge.condition, times),
            .bend = edge.bend,
            .shift_x = edge.shift_x,
            .shift_y = edge.shift_y,
            .ink = loop || times > 0 ? Ink::black : Ink::grey,
            .loop_x = edge.loop_x,
            .loop_y = edge.loop_y};
}

/// Four nodes in the order of engine::Mode, the middle of the group at x.
void add_nodes(Diagram& diagram, double x, Ink ink) {
    diagram.nodes.push_back({"FREE", "F = 0", x - 200.0, 130.0, Ink::grey});
    diagram.nodes.push_back({"STUCK", "GO stands", x + 130.0, 130.0, ink});
    diagram.nodes.push_back({"SLIP", "μ = μ_d", x - 200.0, 430.0, ink});
    diagram.nodes.push_back({"TRANSITION", "μ falls", x + 130.0, 430.0, ink});
}

constexpr std::array<Edge, 9> kOurs{{
    {Mode::free, Mode::stuck, "HIP is inside", 16.0, 0.0, -21.0},
    {Mode::stuck, Mode::free, "F_N ≤ 0", 16.0, 0.0, 18.0},
    {Mode::stuck, Mode::stuck, "μ heals to μ_s", 0.0, 0.0, -14.0},
    {Mode::stuck, Mode::transition, "|F_T| > μ F_N", 26.0, 50.0, 0.0},
    {Mode::transition, Mode::stuck, "|F_T| ≤ μ F_N", 26.0, -52.0, 66.0},
    {Mode::transition, Mode::slip, "(μ - μ_d) / (μ_s - μ_d)\nbelow 1/1000", 0.0, 0.0, 30.0},
    {Mode::slip, Mode::stuck, "|F_T| ≤ μ F_N", 0.0, -46.0, -50.0},
    {Mode::slip, Mode::free, "F_N ≤ 0", 0.0, -36.0, 0.0},
    {Mode::transition, Mode::transition, "GO slides until\n|F_T| = μ F_N", 0.0, 0.0, 24.0, 0.0,
     1.0},
}};

constexpr std::array<Edge, 9> kThesis{{
    {Mode::free, Mode::stuck, "collision", 16.0, 0.0, -21.0},
    {Mode::stuck, Mode::free, "no collision", 16.0, 0.0, 18.0},
    {Mode::stuck, Mode::stuck, "HIP stops or turns: GO := CP", 0.0, 0.0, -14.0},
    {Mode::stuck, Mode::transition, "F_T ≥ μ_s F_N", 26.0, 52.0, 0.0},
    {Mode::transition, Mode::stuck, "the same\nas from SLIP", 26.0, -48.0, 66.0},
    {Mode::transition, Mode::slip, "|Ψ| < ε\n(GO meets CP)", 0.0, 0.0, 30.0},
    {Mode::slip, Mode::stuck,
     "HIP stops or turns, or\nμ_d F_N > μ_s times F_N\nwhen slipping began", 0.0, -72.0, -62.0},
    {Mode::slip, Mode::free, "no\ncollision", 0.0, -36.0, 0.0},
    {Mode::transition, Mode::transition, "μ from Ψ", 0.0, 0.0, 16.0, 0.0, 1.0},
}};

}  // namespace

MadeFigure make_modes() {
    const auto path = friction_path();
    const Changes ours = changes_of(felt_by_gos(path));
    const Changes thesis = changes_of(felt_by_thesis(path, true));
    Diagram diagram{.title = "Figure 3.1.2: modes of friction, ours and the thesis'",
                    .headings = {{300.0, 16.0, "Ours: read off the god-object"},
                                 {890.0, 16.0, "Thesis: switched by conditions (latched reading)"}},
                    .width = 1180.0,
                    .height = 540.0};
    add_nodes(diagram, 300.0, Ink::blue);
    add_nodes(diagram, 890.0, Ink::vermillion);
    for (const Edge& edge : kOurs) {
        diagram.transitions.push_back(drawn(edge, 0, ours));
    }
    for (const Edge& edge : kThesis) {
        diagram.transitions.push_back(drawn(edge, kModes, thesis));
    }
    diagram.caption =
        "Numbers count how often the run of figure 3.2.2 went that way; grey: never. Ours has "
        "one rule, the force is K (GO - HIP) and GO slides only as far as its friction cone "
        "demands; the modes are names for what it did, so no switch can put a step into the "
        "force. The thesis' machine seats GO anew, or adds an offset, at its switches.";
    std::vector<CsvColumn> table{
        {"from_mode", {}}, {"to_mode", {}}, {"gos_ticks", {}}, {"thesis_latched_ticks", {}}};
    for (std::size_t a = 0; a < kModes; ++a) {
        for (std::size_t b = 0; b < kModes; ++b) {
            add_row(table, {static_cast<double>(a), static_cast<double>(b),
                            static_cast<double>(ours.at(a).at(b)),
                            static_cast<double>(thesis.at(a).at(b))});
        }
    }
    return {svg(diagram), {{"", table}}};
}

}  // namespace palpate::figures
