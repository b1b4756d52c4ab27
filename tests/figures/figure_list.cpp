#include "tests/figures/figure_list.hpp"

namespace palpate::figures {
namespace {

constexpr std::array<NamedFigure, 21> kFigures{{
    {"fig_2_1_2", "Six ways to track the closest point", &make_trackers},
    {"fig_2_1_4", "Voronoi regions of an object of three curves", &make_regions},
    {"fig_2_1_5", "Active Voronoi region along a path", &make_region_flow},
    {"fig_2_1_5_graph", "Which Voronoi regions are neighbours", &make_region_graph},
    {"fig_2_1_6", "Force against penetration depth", &make_press},
    {"fig_2_1_8", "Force while HIP touches an object now and then", &make_touches},
    {"fig_3_1_1", "Friction over speed by models of stiction", &make_law_curves},
    {"fig_3_1_2", "Modes of friction", &make_modes},
    {"fig_3_1_2_patches", "Over the edge of an object of four NURBS surfaces",
     &make_surface_patches},
    {"fig_3_1_4", "Static friction at a corner", &make_corner_hold},
    {"fig_3_2_1", "The pre-determined path", &make_friction_path},
    {"fig_3_2_1_snapshots", "HIP and god-object at moments of the path", &make_friction_moments},
    {"fig_3_2_2", "Friction and total force over the path", &make_friction_forces},
    {"fig_3_2_3", "Coefficient of friction over the path", &make_stribeck},
    {"fig_3_2_4", "Curve parameters of god-object and closest point", &make_places},
    {"fig_3_2_5", "A NURBS surface before and after the collision", &make_surface_collision},
    {"fig_3_2_6", "Trajectory along v of the surface", &make_surface_path},
    {"fig_3_2_7", "Normal and friction force on the surface", &make_surface_forces},
    {"fig_3_3_1", "A stick-slip transition with the simulated device", &make_stick_slip},
    {"fig_4_3_1", "The objects of the study", &make_studied_objects},
    {"fig_4_4_1", "A B-spline curve under a force", &make_deformation},
}};

}  // namespace

std::span<const NamedFigure> thesis_figures() {
    return kFigures;
}

std::vector<FigureFile> files_of(const NamedFigure& figure) {
    const MadeFigure made = figure.make();
    const std::string name(figure.name);
    std::vector<FigureFile> files{{name + ".svg", made.svg}};
    for (const FigureTable& table : made.tables) {
        files.push_back({name + table.suffix + ".csv", csv(table.columns)});
    }
    return files;
}

}  // namespace palpate::figures
