// What a panel draws inside its axes: lines, points, arrows and numbered markers.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "data/plot/svg_panel.hpp"
#include "data/plot/svg_text.hpp"

namespace palpate::data {
namespace {

constexpr double kNearest = 0.15;  // px: a point nearer to the last one drawn changes no pixel
constexpr double kRing = 8.0;      // px, radius of a marker's label

double distance(double ax, double ay, double bx, double by) {
    return std::sqrt((ax - bx) * (ax - bx) + (ay - by) * (ay - by));
}

}  // namespace

PanelPlan::Point PanelPlan::place(double x, double y, const Rect& plot) const {
    // Far outside of given axes a coordinate may be huge: SVG readers keep few digits.
    const auto share = [](const AxisRange& range, double v) {
        return std::clamp(range.share(v), -100.0, 101.0);
    };
    return {plot.x + plot.width * share(x_, x), plot.y + plot.height * (1.0 - share(y_, y))};
}

std::string PanelPlan::line(const Series& series, std::string_view ink, const Rect& plot) const {
    std::string path;
    Point drawn;
    Point skipped;
    bool open = false;     // a run is being drawn
    bool pending = false;  // its last point was skipped so far
    int length = 0;
    const auto put = [&](const Point& p, char command) {
        path += fmt::format("{}{} {}", command, px(p.x), px(p.y));
        drawn = p;
        ++length;
    };
    const auto finish = [&] {
        if (pending) {
            put(skipped, 'L');
        }
        if (open && length == 1) {
            path += "h0";  // a lone point between gaps: a dot, by the round cap
        }
        open = pending = false;
    };
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        if (!x_.holds(series.x[i]) || !y_.holds(series.y[i])) {
            finish();
            continue;
        }
        const Point p = place(series.x[i], series.y[i], plot);
        if (!open) {
            length = 0;
            put(p, 'M');
            open = true;
        } else if (distance(p.x, p.y, drawn.x, drawn.y) < kNearest) {
            skipped = p;
            pending = true;
        } else {
            put(p, 'L');
            pending = false;
        }
    }
    finish();
    if (path.empty()) {
        return "";
    }
    return fmt::format(
        "<path class=\"series\" d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\" "
        "stroke-linejoin=\"round\" stroke-linecap=\"round\"{}/>\n",
        path, ink, series.width,
        series.stroke == Stroke::dashed   ? " stroke-dasharray=\"6 4\""
        : series.stroke == Stroke::dotted ? " stroke-dasharray=\"0.1 4\""
                                          : "");
}

std::string PanelPlan::points(const Series& series, std::string_view ink, const Rect& plot) const {
    std::string out;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        if (x_.holds(series.x[i]) && y_.holds(series.y[i])) {
            const Point p = place(series.x[i], series.y[i], plot);
            out += fmt::format(
                "<circle class=\"point\" cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"{}/>\n", px(p.x),
                px(p.y), series.sizes.empty() ? "3" : px(series.sizes[i]), ink,
                series.opacity < 1.0 ? fmt::format(" fill-opacity=\"{:g}\"", series.opacity) : "");
        }
    }
    return out;
}

std::string PanelPlan::band(const Band& shaded, const Rect& plot) const {
    std::string there;
    std::string back;
    std::string path;
    const auto finish = [&] {
        path += there.empty() ? "" : "M" + there.substr(1) + back + "z";
        there.clear();
        back.clear();
    };
    for (std::size_t i = 0; i < shaded.x.size(); ++i) {
        if (!x_.holds(shaded.x[i]) || !y_.holds(shaded.low[i]) || !y_.holds(shaded.high[i])) {
            finish();
            continue;
        }
        const Point low = place(shaded.x[i], shaded.low[i], plot);
        const Point high = place(shaded.x[i], shaded.high[i], plot);
        there += fmt::format("L{} {}", px(high.x), px(high.y));
        back.insert(0, fmt::format("L{} {}", px(low.x), px(low.y)));
    }
    finish();
    return path.empty()
             ? ""
             : fmt::format("<path class=\"band\" d=\"{}\" fill=\"{}\" fill-opacity=\"0.18\"/>\n",
                           path, colour(shaded.ink, 7));
}

std::string PanelPlan::arrows(const Rect& plot) const {
    std::string out;
    for (const Arrow& arrow : panel_->arrows) {
        const double end_x = arrow.x + arrow.dx;
        const double end_y = arrow.y + arrow.dy;
        if (!x_.holds(arrow.x) || !y_.holds(arrow.y) || !x_.holds(end_x) || !y_.holds(end_y)) {
            continue;
        }
        const Point from = place(arrow.x, arrow.y, plot);
        const Point to = place(end_x, end_y, plot);
        const double length = distance(from.x, from.y, to.x, to.y);
        if (length < 0.5) {
            continue;
        }
        const double head = std::min(7.0, 0.5 * length);
        const double ux = (to.x - from.x) / length;
        const double uy = (to.y - from.y) / length;
        const Point neck{to.x - head * ux, to.y - head * uy};
        const std::string_view ink = colour(arrow.ink, 6);
        out += fmt::format(
            "<path class=\"arrow\" d=\"M{} {}L{} {}\" stroke=\"{}\" stroke-width=\"1.4\"/><path "
            "d=\"M{} {}L{} {}L{} {}z\" fill=\"{}\"/>\n",
            px(from.x), px(from.y), px(neck.x), px(neck.y), ink, px(to.x), px(to.y),
            px(neck.x - 0.45 * head * uy), px(neck.y + 0.45 * head * ux),
            px(neck.x + 0.45 * head * uy), px(neck.y - 0.45 * head * ux), ink);
    }
    return out;
}

