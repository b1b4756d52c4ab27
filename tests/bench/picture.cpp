#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <sstream>

#include "tests/bench/report.hpp"

/// Work-precision picture: write_svg of report.hpp.
namespace palpate::bench {
namespace {

constexpr double kWidth = 760.0;  ///< of a panel
constexpr double kPanel = 460.0;
constexpr std::size_t kColumns = 2;  ///< panels side by side
constexpr double kLeft = 90.0;
constexpr double kRight = 30.0;
constexpr double kTop = 56.0;
constexpr double kBottom = 52.0;
constexpr double kLetter = 6.7;  ///< widest mean advance of a letter at 11 px
constexpr double kLine = 13.0;
constexpr double kNoError = 1e-20;  ///< shown for an error of 0

/// Okabe & Ito's colours: told apart with any colour vision. The shape says it again.
struct Style {
    Kind kind;
    const char* colour;
    const char* meaning;
};
constexpr std::array<Style, 4> kStyles{{{Kind::global, "#0072b2", "ours, global"},
                                        {Kind::tracker, "#d55e00", "trackers"},
                                        {Kind::mesh, "#7f7f7f", "polylines and meshes"},
                                        {Kind::peer, "#009e73", "libraries"}}};

struct Rectangle {
    double x = 0.0;
    double y = 0.0;
    double width = 0.0;
    double height = 0.0;

    [[nodiscard]] bool meets(const Rectangle& other) const {
        return x < other.x + other.width && other.x < x + width && y < other.y + other.height &&
               other.y < y + height;
    }
};

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
    }
    return out;
}

std::string power_of_ten(int n) {
    return "10<tspan dy=\"-4\" font-size=\"8\">" + std::to_string(n) + "</tspan>";
}

double error_of(const Row& row) {
    return std::max(row.error.distance_p99, kNoError);
}

/// A panel's plane: decades of ns to the right, decades of metres upwards.
class Plane {
public:
    Plane(const std::vector<Row>& rows, double top) : top_(top) {
        for (const Row& row : rows) {
            x0_ = std::min(x0_, std::floor(std::log10(row.time.warm)));
            x1_ = std::max(x1_, std::ceil(std::log10(row.time.warm)));
            y0_ = std::min(y0_, std::floor(std::log10(error_of(row)) - 0.3));
            y1_ = std::max(y1_, std::ceil(std::log10(error_of(row)) + 0.3));
        }
    }
    [[nodiscard]] double x(double ns) const {
        return kLeft + (std::log10(ns) - x0_) / (x1_ - x0_) * (kWidth - kLeft - kRight);
    }
    [[nodiscard]] double y(double metres) const {
        return top_ + kPanel - kBottom -
               (std::log10(metres) - y0_) / (y1_ - y0_) * (kPanel - kTop - kBottom);
    }
    void draw(std::ostream& out) const {
        for (int i = static_cast<int>(x0_); i <= static_cast<int>(x1_); ++i) {
            const double at = x(std::pow(10.0, i));
            out << "<line class=\"grid\" x1=\"" << at << "\" x2=\"" << at << "\" y1=\""
                << top_ + kTop << "\" y2=\"" << top_ + kPanel - kBottom << "\"/>"
                << "<text class=\"tick\" text-anchor=\"middle\" x=\"" << at << "\" y=\""
                << top_ + kPanel - kBottom + 18.0 << "\">" << power_of_ten(i) << "</text>\n";
        }
        for (int i = static_cast<int>(y0_); i <= static_cast<int>(y1_); ++i) {
            const double at = y(std::pow(10.0, i));
            const bool named = (i - static_cast<int>(y0_)) % 2 == 0;
            out << "<line class=\"grid\" x1=\"" << kLeft << "\" x2=\"" << kWidth - kRight
                << "\" y1=\"" << at << "\" y2=\"" << at << "\"/>";
            if (named) {
                out << "<text class=\"tick\" text-anchor=\"end\" x=\"" << kLeft - 8.0 << "\" y=\""
                    << at + 4.0 << "\">" << power_of_ten(i) << "</text>";
            }
            out << '\n';
        }
        out << "<text class=\"axis\" text-anchor=\"middle\" x=\"" << 0.5 * (kLeft + kWidth - kRight)
            << "\" y=\"" << top_ + kPanel - 14.0 << "\">ns a tick, warm</text>"
            << "<text class=\"axis\" text-anchor=\"middle\" transform=\"translate(22 "
            << top_ + 0.5 * (kTop + kPanel - kBottom)
            << ") rotate(-90)\">error of the distance, p99, m</text>\n";
    }
    [[nodiscard]] Rectangle frame() const {
        return {kLeft, top_ + kTop, kWidth - kLeft - kRight, kPanel - kTop - kBottom};
    }

private:
    double top_ = 0.0;
    double x0_ = 3.0;
    double x1_ = 1.0;
    double y0_ = 0.0;
    double y1_ = -17.0;
};

/// Where a label of this size meets nothing that is there already, near (x, y).
Rectangle free_place(
    double x, double y, double width, const Rectangle& frame, const std::vector<Rectangle>& taken) {
    const Rectangle beside{x + 8.0, y - 0.5 * kLine, width, kLine};
    for (int ring = 0; ring < 24; ++ring) {
        for (const double sign : {-1.0, 1.0}) {
            for (const bool right : {true, false}) {
                Rectangle box = beside;
                box.x = right ? x + 8.0 : x - 8.0 - width;
                box.y += sign * 0.55 * kLine * ring;
                const bool inside = box.x >= frame.x && box.x + width <= frame.x + frame.width &&
                                    box.y >= frame.y && box.y + kLine <= frame.y + frame.height;
                if (inside && std::none_of(taken.begin(), taken.end(),
                                           [&box](const Rectangle& r) { return r.meets(box); })) {
                    return box;
                }
            }
        }
    }
    return beside;
}

