#pragma once

#include "tests/figures/make.hpp"

/// The figures of the thesis, each computed by a run of the engine: `palpate figures`.
namespace palpate::figures {

/// A figure by the number it has in the thesis.
struct NamedFigure {
    std::string_view name;   ///< "fig_3_2_2"
    std::string_view title;  ///< one line
    MadeFigure (*make)();    ///< the same every time
};

/// All of them, in the order of the thesis.
[[nodiscard]] std::span<const NamedFigure> thesis_figures();

struct FigureFile {
    std::string name{};  ///< "fig_3_2_2.svg"
    std::string text{};
};

/// The files of one figure: its picture and its tables.
[[nodiscard]] std::vector<FigureFile> files_of(const NamedFigure& figure);

}  // namespace palpate::figures
