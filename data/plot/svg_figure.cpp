#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "data/plot/figure.hpp"
#include "data/plot/svg_panel.hpp"

// What a panel draws inside its axes: lines, points, arrows and numbered markers.
namespace palpate::data {
namespace {

constexpr double kFigureEdge = 10.0;         // px round the whole figure
constexpr double kBetween = 14.0;            // px between panels
constexpr double kFigureCaptionLine = 16.0;  // px

void check(const Figure& figure) {
    refuse_if(figure.panels.empty(), "a figure needs at least one panel");
    refuse_if(figure.columns < 1 || figure.columns > 8, "a figure has {} columns: give 1 to 8",
              figure.columns);
    refuse_if(!(figure.width >= 200.0 * figure.columns && figure.width <= 10000.0),
              "a figure of {} columns is {} px wide: give 200 a column to 10000", figure.columns,
              figure.width);
}

/// `id` with everything but letters, digits, - and _ made _, and a letter in front.
std::string safe_id(const std::string& id) {
    std::string out = "f-";
    for (const char c : id) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                           (c >= '0' && c <= '9') || c == '-' || c == '_';
        out += plain ? c : '_';
    }
    return out;
}

/// Panels of `cell` px, aligned within columns, and along x where they share it.
std::vector<PanelPlan> plans_of(const Figure& figure, double cell) {
    const auto columns = static_cast<std::size_t>(figure.columns);
    std::vector<PanelPlan> plans;
    std::vector<double> left(columns, 0.0);
    for (const Panel& panel : figure.panels) {
        const std::size_t column = plans.size() % columns;
        plans.emplace_back(panel, cell);
        left[column] = std::max(left[column], plans.back().left());
    }
    // Twice: what the last panel widens has to reach the first.
    for (int pass = 0; figure.share_x && pass < 2; ++pass) {
        for (std::size_t i = 0; i < plans.size(); ++i) {
            for (std::size_t j = i + columns; j < plans.size(); j += columns) {
                plans[i].share_x(plans[j]);
            }
        }
    }
    for (std::size_t i = 0; i < plans.size(); ++i) {
        plans[i].align(left[i % columns]);
    }
    return plans;
}

constexpr double kNearest = 0.15;  // px: a point nearer to the last one drawn changes no pixel
constexpr double kRing = 8.0;      // px, radius of a marker's label

}  // namespace

std::string svg(const Figure& figure) {
    check(figure);
    const auto columns = static_cast<std::size_t>(figure.columns);
    const double cell =
        (figure.width - 2.0 * kFigureEdge - kBetween * (figure.columns - 1)) / figure.columns;

    std::vector<PanelPlan> plans = plans_of(figure, cell);
    const std::string id = safe_id(figure.id);
    std::string body;
    double y = kFigureEdge;
    for (const std::string& line : wrapped(figure.title, figure.width - 2.0 * kFigureEdge, 15.0)) {
        body += svg_text(kFigureEdge, y + 14.0, line, 15.0, Anchor::start, "font-weight=\"bold\"");
        y += 21.0;
    }
    for (std::size_t row = 0; row < plans.size(); row += columns) {
        const std::size_t end = std::min(row + columns, plans.size());
        double header = 0.0;
        double below = 0.0;
        for (std::size_t i = row; i < end; ++i) {
            header = std::max(header, plans[i].header());
            below = std::max(below, plans[i].panel().height + plans[i].footer());
        }
        for (std::size_t i = row; i < end; ++i) {
            const double x = kFigureEdge + static_cast<double>(i - row) * (cell + kBetween);
            body += plans[i].draw(x, y + header, fmt::format("{}-clip{}", id, i));
        }
        y += header + below + kBetween;
    }
    for (const std::string& line :
         wrapped(figure.caption, figure.width - 2.0 * kFigureEdge, 12.0)) {
        body += svg_text(kFigureEdge, y + 10.0, line, 12.0, Anchor::start, "class=\"caption\"");
        y += kFigureCaptionLine;
    }
    y += kFigureEdge;

    return fmt::format(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"{0}\" "
               "height=\"{1}\" viewBox=\"0 0 {0} {1}\" role=\"img\" aria-labelledby=\"{2}-title\" "
               "font-family=\"DejaVu Sans, Verdana, Arial, sans-serif\">\n"
               "<title id=\"{2}-title\">{3}</title>\n"
               "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
               px(figure.width), px(y), id,
               xml_escaped(figure.title.empty() ? figure.id : figure.title)) +
           body + "</svg>\n";
}

