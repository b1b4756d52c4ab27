#include "tests/figures/svg_diagram.hpp"

#include "data/plot/svg_panel.hpp"

namespace palpate::figures {
namespace {

using namespace palpate::data;

constexpr double kEdge = 10.0;         // px round the whole figure
constexpr double kCaptionLine = 16.0;  // px
constexpr double kHead = 8.0;          // px, length of an arrow's head
constexpr double kTitle = 21.0;        // px from one line of the title to the next

struct Spot {
    double x = 0.0;
    double y = 0.0;
};

Spot towards(const Spot& from, const Spot& to) {
    const double dx = to.x - from.x;
    const double dy = to.y - from.y;
    const double length = std::sqrt(dx * dx + dy * dy);
    return length > 0.0 ? Spot{dx / length, dy / length} : Spot{1.0, 0.0};
}

/// Where the ray from the middle of a node along `way` leaves its box.
Spot rim(const Diagram& d, const Node& node, const Spot& way) {
    const double across = 0.5 * d.node_width / std::max(std::fabs(way.x), 1e-9);
    const double along = 0.5 * d.node_height / std::max(std::fabs(way.y), 1e-9);
    const double reach = std::min(across, along) + 2.0;
    return {node.x + reach * way.x, node.y + reach * way.y};
}

std::string head(const Spot& tip, const Spot& way, std::string_view ink) {
    const Spot neck{tip.x - kHead * way.x, tip.y - kHead * way.y};
    return fmt::format("<path d=\"M{} {}L{} {}L{} {}z\" fill=\"{}\"/>\n", px(tip.x), px(tip.y),
                       px(neck.x - 0.45 * kHead * way.y), px(neck.y + 0.45 * kHead * way.x),
                       px(neck.x + 0.45 * kHead * way.y), px(neck.y - 0.45 * kHead * way.x), ink);
}

std::string words(const std::string& text, double x, double y, std::string_view ink) {
    const std::vector<std::string> lines = wrapped(text, 1e9, kTextSize);
    std::string out;
    double at = y - 0.5 * kLine * (static_cast<double>(lines.size()) - 1.0);
    for (const std::string& line : lines) {
        const double width = text_width(line, kTextSize);
        if (!line.empty()) {
            out += fmt::format(
                "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#ffffff\" "
                "fill-opacity=\"0.85\"/>\n",
                px(x - width / 2.0), px(at - 8.0), px(width), px(kLine - 1.0));
            out += svg_text(x, at + 4.0, line, kTextSize, Anchor::middle,
                            fmt::format("fill=\"{}\"", ink));
        }
        at += kLine;
    }
    return out;
}

/// Line and heads of a transition in `lines`, its condition in `texts`: texts lie above all lines.
void draw(const Diagram& d, const Transition& t, std::string& lines, std::string& texts) {
    const Node& a = d.nodes[t.from];
    const Node& b = d.nodes[t.to];
    const std::string_view ink = colour(t.ink, 6);
    Spot start;
    Spot end;
    Spot middle;
    std::string path;
    Spot way_in;
    if (t.from == t.to) {
        const Spot out = towards({}, {t.loop_x, t.loop_y});
        const Spot side{-out.y, out.x};
        const auto turned = [&](double s) {
            return towards({}, {out.x + s * side.x, out.y + s * side.y});
        };
        start = rim(d, a, turned(-0.35));
        end = rim(d, a, turned(0.35));
        const Spot c1{start.x + 46.0 * turned(-0.5).x, start.y + 46.0 * turned(-0.5).y};
        const Spot c2{end.x + 46.0 * turned(0.5).x, end.y + 46.0 * turned(0.5).y};
        way_in = towards(c2, end);
        path =
            fmt::format("M{} {}C{} {} {} {} {} {}", px(start.x), px(start.y), px(c1.x), px(c1.y),
                        px(c2.x), px(c2.y), px(end.x - 6.0 * way_in.x), px(end.y - 6.0 * way_in.y));
        middle = {0.125 * (start.x + end.x) + 0.375 * (c1.x + c2.x),
                  0.125 * (start.y + end.y) + 0.375 * (c1.y + c2.y)};
    } else {
        const Spot way = towards({a.x, a.y}, {b.x, b.y});
        const Spot knee{0.5 * (a.x + b.x) + 2.0 * t.bend * way.y,
                        0.5 * (a.y + b.y) - 2.0 * t.bend * way.x};
        const Spot out = towards({a.x, a.y}, knee);
        start = rim(d, a, out);
        const Spot back = towards({b.x, b.y}, knee);
        end = rim(d, b, back);
        way_in = {-back.x, -back.y};
        path = fmt::format("M{} {}Q{} {} {} {}", px(start.x), px(start.y), px(knee.x), px(knee.y),
                           px(end.x - 6.0 * way_in.x), px(end.y - 6.0 * way_in.y));
        middle = {0.25 * (start.x + end.x) + 0.5 * knee.x, 0.25 * (start.y + end.y) + 0.5 * knee.y};
        if (t.two_way) {
            lines += head(start, {-out.x, -out.y}, ink);
        }
    }
    lines += fmt::format(
        "<path class=\"transition\" d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\"/>\n",
        path, ink, t.width);
    lines += head(end, way_in, ink);
    if (!t.condition.empty()) {
        texts += words(t.condition, middle.x + t.shift_x, middle.y + t.shift_y, ink);
    }
}

std::string draw(const Diagram& d, const Node& node) {
    const std::string_view ink = colour(node.ink, 0);
    std::string out = fmt::format(
        "<rect x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{3}\" rx=\"10\" fill=\"#ffffff\"/>"
        "<rect class=\"node\" x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{3}\" rx=\"10\" "
        "fill=\"{4}\" fill-opacity=\"0.12\" stroke=\"{4}\" stroke-width=\"1.8\"/>\n",
        px(node.x - d.node_width / 2.0), px(node.y - d.node_height / 2.0), px(d.node_width),
        px(d.node_height), ink);
    const bool noted = !node.note.empty();
    out += svg_text(node.x, node.y + (noted ? -2.0 : 5.0), node.name, kTitleSize, Anchor::middle,
                    "font-weight=\"bold\"");
    if (noted) {
        out += svg_text(node.x, node.y + 13.0, node.note, 10.0, Anchor::middle);
    }
    return out;
}

void check(const Diagram& d) {
    if (!(d.width > 0.0 && d.height > 0.0 && d.node_width > 0.0 && d.node_height > 0.0)) {
        throw std::invalid_argument(
            fmt::format("a diagram of {} x {} px with nodes of {} x {} px: give sizes above 0",
                        d.width, d.height, d.node_width, d.node_height));
    }
    for (const Transition& t : d.transitions) {
        if (t.from >= d.nodes.size() || t.to >= d.nodes.size()) {
            throw std::invalid_argument(
                fmt::format("a transition goes from node {} to node {}: there are {}, from 0",
                            t.from, t.to, d.nodes.size()));
        }
    }
}

}  // namespace

std::string svg(const Diagram& diagram) {
    check(diagram);
    std::string titles;
    double top = kEdge;
    for (const std::string& line : wrapped(diagram.title, diagram.width - 2.0 * kEdge, 15.0)) {
        titles += svg_text(kEdge, top + 14.0, line, 15.0, Anchor::start, "font-weight=\"bold\"");
        top += kTitle;
    }
    std::string lines;
    std::string texts;
    std::string nodes;
    for (const Transition& t : diagram.transitions) {
        draw(diagram, t, lines, texts);
    }
    for (const Node& node : diagram.nodes) {
        nodes += draw(diagram, node);
    }
    for (const Heading& h : diagram.headings) {
        texts += svg_text(h.x, h.y, h.text, kTitleSize, Anchor::middle, "font-weight=\"bold\"");
    }
    double y = top + diagram.height;
    std::string caption;
    for (const std::string& line : wrapped(diagram.caption, diagram.width - 2.0 * kEdge, 12.0)) {
        caption += svg_text(kEdge, y + 10.0, line, 12.0, Anchor::start, "class=\"caption\"");
        y += kCaptionLine;
    }
    y += kEdge;
    return fmt::format(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"{0}\" "
               "height=\"{1}\" viewBox=\"0 0 {0} {1}\" role=\"img\" "
               "font-family=\"DejaVu Sans, Verdana, Arial, sans-serif\">\n<title>{2}</title>\n"
               "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
               px(diagram.width), px(y), xml_escaped(diagram.title)) +
           titles + fmt::format("<g transform=\"translate(0 {})\">\n", px(top)) + lines + nodes +
           texts + "</g>\n" + caption + "</svg>\n";
}

}  // namespace palpate::figures
