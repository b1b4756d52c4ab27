#pragma once

#include "tests/figures/csv.hpp"

/// One function a figure; what it shows stands in its caption.
namespace palpate::figures {

/// A table of what a figure shows. Numbers for words: mode 0 free, 1 stuck, 2 slip, 3 transition
/// (engine::Mode); segments and regions count from 0 in the direction of travel.
struct FigureTable {
    std::string suffix{};  ///< of the file's name, for a figure with several tables
    std::vector<CsvColumn> columns{};
};

struct MadeFigure {
    std::string svg{};
    std::vector<FigureTable> tables{};
};

[[nodiscard]] MadeFigure make_trackers();           ///< 2.1.2
[[nodiscard]] MadeFigure make_regions();            ///< 2.1.4
[[nodiscard]] MadeFigure make_region_flow();        ///< 2.1.5, active region over time
[[nodiscard]] MadeFigure make_region_graph();       ///< 2.1.5, which region lies beside which
[[nodiscard]] MadeFigure make_press();              ///< 2.1.6
[[nodiscard]] MadeFigure make_touches();            ///< 2.1.8
[[nodiscard]] MadeFigure make_law_curves();         ///< 3.1.1
[[nodiscard]] MadeFigure make_modes();              ///< 3.1.2
[[nodiscard]] MadeFigure make_surface_patches();    ///< several surfaces, 2.1.4 and 3.1.2
[[nodiscard]] MadeFigure make_corner_hold();        ///< 3.1.4
[[nodiscard]] MadeFigure make_friction_path();      ///< 3.2.1 (a)
[[nodiscard]] MadeFigure make_friction_moments();   ///< 3.2.1 (b) to (l)
[[nodiscard]] MadeFigure make_friction_forces();    ///< 3.2.2
[[nodiscard]] MadeFigure make_stribeck();           ///< 3.2.3
[[nodiscard]] MadeFigure make_places();             ///< 3.2.4
[[nodiscard]] MadeFigure make_surface_collision();  ///< 3.2.5
[[nodiscard]] MadeFigure make_surface_path();       ///< 3.2.6
[[nodiscard]] MadeFigure make_surface_forces();     ///< 3.2.7
[[nodiscard]] MadeFigure make_stick_slip();         ///< 3.3.1
[[nodiscard]] MadeFigure make_studied_objects();    ///< 4.3.1
[[nodiscard]] MadeFigure make_deformation();        ///< 4.4.1

}  // namespace palpate::figures