PanelPlan::Point PanelPlan::place(double x, double y) const {
    // Far outside of given axes a coordinate may be huge: SVG readers keep few digits.
    const auto share = [](const AxisRange& range, double v) {
        return std::clamp(range.share(v), -100.0, 101.0);
    };
    return {plot_.x + plot_.width * share(x_, x), plot_.y + plot_.height * (1.0 - share(y_, y))};
}

std::string PanelPlan::line(const Series& series, std::string_view ink) const {
    std::string path;
    Point drawn{};
    Point skipped{};
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
        if (!holds(series.x[i], series.y[i])) {
            finish();
            continue;
        }
        const Point p = place(series.x[i], series.y[i]);
        if (!open) {
            length = 0;
            put(p, 'M');
            open = true;
        } else if (glm::distance(p, drawn) < kNearest) {
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

std::string PanelPlan::points(const Series& series, std::string_view ink) const {
    std::string out;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        if (holds(series.x[i], series.y[i])) {
            const Point p = place(series.x[i], series.y[i]);
            out += fmt::format(
                "<circle class=\"point\" cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"{}/>\n", px(p.x),
                px(p.y), series.sizes.empty() ? "3" : px(series.sizes[i]), ink,
                series.opacity < 1.0 ? fmt::format(" fill-opacity=\"{:g}\"", series.opacity) : "");
        }
    }
    return out;
}

std::string PanelPlan::band(const Band& shaded) const {
    std::string there;
    std::string back;
    std::string path;
    const auto finish = [&] {
        path += there.empty() ? "" : "M" + there.substr(1) + back + "z";
        there.clear();
        back.clear();
    };
    for (std::size_t i = 0; i < shaded.x.size(); ++i) {
        if (!holds(shaded.x[i], shaded.low[i]) || !y_.holds(shaded.high[i])) {
            finish();
            continue;
        }
        const Point low = place(shaded.x[i], shaded.low[i]);
        const Point high = place(shaded.x[i], shaded.high[i]);
        there += fmt::format("L{} {}", px(high.x), px(high.y));
        back.insert(0, fmt::format("L{} {}", px(low.x), px(low.y)));
    }
    finish();
    return path.empty()
             ? ""
             : fmt::format("<path class=\"band\" d=\"{}\" fill=\"{}\" fill-opacity=\"0.18\"/>\n",
                           path, colour(shaded.ink, 7));
}

std::string PanelPlan::arrows() const {
    std::string out;
    for (const Arrow& arrow : panel_->arrows) {
        const Point end{arrow.x + arrow.dx, arrow.y + arrow.dy};
        if (!holds(arrow.x, arrow.y) || !holds(end.x, end.y)) {
            continue;
        }
        const Point from = place(arrow.x, arrow.y);
        const Point to = place(end.x, end.y);
        const double length = glm::distance(from, to);
        if (length < 0.5) {
            continue;
        }
        const double head = std::min(7.0, 0.5 * length);
        const Point way = (to - from) / length;
        const Point neck = to - head * way;
        const std::string_view ink = colour(arrow.ink, 6);
        out += fmt::format(
            "<path class=\"arrow\" d=\"M{} {}L{} {}\" stroke=\"{}\" stroke-width=\"1.4\"/><path "
            "d=\"M{} {}L{} {}L{} {}z\" fill=\"{}\"/>\n",
            px(from.x), px(from.y), px(neck.x), px(neck.y), ink, px(to.x), px(to.y),
            px(neck.x - 0.45 * head * way.y), px(neck.y + 0.45 * head * way.x),
            px(neck.x + 0.45 * head * way.y), px(neck.y - 0.45 * head * way.x), ink);
    }
    return out;
}

std::string PanelPlan::labels() const {
    std::string out;
    for (const Label& label : panel_->labels) {
        if (holds(label.x, label.y)) {
            const Point at = place(label.x, label.y);
            out += svg_text(at.x, at.y + 0.35 * kTitleSize, label.text, kTitleSize, Anchor::middle,
                            fmt::format("fill=\"{}\" font-weight=\"bold\"", colour(label.ink, 6)));
        }
    }
    return out;
}

/// What labels should not cover: points of the lines, 4 px apart at most.
std::vector<PanelPlan::Point> PanelPlan::ink() const {
    std::vector<Point> ink;
    for (const Series& series : panel_->series) {
        Point last{-1e9, -1e9};
        for (std::size_t i = 0; i < series.x.size(); ++i) {
            if (holds(series.x[i], series.y[i])) {
                const Point p = place(series.x[i], series.y[i]);
                const double gap = glm::distance(p, last);
                // Long chords are filled, so that a label does not sit on the middle of one.
                const int steps = i > 0 && series.mark != Mark::points && gap < 4000.0
                                    ? static_cast<int>(gap / 4.0)
                                    : 0;
                for (int k = 1; k < steps; ++k) {
                    ink.push_back(last + static_cast<double>(k) / steps * (p - last));
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
                                        const std::vector<Point>& labels) const {
    constexpr std::array<Point, 8> kRound{{{0.0, -1.0},
                                           {0.7071, -0.7071},
                                           {-0.7071, -0.7071},
                                           {1.0, 0.0},
                                           {-1.0, 0.0},
                                           {0.0, 1.0},
                                           {0.7071, 0.7071},
                                           {-0.7071, 0.7071}}};
    Point best{};
    double least = 1e300;
    for (const double far : {16.0, 22.0, 30.0, 40.0}) {
        for (const Point& way : kRound) {
            const Point at = dot + far * way;
            double cost = 0.2 * far;
            for (const Point& p : ink) {
                cost += glm::distance(p, at) < kRing + 3.0 ? 4.0 : 0.0;
            }
            for (const Point& p : dots) {
                cost += glm::distance(p, at) < kRing + 4.0 ? 30.0 : 0.0;
            }
            for (const Point& p : labels) {
                cost += glm::distance(p, at) < 2.0 * kRing + 1.0 ? 200.0 : 0.0;
            }
            const bool inside = at.x > plot_.x + kRing && at.x < plot_.x + plot_.width - kRing &&
                                at.y > plot_.y + kRing && at.y < plot_.y + plot_.height - kRing;
            cost += inside ? 0.0 : 500.0;
            if (cost < least) {
                least = cost;
                best = at;
            }
        }
    }
    return best;
}

std::string PanelPlan::markers() const {
    std::vector<Point> dots;
    std::vector<std::string_view> words;
    for (const Marker& marker : panel_->markers) {
        if (holds(marker.x, marker.y)) {
            dots.push_back(place(marker.x, marker.y));
            words.emplace_back(marker.label);
        }
    }
    const std::vector<Point> lines = dots.empty() ? std::vector<Point>() : ink();
    std::vector<Point> labels;
    std::string out;
    for (std::size_t i = 0; i < dots.size(); ++i) {
        const Point& dot = dots[i];
        const Point best = label_place(dot, lines, dots, labels);
        labels.push_back(best);
        const Point ring = dot + (1.0 - kRing / glm::distance(best, dot)) * (best - dot);
        const double width = std::max(2.0 * kRing, text_width(words[i], 10.0) + 6.0);
        out += fmt::format(
            "<path d=\"M{0} {1}L{2} {3}\" stroke=\"#000000\" stroke-width=\"0.8\"/><circle "
            "class=\"marker\" cx=\"{0}\" cy=\"{1}\" r=\"2.6\" fill=\"#000000\"/><rect x=\"{4}\" "
            "y=\"{5}\" width=\"{6}\" height=\"{7}\" rx=\"{8}\" fill=\"#ffffff\" stroke=\"#000000\" "
            "stroke-width=\"0.9\"/>\n",
            px(dot.x), px(dot.y), px(ring.x), px(ring.y), px(best.x - width / 2.0),
            px(best.y - kRing), px(width), px(2.0 * kRing), px(kRing));
        out += svg_text(best.x, best.y + 3.6, words[i], 10.0, Anchor::middle);
    }
    return out;
}

}  // namespace palpate::data
