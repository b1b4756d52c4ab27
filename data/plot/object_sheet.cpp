#include "data/plot/object_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "engine/geometry/vec.hpp"
#include "protocols/design/object_outline.hpp"
#include "data/plot/svg_panel.hpp"

namespace palpate::data {
namespace {

using engine::Vec2;
using protocols::ObjectSpec;
using protocols::Protocol;

constexpr std::size_t kColumns = 4;
constexpr double kEdge = 14.0;      // px round the whole sheet
constexpr double kCell = 200.0;     // px, width of a cell
constexpr double kPad = 14.0;       // px left and right of an object in its cell
constexpr double kTallest = 260.0;  // px, of an object
constexpr double kWords = 62.0;     // px below an object for its three lines

std::string signed_text(double value, std::string_view unit) {
    return value == 0.0
             ? fmt::format("0 {}", unit)
             : fmt::format("{}{:.6g} {}", value > 0.0 ? "+" : "\u2212", std::fabs(value), unit);
}

std::string millimetres(double metres) {
    const double rounded = std::round(metres * 1e5) / 100.0;
    return signed_text(rounded, "mm");
}

/// One for both curves if their chords are equal.
std::string sagitta_text(const Protocol& protocol, const ObjectSpec& object) {
    const auto& [a, vertex, b] = protocol.outline;
    const double curvature = curvature_of(object).value_or(0.0);
    const std::string left = millimetres(sagitta(curvature, object.size * glm::length(vertex - a)));
    const std::string right =
        millimetres(sagitta(curvature, object.size * glm::length(b - vertex)));
    return left == right ? fmt::format("sagitta {}", left)
                         : fmt::format("sagitta {}, {}", left, right);
}

/// What says how an object is curved.
std::string shape_text(const Protocol& protocol,
                       const ObjectSpec& object,
                       const std::vector<Vec2>& outline) {
    if (protocol.surface) {
        return fmt::format("{}, across {}", signed_text(object.curvature, "1/m"),
                           signed_text(object.cross_curvature, "1/m"));
    }
    if (const auto curvature = curvature_of(object)) {
        return fmt::format("{}, {}", signed_text(*curvature, "1/m"),
                           sagitta_text(protocol, object));
    }
    const Vec2 size = 1e3 * engine::box_of<2>(outline).size();
    return fmt::format("free form, {:.4g} \u00d7 {:.4g} mm", size.x, size.y);
}

/// A round number of millimetres (1, 2 or 5 times a power of ten), at most `max`.
double bar_length(double max) {
    const double power = std::pow(10.0, std::floor(std::log10(max)));
    const double times = max / power;
    return power * (times >= 5.0 ? 5.0 : times >= 2.0 ? 2.0 : 1.0);
}

/// In the middle of a cell at `x`, smaller where it would not fit.
std::string fitted(
    double x, double y, const std::string& text, double size, std::string_view extra = {}) {
    const double room = kCell - 8.0;
    return svg_text(x, y, text, std::min(size, size * room / text_width(text, size)),
                    Anchor::middle, extra);
}

class Sheet {
public:
    Sheet(const Protocol& protocol, std::string_view hash) : protocol_(protocol), hash_(hash) {
        for (std::size_t i = 0; i < protocol.objects.size(); ++i) {
            outlines_.push_back(protocols::silhouette_of(protocol, i));
            const engine::Box<2> box = engine::box_of<2>(outlines_.back());
            box_ = i == 0 ? box : box_;
            box_.add(box);
        }
        const Vec2 size = box_.size();
        scale_ = std::min((kCell - 2.0 * kPad) / size.x, kTallest / size.y);
        columns_ = std::min(kColumns, outlines_.size());
        cell_height_ = scale_ * size.y + kWords;
    }

