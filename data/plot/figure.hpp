#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// What a figure shows, and its drawing.
namespace palpate::data {

/// Colours that stay apart for colour-blind readers (Okabe & Ito 2008), dark enough on white.
/// `automatic` takes them in turn, a series after the other.
enum class Ink : std::uint8_t {
    automatic,
    blue,
    vermillion,
    green,
    purple,
    orange,
    sky,
    black,
    grey,
};

/// The colour of one of several, by its place among them.
[[nodiscard]] constexpr Ink ink_of(std::size_t place) {
    return static_cast<Ink>(1 + place % 6);
}

enum class Stroke : std::uint8_t { solid, dashed, dotted };

/// What of a series is drawn.
enum class Mark : std::uint8_t { line, points, both };

/// A line, a path or a cloud of points. A value that is not finite (or not above 0 on a log axis)
/// is a gap: the line breaks there.
struct Series {
    std::string name{};  ///< in the legend; empty: not in it
    std::vector<double> x{};
    std::vector<double> y{};  ///< as many
    Ink ink = Ink::automatic;
    Stroke stroke = Stroke::solid;
    Mark mark = Mark::line;
    double width = 1.6;           ///< px
    std::vector<double> sizes{};  ///< radius of each point, px; empty: 3
    double opacity = 1.0;         ///< of the points

    /// One more point; a gap behind the last one.
    void add(double at_x, double at_y) {
        x.push_back(at_x);
        y.push_back(at_y);
    }
    void gap() {
        constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
        add(kNone, kNone);
    }
};

/// An interval: a bar from (x, y) to (to_x, to_y).
[[nodiscard]] inline Series interval_bar(double x, double y, double to_x, double to_y, Ink ink) {
    return {.x = {x, to_x}, .y = {y, to_y}, .ink = ink, .width = 3.0};
}

/// A numbered instant: a dot at (x, y) and its label in a ring beside it, where least is covered.
struct Marker {
    double x = 0.0;
    double y = 0.0;
    std::string label{};  ///< short: "1" to "13"
};

/// An interval of x, shaded from bottom to top.
struct Shade {
    double from = 0.0;
    double to = 0.0;
    std::string name{};  ///< in the legend, once for all shades of this name
    Ink ink = Ink::grey;
};

/// What lies between two lines over the same x, shaded: where a curve may be. Ends where a value is
/// not finite.
struct Band {
    std::vector<double> x{};
    std::vector<double> low{};   ///< as many
    std::vector<double> high{};  ///< as many
    std::string name{};          ///< in the legend, once for all bands of this name
    Ink ink = Ink::grey;
};

/// From (x, y) to (x + dx, y + dy), in the units of the axes.
struct Arrow {
    double x = 0.0;
    double y = 0.0;
    double dx = 0.0;
    double dy = 0.0;
    std::string name{};  ///< in the legend, once for all arrows of this name
    Ink ink = Ink::black;
};

/// Words at a place inside the plot area, in the middle of (x, y).
struct Label {
    double x = 0.0;
    double y = 0.0;
    std::string text{};
    Ink ink = Ink::black;
};

/// What an axis measures.
struct Axis {
    std::string label{};  ///< "time"
    std::string unit{};   ///< "s"; empty for a pure number
    bool log = false;
    std::optional<double> low{};  ///< none: from the data, with a little room
    std::optional<double> high{};
    /// Ticks of an axis that counts things: where, and the name there. Empty: numbers.
    std::vector<std::pair<double, std::string>> names{};
};

/// One pair of axes.
struct Panel {
    std::string title{};
    Axis x;
    Axis y;
    std::vector<Series> series{};
    std::vector<Marker> markers{};
    std::vector<Shade> shades{};
    std::vector<Band> bands{};
    std::vector<Arrow> arrows{};
    std::vector<Label> labels{};
    bool equal_aspect =
        false;              ///< one metre is as long along x as along y; axes are widened to fit
    double height = 220.0;  ///< of the plot area, px, 40 to 4000
};

/// Panels in rows, a caption below. Legends stand above their plot area, so that they cover no
/// data.
struct Figure {
    std::string id = "figure";  ///< begins the ids inside, for several figures in one page
    std::string title{};
    std::vector<Panel> panels{};
    int columns = 1;  ///< panels in a row, 1 to 8
    /// Panels below one another whose x axes have the same label and unit show the same stretch of
    /// x.
    bool share_x = true;
    std::string caption{};  ///< wrapped to the width
    double width = 760.0;   ///< px, 200 to 10000
};

/// The figure as a standalone SVG 1.1 text, without scripts, fonts or files of its own. The same
/// figure gives the same bytes. Points nearer than 0.15 px to the one drawn before are left out of
/// a line.
/// @throws std::invalid_argument: x and y of different length, no panel, an empty or non-positive
///         log range, sizes out of range
[[nodiscard]] std::string svg(const Figure& figure);

}  // namespace palpate::data