void draw_mark(std::ostream& out, const Style& style, double x, double y) {
    out << "<g fill=\"" << style.colour << "\" stroke=\"#fff\">";
    switch (style.kind) {
        case Kind::global:
            out << "<circle cx=\"" << x << "\" cy=\"" << y << "\" r=\"5\"/>";
            break;
        case Kind::tracker:
            out << "<path d=\"M" << x << ' ' << y - 6.0 << "l6 11h-12z\"/>";
            break;
        case Kind::mesh:
            out << "<rect x=\"" << x - 4.5 << "\" y=\"" << y - 4.5
                << "\" width=\"9\" height=\"9\"/>";
            break;
        default:
            out << "<path d=\"M" << x << ' ' << y - 6.0 << "l6 6l-6 6l-6 -6z\"/>";
            break;
    }
    out << "</g>";
}

const Style& style_of(Kind kind) {
    const auto* const found = std::find_if(kStyles.begin(), kStyles.end(),
                                           [kind](const Style& s) { return s.kind == kind; });
    return found == kStyles.end() ? kStyles.back() : *found;
}

void draw_panel(std::ostream& out, const std::vector<Row>& rows, double top) {
    const Plane plane(rows, top);
    out << "<text class=\"title\" x=\"" << kLeft << "\" y=\"" << top + 24.0 << "\">"
        << escaped(rows.front().object + ", " + rows.front().path) << "</text>\n";
    double legend = kLeft;
    for (const Style& style : kStyles) {
        if (std::none_of(rows.begin(), rows.end(),
                         [&style](const Row& row) { return row.kind == style.kind; })) {
            continue;
        }
        const std::string meaning = style.meaning;
        draw_mark(out, style, legend + 5.0, top + 40.0);
        out << "<text class=\"tick\" x=\"" << legend + 16.0 << "\" y=\"" << top + 44.0 << "\">"
            << meaning << "</text>\n";
        legend += 40.0 + kLetter * static_cast<double>(meaning.size());
    }
    plane.draw(out);
    std::ostringstream labels;
    labels.precision(5);
    std::vector<Rectangle> taken;
    for (const Row& row : rows) {
        taken.push_back({plane.x(row.time.warm) - 6.0, plane.y(error_of(row)) - 6.0, 12.0, 12.0});
    }
    for (const Row& row : rows) {
        const double x = plane.x(row.time.warm);
        const double y = plane.y(error_of(row));
        const double width = kLetter * static_cast<double>(row.method.size());
        const Rectangle box = free_place(x, y, width, plane.frame(), taken);
        taken.push_back(box);
        const bool right = box.x > x;
        out << "<line class=\"lead\" x1=\"" << x << "\" y1=\"" << y << "\" x2=\""
            << (right ? box.x - 1.0 : box.x + width + 1.0) << "\" y2=\"" << box.y + 0.5 * kLine
            << "\"/>\n";
        labels << "<text class=\"label\" text-anchor=\"" << (right ? "start" : "end") << "\" x=\""
               << (right ? box.x : box.x + width) << "\" y=\"" << box.y + 10.0 << "\">"
               << escaped(row.method) << "</text>\n";
    }
    out << labels.str();
    for (const Row& row : rows) {
        draw_mark(out, style_of(row.kind), plane.x(row.time.warm), plane.y(error_of(row)));
        out << '\n';
    }
}

}  // namespace

void write_svg(std::ostream& out, const std::vector<Row>& rows) {
    std::vector<std::vector<Row>> panels;
    for (const Row& row : rows) {
        if (row.kind == Kind::floor) {
            continue;  // answers nothing
        }
        if (panels.empty() || panels.back().front().object != row.object ||
            panels.back().front().path != row.path) {
            panels.emplace_back();
        }
        panels.back().push_back(row);
    }
    const auto lines = static_cast<double>((panels.size() + kColumns - 1) / kColumns);
    const double width = kWidth * static_cast<double>(std::min(panels.size(), kColumns));
    const double height = kPanel * lines + 24.0;
    std::ostringstream text;
    text.precision(5);
    text << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << width << ' ' << height
         << "\" width=\"" << width << "\" height=\"" << height
         << "\" font-family=\"DejaVu Sans, sans-serif\">\n"
         << "<style>.grid{stroke:#e4e4e4}.lead{stroke:#b8b8b8;stroke-width:.7}"
            ".tick,.label{font-size:11px;fill:#333}.axis{font-size:12px;fill:#333}"
            ".label{paint-order:stroke;stroke:#fff;stroke-width:3px}"
            ".title{font-size:15px;fill:#111}</style>\n"
         << "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const double left = kWidth * static_cast<double>(i % kColumns);
        text << "<g transform=\"translate(" << left << " 0)\">\n";
        draw_panel(text, panels[i], kPanel * static_cast<double>(i / kColumns));
        text << "</g>\n";
    }
    text << "<text class=\"tick\" x=\"" << kLeft << "\" y=\"" << kPanel * lines + 12.0 << "\">"
         << escaped(machine()) << "</text>\n</svg>\n";
    out << text.str();
}

}  // namespace palpate::bench
