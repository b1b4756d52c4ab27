#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/geometry/vec.hpp"
#include "data/plot/figure.hpp"

namespace palpate::data {

/// `text` for XML: the five special characters as entities, control characters left out, bytes that
/// are no UTF-8 as U+FFFD.
[[nodiscard]] std::string xml_escaped(std::string_view text);

/// A coordinate or size with two decimals, never "-0.00".
[[nodiscard]] std::string px(double value);

/// Width of `text` in a sans-serif font of `size` px, from a table of letter classes: DejaVu Sans,
/// which is wide, so that most other fonts take less.
[[nodiscard]] double text_width(std::string_view text, double size);

/// Lines of at most `width` px, broken at spaces (a longer word stands alone) and at "\n".
[[nodiscard]] std::vector<std::string> wrapped(std::string_view text, double width, double size);

/// `n` in superscript digits: "⁻³".
[[nodiscard]] std::string superscript(int n);

enum class Anchor { start, middle, end };

/// One <text> element; `text` is escaped here. `extra`: further attributes, as they are.
[[nodiscard]] std::string svg_text(double x,
                                   double y,
                                   std::string_view text,
                                   double size,
                                   Anchor anchor = Anchor::start,
                                   std::string_view extra = {});

/// The stretch of numbers an axis shows, low < high; on a log axis low > 0.
struct AxisRange {
    double low = 0.0;
    double high = 1.0;
    bool log = false;

    /// Place of `value` along the axis: 0 at low, 1 at high.
    [[nodiscard]] double share(double value) const;
    /// Can be drawn: finite, and above 0 on a log axis.
    [[nodiscard]] bool holds(double value) const;
};

/// A mark on an axis.
struct AxisTick {
    double at = 0.0;
    std::string label;  ///< empty for a minor tick
};

/// All marks of an axis, rising.
struct AxisTicks {
    std::vector<AxisTick> ticks;
    int exponent = 0;  ///< labels are values / 10^exponent; a multiple of 3
};

/// Ticks at 1, 2 or 5 times a power of ten, about `wanted` of them. A log axis has its decades
/// labelled (every n-th if there are many) and minor ticks at 2 to 9; within less than a decade its
/// ticks are those of a linear one.
[[nodiscard]] AxisTicks nice_ticks(const AxisRange& range, int wanted);

inline constexpr double kTitleSize = 13.0;  ///< px, of text
inline constexpr double kTextSize = 11.5;   ///< px
inline constexpr double kLine = 17.0;       ///< px from one line of text to the next

/// "#rrggbb" of an ink; `automatic` as the colour of place `turn`.
[[nodiscard]] std::string_view colour(Ink ink, std::size_t turn);

/// What a panel shows on its axes, and how much room they and its legend need.
class PanelPlan {
public:
    /// @param width  of the whole cell, px
    /// @throws std::invalid_argument as svg()
    PanelPlan(const Panel& panel, double width);

    [[nodiscard]] double left() const { return left_; }  ///< of the plot area, for its labels
    [[nodiscard]] double header() const;                 ///< title and legend above it
    [[nodiscard]] double footer() const;                 ///< tick labels and label below it
    [[nodiscard]] const Panel& panel() const { return *panel_; }

    /// The x axis of this panel is to show the same as that of `other`: both get the wider range.
    void share_x(PanelPlan& other);

    /// Leaves `left` px for labels, so that panels below one another line up, and fits ranges to
    /// it.
    void align(double left);

    /// The panel with its plot area's top left corner at (cell_x + left(), top).
    [[nodiscard]] std::string draw(double cell_x, double top, std::string_view clip_id);

private:
    struct Entry {
        std::string name;
        std::string_view colour;
        enum class Kind { line, points, shade, arrow } kind = Kind::line;
        Stroke stroke = Stroke::solid;
        double x = 0.0;  ///< from the left of the plot area
        int row = 0;
    };
    using Point = engine::Vec2;  ///< on the page, px, y downwards

    /// The plot area.
    struct Rect {
        double x = 0.0;
        double y = 0.0;
        double width = 0.0;
        double height = 0.0;
    };

    void find_ranges();
    void fit_ranges();
    void plan_legend();
    [[nodiscard]] bool holds(double x, double y) const { return x_.holds(x) && y_.holds(y); }
    [[nodiscard]] Point place(double x, double y) const;
    [[nodiscard]] std::string axes(std::string_view clip_id) const;
    [[nodiscard]] std::string legend() const;
    [[nodiscard]] std::string line(const Series& series, std::string_view ink) const;
    [[nodiscard]] std::string points(const Series& series, std::string_view ink) const;
    [[nodiscard]] std::string band(const Band& shaded) const;
    [[nodiscard]] std::string arrows() const;
    [[nodiscard]] std::string labels() const;
    [[nodiscard]] std::string markers() const;
    [[nodiscard]] std::vector<Point> ink() const;
    [[nodiscard]] Point label_place(const Point& dot,
                                    const std::vector<Point>& ink,
                                    const std::vector<Point>& dots,
                                    const std::vector<Point>& labels) const;

    const Panel* panel_;
    double width_ = 0.0;
    double left_ = 0.0;
    Rect plot_{};       ///< as it is drawn
    AxisRange data_x_;  ///< before widening for equal aspect
    AxisRange data_y_;
    AxisRange x_;
    AxisRange y_;
    AxisTicks x_ticks_;
    AxisTicks y_ticks_;
    bool empty_ = false;
    std::vector<Entry> entries_;
    int legend_rows_ = 0;
};

/// Room right of the plot area, px: half of the last tick's label.
inline constexpr double kPlotRight = 18.0;

}  // namespace palpate::data
