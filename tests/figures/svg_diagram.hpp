#pragma once

#include "data/plot/figure.hpp"
#include "tests/support/std.hpp"

namespace palpate::figures {

using data::Ink;

/// A state: a box with rounded corners, its middle at (x, y) px from the top left of the drawing.
struct Node {
    std::string name{};
    std::string note{};  ///< a smaller line below the name
    double x = 0.0;
    double y = 0.0;
    Ink ink = Ink::blue;
};

/// A transition. Its line bends `bend` px to the left of its way, 0: straight.
struct Transition {
    std::size_t from = 0;  ///< the same as `to`: a loop on the node
    std::size_t to = 0;
    std::string condition{};  ///< lines parted by "\n", beside the middle of the line
    double bend = 0.0;
    double shift_x = 0.0;  ///< px that the condition is moved
    double shift_y = 0.0;
    Ink ink = Ink::black;
    double width = 1.4;    ///< px
    bool two_way = false;  ///< a head at both ends
    double loop_x = 0.0;   ///< of a loop: the way it leaves the node, 0, 0: upwards
    double loop_y = -1.0;
};

/// Words above a group of nodes.
struct Heading {
    double x = 0.0;
    double y = 0.0;
    std::string text{};
};

/// A finite state machine: nodes and arrows, a caption below.
struct Diagram {
    std::string title{};
    std::vector<Node> nodes{};
    std::vector<Transition> transitions{};
    std::vector<Heading> headings{};
    std::string caption{};
    double width = 760.0;   ///< px
    double height = 420.0;  ///< px, of the drawing alone
    double node_width = 108.0;
    double node_height = 44.0;
};

/// The diagram as a standalone SVG 1.1 text; the same diagram gives the same bytes.
/// @throws std::invalid_argument if a transition names no node, or a size is not above 0
[[nodiscard]] std::string svg(const Diagram& diagram);

}  // namespace palpate::figures
