#include "data/plot/svg_panel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"

namespace palpate::data {
namespace {

constexpr double kMargin = 0.04;   // of the range, on both sides
constexpr std::size_t kTurns = 7;  // inks that `automatic` takes in turn

/// Widens [low, high] to the values of `add`.
struct Extent {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    void add(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    [[nodiscard]] bool empty() const { return low > high; }
};

AxisRange range_of(const Axis& axis, Extent extent, std::string_view which) {
    if (extent.empty()) {
        extent = axis.log ? Extent{0.1, 10.0} : Extent{0.0, 1.0};
    }
    if (axis.log) {
        const double room = std::pow(extent.high / extent.low, kMargin);
        extent = extent.low == extent.high ? Extent{extent.low / 2.0, extent.high * 2.0}
                                           : Extent{extent.low / room, extent.high * room};
    } else {
        // A range below 1e-12 of its values has no digits for ticks.
        const double size = std::max(std::fabs(extent.low), std::fabs(extent.high));
        double room = kMargin * (extent.high - extent.low);
        if (extent.high - extent.low <= 1e-12 * size) {
            room = size > 0.0 ? 0.1 * size : 1.0;
        }
        extent = {extent.low - room, extent.high + room};
    }
    const AxisRange range{.low = axis.low.value_or(extent.low),
                          .high = axis.high.value_or(extent.high),
                          .log = axis.log};
    const bool sane = std::isfinite(range.low) && std::isfinite(range.high) &&
                      std::isfinite(range.high - range.low);
    refuse_if(!sane || !(range.low < range.high) || (axis.log && range.low <= 0.0),
              "the {} axis \"{}\" goes from {} to {}: give finite numbers that rise{}", which,
              axis.label, range.low, range.high, axis.log ? ", above 0" : "");
    return range;
}

/// Of an axis that counts things.
void name_ticks(const Axis& axis, const AxisRange& range, AxisTicks& ticks) {
    if (axis.names.empty()) {
        return;
    }
    ticks = {};
    for (const auto& [at, name] : axis.names) {
        if (range.low <= at && at <= range.high) {
            ticks.ticks.push_back({at, name});
        }
    }
}

std::string axis_label(const Axis& axis, int exponent) {
    const std::string scale = exponent == 0 ? "" : "10" + superscript(exponent);
    const std::string unit = scale.empty()     ? axis.unit
                           : axis.unit.empty() ? "× " + scale
                                               : scale + " " + axis.unit;
    return unit.empty() ? axis.label : axis.label.empty() ? unit : axis.label + " (" + unit + ")";
}

constexpr double kSample = 22.0;  // px of an entry's sample

}  // namespace

std::string_view colour(Ink ink, std::size_t turn) {
    constexpr std::string_view kColours[] = {"#0072b2", "#d55e00", "#009e73", "#aa4499",
                                             "#e69f00", "#56b4e9", "#000000", "#777777"};
    return kColours[ink == Ink::automatic ? turn % kTurns : static_cast<std::size_t>(ink) - 1];
}

PanelPlan::PanelPlan(const Panel& panel, double width) : panel_(&panel), width_(width) {
    refuse_if(!(panel.height >= 40.0 && panel.height <= 4000.0),
              "a panel is {} px high: give 40 to 4000", panel.height);
    refuse_if(panel.equal_aspect && (panel.x.log || panel.y.log),
              "a panel of equal aspect has a log axis: choose one of the two");
    for (const Series& series : panel.series) {
        refuse_if(series.x.size() != series.y.size(),
                  "series \"{}\" has {} x and {} y: give as many", series.name, series.x.size(),
                  series.y.size());
        refuse_if(!series.sizes.empty() && series.sizes.size() != series.x.size(),
                  "series \"{}\" has {} points and {} sizes: give as many, or none", series.name,
                  series.x.size(), series.sizes.size());
    }
    for (const Band& band : panel.bands) {
        refuse_if(band.x.size() != band.low.size() || band.x.size() != band.high.size(),
                  "band \"{}\" has {} x, {} low and {} high: give as many", band.name,
                  band.x.size(), band.low.size(), band.high.size());
    }
    find_ranges();
    fit_ranges();
    double widest = 0.0;
    for (const AxisTick& tick : y_ticks_.ticks) {
        widest = std::max(widest, text_width(tick.label, kTextSize));
    }
    left_ = widest + 32.0;
}

void PanelPlan::find_ranges() {
    Extent x;
    Extent y;
    const AxisRange log_x{.log = panel_->x.log};
    const AxisRange log_y{.log = panel_->y.log};
    const auto add = [&](double at_x, double at_y) {
        if (log_x.holds(at_x) && log_y.holds(at_y)) {
            x.add(at_x);
            y.add(at_y);
        }
    };
    for (const Series& series : panel_->series) {
        for (std::size_t i = 0; i < series.x.size(); ++i) {
            add(series.x[i], series.y[i]);
        }
    }
    for (const Band& band : panel_->bands) {
        for (std::size_t i = 0; i < band.x.size(); ++i) {
            add(band.x[i], band.low[i]);
            add(band.x[i], band.high[i]);
        }
    }
    for (const Marker& marker : panel_->markers) {
        add(marker.x, marker.y);
    }
    for (const Arrow& arrow : panel_->arrows) {
        add(arrow.x, arrow.y);
        add(arrow.x + arrow.dx, arrow.y + arrow.dy);
    }
    for (const Label& label : panel_->labels) {
        add(label.x, label.y);
    }
    empty_ = x.empty();
    data_x_ = range_of(panel_->x, x, "x");
    data_y_ = range_of(panel_->y, y, "y");
}

void PanelPlan::fit_ranges() {
    x_ = data_x_;
    y_ = data_y_;
    const double width = width_ - left_ - kPlotRight;
    if (panel_->equal_aspect) {
        const double per_px =
            std::max((x_.high - x_.low) / width, (y_.high - y_.low) / panel_->height);
        const auto widen = [&](AxisRange& range, double size) {
            const double more = 0.5 * (per_px * size - (range.high - range.low));
            range.low -= more;
            range.high += more;
        };
        widen(x_, width);
        widen(y_, panel_->height);
    }
    x_ticks_ = nice_ticks(x_, static_cast<int>(width / 80.0));
    y_ticks_ = nice_ticks(y_, static_cast<int>(panel_->height / 45.0));
    name_ticks(panel_->x, x_, x_ticks_);
    name_ticks(panel_->y, y_, y_ticks_);
}

void PanelPlan::share_x(PanelPlan& other) {
    const auto same = [](const Panel& a, const Panel& b) {
        return !a.equal_aspect && !b.equal_aspect && a.x.label == b.x.label &&
               a.x.unit == b.x.unit && a.x.log == b.x.log;
    };
    if (!same(*panel_, *other.panel_) || empty_ || other.empty_) {
        return;
    }
    const double low = std::min(data_x_.low, other.data_x_.low);
    const double high = std::max(data_x_.high, other.data_x_.high);
    for (PanelPlan* plan : {this, &other}) {
        plan->data_x_.low = plan->panel_->x.low.value_or(low);
        plan->data_x_.high = plan->panel_->x.high.value_or(high);
    }
}

void PanelPlan::align(double left) {
    left_ = left;
    fit_ranges();
    plan_legend();
}

double PanelPlan::header() const {
    return (panel_->title.empty() ? 0.0 : kLine + 3.0) + legend_rows_ * kLine + 6.0;
}

double PanelPlan::footer() const {
    return panel_->x.label.empty() && panel_->x.unit.empty() ? 24.0 : 40.0;
}

std::string PanelPlan::axes(std::string_view clip_id) const {
    const Rect& plot = plot_;
    std::string out = fmt::format(
        "<clipPath id=\"{0}\"><rect x=\"{1}\" y=\"{2}\" width=\"{3}\" height=\"{4}\"/></clipPath>\n"
        "<rect class=\"plot\" x=\"{1}\" y=\"{2}\" width=\"{3}\" height=\"{4}\" fill=\"none\" "
        "stroke=\"#444444\"/>\n",
        clip_id, px(plot.x), px(plot.y), px(plot.width), px(plot.height));
    std::string grid;
    std::string strokes;
    const double bottom = plot.y + plot.height;
    for (const AxisTick& tick : x_ticks_.ticks) {
        const double x = plot.x + plot.width * x_.share(tick.at);
        const bool major = !tick.label.empty();
        strokes += fmt::format("M{} {}v{}", px(x), px(bottom), major ? "5" : "3");
        if (major) {
            grid += fmt::format("M{} {}V{}", px(x), px(plot.y), px(bottom));
            out += svg_text(x, bottom + 17.0, tick.label, kTextSize, Anchor::middle);
        }
    }
    for (const AxisTick& tick : y_ticks_.ticks) {
        const double y = bottom - plot.height * y_.share(tick.at);
        const bool major = !tick.label.empty();
        strokes += fmt::format("M{} {}h{}", px(plot.x), px(y), major ? "-5" : "-3");
        if (major) {
            grid += fmt::format("M{} {}H{}", px(plot.x), px(y), px(plot.x + plot.width));
            out += svg_text(plot.x - 8.0, y + 4.0, tick.label, kTextSize, Anchor::end);
        }
    }
    if (!grid.empty()) {
        out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#e4e4e4\"/>\n", grid);
    }
    if (!strokes.empty()) {
        out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#444444\"/>\n", strokes);
    }
    out += svg_text(plot.x + plot.width / 2.0, bottom + 34.0,
                    axis_label(panel_->x, x_ticks_.exponent), kTextSize, Anchor::middle);
    const double label_x = plot.x - left_ + 11.0;
    const double label_y = plot.y + plot.height / 2.0;
    out += svg_text(label_x, label_y, axis_label(panel_->y, y_ticks_.exponent), kTextSize,
                    Anchor::middle,
                    fmt::format("transform=\"rotate(-90 {} {})\"", px(label_x), px(label_y)));
    if (empty_) {
        out += svg_text(plot.x + plot.width / 2.0, label_y, "no data", kTextSize, Anchor::middle,
                        "fill=\"#777777\"");
    }
    return out;
}

std::string PanelPlan::draw(double cell_x, double top, std::string_view clip_id) {
    plot_ = {cell_x + left_, top, width_ - left_ - kPlotRight, panel_->height};
    std::string out = "<g class=\"panel\">\n";
    if (!panel_->title.empty()) {
        out += svg_text(plot_.x, top - header() + 14.0, panel_->title, kTitleSize, Anchor::start,
                        "font-weight=\"bold\"");
    }
    out += axes(clip_id) + legend();
    out += fmt::format("<g clip-path=\"url(#{})\">\n", clip_id);
    for (const Shade& shade : panel_->shades) {
        if (x_.holds(shade.from) && x_.holds(shade.to)) {
            const double a = std::clamp(x_.share(std::min(shade.from, shade.to)), 0.0, 1.0);
            const double b = std::clamp(x_.share(std::max(shade.from, shade.to)), 0.0, 1.0);
            out += fmt::format(
                "<rect class=\"shade\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\" "
                "fill-opacity=\"0.18\"/>\n",
                px(plot_.x + plot_.width * a), px(plot_.y), px(plot_.width * (b - a)),
                px(plot_.height), colour(shade.ink, 7));
        }
    }
    for (const Band& shaded : panel_->bands) {
        out += band(shaded);
    }
    for (std::size_t i = 0; i < panel_->series.size(); ++i) {
        const Series& series = panel_->series[i];
        const std::string_view ink = colour(series.ink, i);
        if (series.mark != Mark::points) {
            out += line(series, ink);
        }
        if (series.mark != Mark::line) {
            out += points(series, ink);
        }
    }
    return out + arrows() + "</g>\n" + labels() + markers() + "</g>\n";
}

void PanelPlan::plan_legend() {
    entries_.clear();
    const auto known = [&](const std::string& name) {
        return name.empty() || std::ranges::find(entries_, name, &Entry::name) != entries_.end();
    };
    for (std::size_t i = 0; i < panel_->series.size(); ++i) {
        const Series& s = panel_->series[i];
        if (!known(s.name)) {
            entries_.push_back({s.name, colour(s.ink, i),
                                s.mark == Mark::points ? Entry::Kind::points : Entry::Kind::line,
                                s.stroke});
        }
    }
    const auto add = [&](const auto& all, std::size_t turn, Entry::Kind kind) {
        for (const auto& one : all) {
            if (!known(one.name)) {
                entries_.push_back({one.name, colour(one.ink, turn), kind});
            }
        }
    };
    add(panel_->arrows, 6, Entry::Kind::arrow);
    add(panel_->shades, 7, Entry::Kind::shade);
    add(panel_->bands, 7, Entry::Kind::shade);
    double x = 0.0;
    int row = 0;
    const double width = width_ - left_ - kPlotRight;
    for (Entry& entry : entries_) {
        const double need = kSample + 5.0 + text_width(entry.name, kTextSize);
        if (x > 0.0 && x + need > width) {
            x = 0.0;
            ++row;
        }
        entry.x = x;
        entry.row = row;
        x += need + 16.0;
    }
    legend_rows_ = entries_.empty() ? 0 : row + 1;
}

std::string PanelPlan::legend() const {
    std::string out;
    for (const Entry& e : entries_) {
        const double x = plot_.x + e.x;
        const double y = plot_.y - 6.0 - (legend_rows_ - 1 - e.row) * kLine - 4.0;
        switch (e.kind) {
            case Entry::Kind::points:
                out += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"3\" fill=\"{}\"/>\n",
                                   px(x + kSample / 2.0), px(y), e.colour);
                break;
            case Entry::Kind::shade:
                out += fmt::format(
                    "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"10\" fill=\"{}\" "
                    "fill-opacity=\"0.18\"/>\n",
                    px(x), px(y - 5.0), px(kSample), e.colour);
                break;
            case Entry::Kind::arrow:
                out += fmt::format(
                    "<path d=\"M{0} {1}H{2}\" stroke=\"{4}\" stroke-width=\"1.4\"/>"
                    "<path d=\"M{3} {1}l-7 -3.2v6.4z\" fill=\"{4}\"/>\n",
                    px(x), px(y), px(x + kSample - 7.0), px(x + kSample), e.colour);
                break;
            case Entry::Kind::line:
                out += fmt::format(
                    "<path d=\"M{} {}h{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{}/>\n",
                    px(x), px(y), px(kSample), e.colour,
                    e.stroke == Stroke::dashed   ? " stroke-dasharray=\"6 4\""
                    : e.stroke == Stroke::dotted ? " stroke-dasharray=\"1.5 3\""
                                                 : "");
                break;
        }
        out += svg_text(x + kSample + 5.0, y + 4.0, e.name, kTextSize);
    }
    return out;
}

}  // namespace palpate::data