    [[nodiscard]] std::string text() const {
        const std::size_t rows = (outlines_.size() + columns_ - 1) / columns_;
        const double inner = std::max(static_cast<double>(columns_) * kCell, 2.0 * kCell);
        const std::vector<std::string> title = wrapped(protocol_.title, inner, kTitleSize);
        const double top = kEdge + kLine * static_cast<double>(title.size()) + 12.0;
        const double foot = top + static_cast<double>(rows) * cell_height_ + 8.0;
        const double width = inner + 2.0 * kEdge;
        const double height = foot + 52.0 + kEdge;
        std::string out = fmt::format(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"{0}\" "
            "height=\"{1}\" viewBox=\"0 0 {0} {1}\" font-family=\"DejaVu Sans, Verdana, "
            "sans-serif\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
            px(width), px(height));
        for (std::size_t i = 0; i < title.size(); ++i) {
            out += svg_text(kEdge, kEdge + kTitleSize + kLine * static_cast<double>(i), title[i],
                            kTitleSize, Anchor::start, "font-weight=\"bold\"");
        }
        for (std::size_t i = 0; i < outlines_.size(); ++i) {
            out += cell(i, kEdge + static_cast<double>(i % columns_) * kCell,
                        top + static_cast<double>(i / columns_) * cell_height_);
        }
        return out + footer(foot) + "</svg>\n";
    }

private:
    [[nodiscard]] std::string cell(std::size_t index, double x, double y) const {
        const ObjectSpec& object = protocol_.objects[index];
        const double width = scale_ * (box_.high.x - box_.low.x);
        const Vec2 corner{x + 0.5 * (kCell - width), y};
        const auto place = [&](const Vec2& point) {
            return px(corner.x + scale_ * (point.x - box_.low.x)) + ' ' +
                   px(corner.y + scale_ * (box_.high.y - point.y));
        };
        const auto path_of = [&](const auto& points) {
            std::string path;
            for (const Vec2& point : points) {
                path += path.empty() ? 'M' : 'L';
                path += place(point);
            }
            return path;
        };
        const std::string_view ink = colour(object.pictured ? Ink::blue : Ink::grey, 0);
        std::string out = fmt::format(
            "<path d=\"{}z\" fill=\"{}\" fill-opacity=\"0.18\" stroke=\"{}\" "
            "stroke-width=\"1.6\" stroke-linejoin=\"round\"/>\n",
            path_of(outlines_[index]), ink, ink);
        if (protocol_.surface) {
            const auto surface = protocols::surface_of(protocol_, object);
            for (const auto& line : stimuli::drawing_of(*surface).lines) {
                out += fmt::format(
                    "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"0.6\"/>\n",
                    path_of(line), ink);
            }
        } else if (object.segments.empty()) {
            const stimuli::TwoCurve curves = object_of(protocol_, object);
            out += fmt::format(
                "<path d=\"M{}L{}L{}\" fill=\"none\" stroke=\"#666666\" stroke-width=\"0.8\" "
                "stroke-dasharray=\"3 3\"/>\n",
                place(curves.a), place(curves.vertex), place(curves.b));
        }
        const double middle = x + 0.5 * kCell;
        double line = y + scale_ * (box_.high.y - box_.low.y) + kLine;
        out += fitted(middle, line, object.name, kTitleSize, "font-weight=\"bold\"");
        out += fitted(middle, line += kLine - 1.0, shape_text(protocol_, object, outlines_[index]),
                      kTextSize - 1.0);
        if (!object.pictured) {
            out += svg_text(middle, line + kLine - 2.0, "felt, not pictured", kTextSize - 1.0,
                            Anchor::middle, "fill=\"#666666\"");
        }
        return out;
    }

    [[nodiscard]] std::string footer(double y) const {
        const double bar = bar_length(1e3 * (box_.high.x - box_.low.x) / 2.0);
        const double length = 1e-3 * bar * scale_;
        std::string out = fmt::format(
            "<path d=\"M{0} {1}v8m0 -4h{2}m0 -4v8\" fill=\"none\" stroke=\"#000000\" "
            "stroke-width=\"1.6\"/>\n",
            px(kEdge), px(y), px(length));
        out += svg_text(kEdge + length + 8.0, y + 8.0, fmt::format("{:.6g} mm", bar), kTextSize);
        out += svg_text(kEdge, y + 8.0 + 1.6 * kLine,
                        fmt::format("{}, protocol {}", protocol_.id, hash_.substr(0, 12)),
                        kTextSize, Anchor::start, "fill=\"#444444\"");
        return out;
    }

    const Protocol& protocol_;
    std::string_view hash_;
    std::vector<std::vector<Vec2>> outlines_;
    engine::Box<2> box_{};  ///< what all outlines take, m
    double scale_ = 1.0;    ///< px/m
    std::size_t columns_ = 1;
    double cell_height_ = 0.0;
};

}  // namespace

double sagitta(double curvature, double chord) noexcept {
    const double half_sine = 0.5 * curvature * chord;
    return 0.25 * chord * chord * curvature / (1.0 + std::sqrt(1.0 - half_sine * half_sine));
}

std::string object_sheet(const Protocol& protocol, std::string_view hash) {
    return Sheet(protocol, hash).text();
}

}  // namespace palpate::data