std::string PanelPlan::labels(const Rect& plot) const {
    std::string out;
    for (const Label& label : panel_->labels) {
        if (x_.holds(label.x) && y_.holds(label.y)) {
            const Point at = place(label.x, label.y, plot);
            out += svg_text(at.x, at.y + 0.35 * kTitleSize, label.text, kTitleSize, Anchor::middle,
                            fmt::format("fill=\"{}\" font-weight=\"bold\"", colour(label.ink, 6)));
        }
    }
    return out;
}

/// What labels should not cover: points of the lines, 4 px apart at most.
std::vector<PanelPlan::Point> PanelPlan::ink(const Rect& plot) const {
    std::vector<Point> ink;
    for (const Series& series : panel_->series) {
        Point last{-1e9, -1e9};
        for (std::size_t i = 0; i < series.x.size(); ++i) {
            if (x_.holds(series.x[i]) && y_.holds(series.y[i])) {
                const Point p = place(series.x[i], series.y[i], plot);
                const double gap = distance(p.x, p.y, last.x, last.y);
                // Long chords are filled, so that a label does not sit on the middle of one.
                const int steps = i > 0 && series.mark != Mark::points && gap < 4000.0
                                    ? static_cast<int>(gap / 4.0)
                                    : 0;
                for (int k = 1; k < steps; ++k) {
                    const double s = static_cast<double>(k) / steps;
                    ink.push_back({last.x + s * (p.x - last.x), last.y + s * (p.y - last.y)});
                }
                if (gap >= 2.0) {
                    ink.push_back(p);
                    last = p;
                }
            }
        }
    }
    return ink;
}

/// Labels go where they cover least: of 32 places round the dot the one with the fewest points of
/// lines, other labels and dots under it, the nearest first.
PanelPlan::Point PanelPlan::label_place(const Point& dot,
                                        const std::vector<Point>& ink,
                                        const std::vector<Point>& dots,
                                        const std::vector<Point>& labels,
                                        const Rect& plot) {
    constexpr std::array<Point, 8> kRound{{{0.0, -1.0},
                                           {0.7071, -0.7071},
                                           {-0.7071, -0.7071},
                                           {1.0, 0.0},
                                           {-1.0, 0.0},
                                           {0.0, 1.0},
                                           {0.7071, 0.7071},
                                           {-0.7071, 0.7071}}};
    Point best;
    double least = 1e300;
    for (const double far : {16.0, 22.0, 30.0, 40.0}) {
        for (const Point& way : kRound) {
            const Point at{dot.x + far * way.x, dot.y + far * way.y};
            double cost = 0.2 * far;
            for (const Point& p : ink) {
                cost += distance(p.x, p.y, at.x, at.y) < kRing + 3.0 ? 4.0 : 0.0;
            }
            for (const Point& p : dots) {
                cost += distance(p.x, p.y, at.x, at.y) < kRing + 4.0 ? 30.0 : 0.0;
            }
            for (const Point& p : labels) {
                cost += distance(p.x, p.y, at.x, at.y) < 2.0 * kRing + 1.0 ? 200.0 : 0.0;
            }
            const bool inside = at.x > plot.x + kRing && at.x < plot.x + plot.width - kRing &&
                                at.y > plot.y + kRing && at.y < plot.y + plot.height - kRing;
            cost += inside ? 0.0 : 500.0;
            if (cost < least) {
                least = cost;
                best = at;
            }
        }
    }
    return best;
}

std::string PanelPlan::markers(const Rect& plot) const {
    if (panel_->markers.empty()) {
        return "";
    }
    const std::vector<Point> lines = ink(plot);
    std::vector<Point> dots;
    for (const Marker& marker : panel_->markers) {
        if (x_.holds(marker.x) && y_.holds(marker.y)) {
            dots.push_back(place(marker.x, marker.y, plot));
        }
    }
    std::vector<Point> labels;
    std::string out;
    std::size_t next = 0;
    for (const Marker& marker : panel_->markers) {
        if (!x_.holds(marker.x) || !y_.holds(marker.y)) {
            continue;
        }
        const Point dot = dots[next++];
        const Point best = label_place(dot, lines, dots, labels, plot);
        labels.push_back(best);
        const double gap = distance(best.x, best.y, dot.x, dot.y);
        const double s = 1.0 - kRing / gap;
        const double width = std::max(2.0 * kRing, text_width(marker.label, 10.0) + 6.0);
        out += fmt::format(
            "<path d=\"M{0} {1}L{2} {3}\" stroke=\"#000000\" stroke-width=\"0.8\"/><circle "
            "class=\"marker\" cx=\"{0}\" cy=\"{1}\" r=\"2.6\" fill=\"#000000\"/><rect x=\"{4}\" "
            "y=\"{5}\" width=\"{6}\" height=\"{7}\" rx=\"{8}\" fill=\"#ffffff\" stroke=\"#000000\" "
            "stroke-width=\"0.9\"/>\n",
            px(dot.x), px(dot.y), px(dot.x + s * (best.x - dot.x)),
            px(dot.y + s * (best.y - dot.y)), px(best.x - width / 2.0), px(best.y - kRing),
            px(width), px(2.0 * kRing), px(kRing));
        out += svg_text(best.x, best.y + 3.6, marker.label, 10.0, Anchor::middle);
    }
    return out;
}

}  // namespace palpate::data
