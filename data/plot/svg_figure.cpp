#include "data/plot/svg_figure.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "data/plot/svg_panel.hpp"
#include "data/plot/svg_text.hpp"

namespace palpate::data {
namespace {

constexpr double kFigureEdge = 10.0;         // px round the whole figure
constexpr double kBetween = 14.0;            // px between panels
constexpr double kFigureCaptionLine = 16.0;  // px

void check(const Figure& figure) {
    const auto refuse = [](const std::string& text) {
        throw std::invalid_argument(text);
    };
    if (figure.panels.empty()) {
        refuse("a figure needs at least one panel");
    }
    if (figure.columns < 1 || figure.columns > 8) {
        refuse(fmt::format("a figure has {} columns: give 1 to 8", figure.columns));
    }
    if (!(figure.width >= 200.0 * figure.columns && figure.width <= 10000.0)) {
        refuse(fmt::format("a figure of {} columns is {} px wide: give 200 a column to 10000",
                           figure.columns, figure.width));
    }
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

void write_svg(const std::filesystem::path& path, const Figure& figure) {
    write_whole(path, svg(figure));
}

}  // namespace palpate::data
