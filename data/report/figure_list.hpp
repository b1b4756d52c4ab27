#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "data/csv/csv.hpp"

/// The figures of the thesis, each computed by a run of the engine: `palpate figures`.
namespace palpate::data {

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

}  // namespace palpate::data
