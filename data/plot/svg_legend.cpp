#include <algorithm>

#include <fmt/format.h>

#include "data/plot/svg_panel.hpp"
#include "data/plot/svg_text.hpp"

namespace palpate::data {
namespace {

constexpr double kSample = 22.0;  // px of an entry's sample

}  // namespace

void PanelPlan::plan_legend() {
    entries_.clear();
    const auto known = [&](const std::string& name) {
        return name.empty() || std::any_of(entries_.begin(), entries_.end(),
                                           [&](const Entry& e) { return e.name == name; });
    };
    for (std::size_t i = 0; i < panel_->series.size(); ++i) {
        const Series& s = panel_->series[i];
        if (!known(s.name)) {
            entries_.push_back({s.name, colour(s.ink, i),
                                s.mark == Mark::points ? Entry::Kind::points : Entry::Kind::line,
                                s.stroke});
        }
    }
    for (const Arrow& arrow : panel_->arrows) {
        if (!known(arrow.name)) {
            entries_.push_back({arrow.name, colour(arrow.ink, 6), Entry::Kind::arrow});
        }
    }
    for (const Shade& shade : panel_->shades) {
        if (!known(shade.name)) {
            entries_.push_back({shade.name, colour(shade.ink, 7), Entry::Kind::shade});
        }
    }
    for (const Band& band : panel_->bands) {
        if (!known(band.name)) {
            entries_.push_back({band.name, colour(band.ink, 7), Entry::Kind::shade});
        }
    }
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

std::string PanelPlan::legend(const Rect& plot) const {
    std::string out;
    for (const Entry& e : entries_) {
        const double x = plot.x + e.x;
        const double y = plot.y - 6.0 - (legend_rows_ - 1 - e.row) * kLine - 4.0;
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
