#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "data/page/study.hpp"
#include "data/plot/figure.hpp"
#include "data/statistics/distributions.hpp"
#include "data/tables/table.hpp"

/// Parts of the page as HTML.
namespace palpate::data {

/// What an analysis found, beside a figure.
struct Results {
    Table table{};
    std::string command{};  ///< which prints the same numbers
    std::string caption{};
    bool folded = false;
};

/// A figure with all that stands beside it.
struct PageFigure {
    std::string id{};     ///< letters, digits, -; also the CSV's name
    std::string title{};  ///< the heading, after "Figure 3. "
    std::vector<Panel> panels{};
    double width =
        370.0;  ///< of a panel, px, 200 or more: as many stand in a row as there is room for
    std::string html{};      ///< in place of panels
    bool has_table = false;  ///< `html` is the table
    std::string caption{};
    Rows data{};
    std::vector<Results> results{};
};

/// Text of any kind between tags.
[[nodiscard]] std::string html_text(std::string_view text);
/// "P05, sub-1" stays; "0.41999999" becomes "0.4200"; of whole numbers
/// all digits stay.
[[nodiscard]] std::string short_number(const std::string& field);
/// "0.012 to 0.340", three digits after the point.
[[nodiscard]] std::string interval_text(const Interval& interval);

/// One of the facts in boxes at the top, what it is below.
[[nodiscard]] std::string html_fact(const std::string& what,
                                    const std::string& value,
                                    const std::string& small);

/// Where in contact: before the vertex, on it, after it, of a row of the view exploration. Empty:
/// nowhere.
[[nodiscard]] std::string html_bar(const Rows& rows, std::size_t row);

/// A table with a caption; columns of numbers to the right.
[[nodiscard]] std::string html_table(const std::vector<std::string>& names,
                                     const std::vector<std::vector<std::string>>& cells,
                                     std::string_view caption);

/// What stands round the sections of a page; texts are plain.
struct PageFrame {
    std::string kind{};     ///< of its sessions: real, or in a watermark
    std::string version{};  ///< of the program
    std::string kicker{};   ///< above the heading
    std::string title{};    ///< the heading
    std::string name{};     ///< of the window; empty: the heading
    std::string footer{};
    std::string style{};   ///< CSS after page_style()
    std::string script{};  ///< the only one that a browser may run there; empty: none may
};

/// The figures of a page, numbered, and its sections.
class PageWriter {
public:
    /// @param study  outlives this
    explicit PageWriter(const Study& study) : study_(&study) {}

    /// Begins a section, which has its link `id` in the page's contents.
    void section(std::string_view id, std::string_view title);
    void paragraph(std::string_view text);  ///< plain text
    void html(std::string_view html) { body_ += html; }
    /// Refused where nothing of it can be drawn: a figure has a table, CSV and SQL.
    void figure(const PageFigure& figure);
    /// A table alone, with CSV and SQL.
    void table(std::string_view id,
               std::string_view title,
               std::string_view caption,
               const Rows& rows);

    /// The sections of another come after those of this one.
    void append(const PageWriter& rest);

    /// The whole page, figures and tables counted.
    [[nodiscard]] std::string page(const PageFrame& frame) const;

private:
    enum class Folding : std::uint8_t { open, folded, no };  ///< the table
    [[nodiscard]] std::string sources(std::string_view id,
                                      std::string_view title,
                                      const Rows& rows,
                                      Folding shown) const;
    [[nodiscard]] std::string csv_link(std::string_view id, std::string_view csv) const;
    void close_section();
    void add_results(const Results& results, const std::string& id);

    const Study* study_;
    std::string body_;
    std::string contents_;
    bool open_ = false;
};

/// The page's style sheet, style.css. Figures keep the inks of data/plot (Okabe & Ito), lighter on
/// a dark page; on paper the page is light, and the watermark stands on every sheet.
[[nodiscard]] std::string_view page_style();

// Numbers of every tick as text of a page, some one and a half bytes each; trial_script.js reads
// them.

/// In place of a number that there is not.
inline constexpr std::int64_t kNoNumber = std::numeric_limits<std::int32_t>::min();

/// Base64 of: a byte `order`, then what a straight line through the values before (order 2), the
/// value before (1) or nothing (0) leaves of each value, what is before the first being 0. Each is
/// folded (0, -1, 1, -2 are 0, 1, 2, 3) and stands in groups of 7 bits, the lowest first, all but
/// the last with 128 added; after a 0 comes in the same way how many more follow. The order is the
/// one with the fewest bytes.
/// @param values  |value| < 2^50
[[nodiscard]] std::string tick_text(std::span<const std::int64_t> values);

}  // namespace palpate::data
