#include "data/page/html.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>
#include <nettle/base64.h>

#include "engine/base/sha256.hpp"
#include "engine/base/text.hpp"
#include "data/plot/svg_panel.hpp"

namespace palpate::data {
namespace {

/// Where a figure's or a table's number will stand; no text of a page has such a character.
constexpr char kFigureNumber = '\1';
constexpr char kTableNumber = '\2';

std::string numbered(const std::string& body) {
    std::string out;
    int figures = 0;
    int tables = 0;
    for (const char c : body) {
        out += c == kFigureNumber ? std::to_string(++figures)
             : c == kTableNumber  ? std::to_string(++tables)
                                  : std::string(1, c);
    }
    return out;
}

/// Names of columns as words: "share_low" is "share low".
std::string words_of(std::string name) {
    constexpr std::pair<const char*, const char*> kShort[] = {{"t_p", "p (t)"},
                                                              {"sign_flip_p", "p (flip)"},
                                                              {"wilcoxon_v", "V"},
                                                              {"wilcoxon_p", "p (ranks)"},
                                                              {"bayes_factor_10", "BF10"}};
    for (const auto& [column, words] : kShort) {
        if (name == column) {
            return words;
        }
    }
    std::ranges::replace(name, '_', ' ');
    return name;
}

/// A file inside the page. What would end the attribute or act in an address is escaped.
std::string data_address(std::string_view type, std::string_view text) {
    std::string out = fmt::format("data:{};charset=utf-8,", type);
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool plain = byte > 0x20 && byte < 0x7f &&
                           std::string_view("%#\"&<>'`").find(c) == std::string_view::npos;
        out += plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
    }
    return out;
}

/// RFC 4648, with its padding.
std::string base64(std::string_view bytes) {
    std::string out(BASE64_ENCODE_RAW_LENGTH(bytes.size()), '\0');
    base64_encode_raw(out.data(), bytes.size(),
                      reinterpret_cast<const std::uint8_t*>(bytes.data()));
    return out;
}

/// What a page's policy calls the one script that may run.
std::string script_hash(std::string_view script) {
    const Sha256 hash = sha256(script);
    return "sha256-" +
           base64(std::string_view(reinterpret_cast<const char*>(hash.data()), hash.size()));
}

/// A panel as an element of the page: no background, no address, a name for who cannot see it.
std::string panel_html(const Panel& panel,
                       const std::string& id,
                       const std::string& title,
                       double width,
                       const std::string& mark) {
    constexpr double kEdge = 10.0;  // px round it
    PanelPlan plan(panel, width - 2.0 * kEdge);
    plan.align(plan.left());
    const double top = kEdge + plan.header();
    const double height = top + panel.height + plan.footer() + kEdge;
    return fmt::format(
        "<svg viewBox=\"0 0 {} {}\" aria-label=\"{}. The table below has its numbers.\" "
        "role=\"img\">\n{}{}</svg>\n",
        px(width), px(height), html_text(panel.title.empty() ? title : title + ": " + panel.title),
        plan.draw(kEdge, top, fmt::format("f-{}-clip0", id)),
        mark.empty()
            ? std::string()
            : svg_text(width - 6.0, height - 3.0, mark, 10.0, Anchor::end, "class=\"mark\""));
}

void put(std::string& bytes, std::uint64_t number) {
    while (number > 127) {
        bytes += static_cast<char>(number % 128 + 128);
        number /= 128;
    }
    bytes += static_cast<char>(number);
}

std::string bytes_of(std::span<const std::int64_t> values, int order) {
    std::string bytes(1, static_cast<char>(order));
    std::int64_t last = 0;
    std::int64_t before = 0;
    std::uint64_t zeros = 0;
    const auto end_zeros = [&] {
        if (zeros > 0) {
            put(bytes, 0);
            put(bytes, zeros - 1);
            zeros = 0;
        }
    };
    for (const std::int64_t value : values) {
        const std::int64_t guess = order == 0 ? 0 : order == 1 ? last : 2 * last - before;
        const std::int64_t rest = value - guess;
        before = last;
        last = value;
        if (rest == 0) {
            ++zeros;
            continue;
        }
        end_zeros();
        put(bytes, rest < 0 ? 2 * static_cast<std::uint64_t>(-(rest + 1)) + 1
                            : 2 * static_cast<std::uint64_t>(rest));
    }
    end_zeros();
    return bytes;
}

}  // namespace

std::string html_text(std::string_view text) {
    return xml_escaped(plain(std::string(text), Lines::kept));
}

std::string short_number(const std::string& field) {
    const std::optional<double> number = parsed<double>(field);
    if (!number) {
        return field;
    }
    const double value = *number;
    const double size = std::fabs(value);
    std::string text = field.find_first_of(".e") == std::string::npos ? field
                     : value != 0.0 && size < 1e-3                    ? fmt::format("{:.2g}", value)
                     : size < 10.0                                    ? fmt::format("{:.3f}", value)
                     : size < 1000.0                                  ? fmt::format("{:.1f}", value)
                                     : fmt::format("{:.0f}", value);
    if (text.front() == '-') {
        text.replace(0, 1, "\u2212");
    }
    return text;
}

std::string interval_text(const Interval& interval) {
    return replaced(fmt::format("{:.3f} to {:.3f}", interval.low, interval.high), "-", "\u2212");
}

std::string html_fact(const std::string& what, const std::string& value, const std::string& small) {
    return fmt::format("<div><dt>{}</dt><dd>{}<small>{}</small></dd></div>\n", html_text(what),
                       html_text(value), html_text(small));
}

std::string html_bar(const Rows& rows, std::size_t row) {
    const double before = rows.number(row, "before_vertex_s");
    const double vertex = rows.number(row, "vertex_s");
    const double all = before + vertex + rows.number(row, "after_vertex_s");
    return all > 0.0 ? fmt::format("<span class=\"bar\" style=\"--a:{:.1f}%;--b:{:.1f}%\"></span>",
                                   100.0 * before / all, 100.0 * (before + vertex) / all)
                     : std::string();
}

std::string html_table(const std::vector<std::string>& names,
                       const std::vector<std::vector<std::string>>& cells,
                       std::string_view caption) {
    std::vector<bool> number(names.size(), !cells.empty());
    for (const auto& row : cells) {
        for (std::size_t i = 0; i < names.size(); ++i) {
            number[i] = number[i] && (row[i].empty() || parsed<double>(row[i]).has_value());
        }
    }
    constexpr std::size_t kHash = 64;  // digits of a SHA-256
    std::string out = fmt::format(
        "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{0}\">\n<table>\n"
        "<caption>{0}</caption>\n<thead><tr>",
        html_text(caption));
    for (std::size_t i = 0; i < names.size(); ++i) {
        out += fmt::format("<th scope=\"col\"{}>{}</th>", number[i] ? " class=\"n\"" : "",
                           html_text(words_of(names[i])));
    }
    out += "</tr></thead>\n<tbody>\n";
    for (const auto& row : cells) {
        out += "<tr>";
        for (std::size_t i = 0; i < names.size(); ++i) {
            out += fmt::format(
                "<{0}{1}>{2}</{3}>", i == 0 ? "th scope=\"row\"" : "td",
                number[i]                ? " class=\"n\""
                : row[i].size() == kHash ? " class=\"hash\""
                                         : "",
                row[i].empty() ? "\u2013" : html_text(number[i] ? short_number(row[i]) : row[i]),
                i == 0 ? "th" : "td");
        }
        out += "</tr>\n";
    }
    return out + "</tbody>\n</table>\n</div>\n";
}

void PageWriter::append(const PageWriter& rest) {
    close_section();
    body_ += rest.body_;
    contents_ += rest.contents_;
    open_ = rest.open_;
}

void PageWriter::close_section() {
    body_ += open_ ? "</section>\n" : "";
    open_ = false;
}

void PageWriter::section(std::string_view id, std::string_view title) {
    close_section();
    open_ = true;
    body_ += fmt::format("<section aria-labelledby=\"{0}\">\n<h2 id=\"{0}\">{1}</h2>\n", id,
                         html_text(title));
    contents_ += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", id, html_text(title));
}

void PageWriter::paragraph(std::string_view text) {
    body_ += fmt::format("<p>{}</p>\n", html_text(text));
}

std::string PageWriter::sources(std::string_view id,
                                std::string_view title,
                                const Rows& rows,
                                Folding shown) const {
    const std::string table =
        html_table(rows.names, rows.cells, fmt::format("{}: the data", title));
    std::string out = shown == Folding::open ? table : "";
    out += "<div class=\"sources\">\n";
    if (shown == Folding::folded) {
        out += fmt::format("<details class=\"data\"><summary>Table ({})</summary>\n{}</details>\n",
                           counted(rows.cells.size(), "row"), table);
    }
    return out + fmt::format(
                     "<details class=\"sql\"><summary>SQL</summary>\n<pre "
                     "tabindex=\"0\"><code>{}</code></pre></details>\n"
                     "{}\n</div>\n",
                     html_text(rows.sql), csv_link(html_text(id), rows.csv));
}

std::string PageWriter::csv_link(std::string_view id, std::string_view csv) const {
    const std::string& kind = study_->options.kind;
    return fmt::format("<a class=\"csv\" download=\"{}{}.csv\" href=\"{}\">CSV</a>",
                       kind == "real" ? "" : kind + "-", id, data_address("text/csv", csv));
}

void PageWriter::add_results(const Results& results, const std::string& id) {
    if (results.table.rows.empty()) {
        return;  // one friction: nothing is compared
    }
    const Fields fields = fields_of(results.table);
    const std::string captions =
        html_table(fields.names, fields.rows, results.caption) +
        fmt::format("<p class=\"from\">The same numbers: <code>{}</code> {}</p>\n",
                    html_text(results.command), csv_link(id, table_csv(fields)));
    body_ += results.folded
               ? fmt::format("<details class=\"more\"><summary>{}</summary>\n{}</details>\n",
                             html_text(results.caption), captions)
               : captions;
}

void PageWriter::figure(const PageFigure& figure) {
    const std::string& kind = study_->options.kind;
    const std::string mark = kind == "real" ? "" : kind + " data";
    body_ += fmt::format(
        "<figure id=\"{0}\" aria-labelledby=\"{0}-h\">\n<h3 id=\"{0}-h\">Figure {1}. {2}</h3>\n",
        figure.id, kFigureNumber, html_text(figure.title));
    body_ += figure.html;
    if (!figure.panels.empty()) {
        body_ += fmt::format("<div class=\"panels\" style=\"--w:{}px\">\n", figure.width);
        for (std::size_t i = 0; i < figure.panels.size(); ++i) {
            body_ += panel_html(figure.panels[i], fmt::format("{}-{}", figure.id, i), figure.title,
                                figure.width, mark);
        }
        body_ += "</div>\n";
    }
    body_ += fmt::format("<figcaption>{}</figcaption>\n", html_text(figure.caption));
    for (std::size_t i = 0; i < figure.results.size(); ++i) {
        add_results(figure.results[i], figure.results.size() == 1
                                           ? figure.id + "-results"
                                           : fmt::format("{}-results-{}", figure.id, i + 1));
    }
    body_ += sources(figure.id, figure.title, figure.data,
                     figure.has_table ? Folding::no : Folding::folded);
    body_ += "</figure>\n";
}

void PageWriter::table(std::string_view id,
                       std::string_view title,
                       std::string_view caption,
                       const Rows& rows) {
    body_ += fmt::format("<div class=\"table\" id=\"{0}\">\n<h3>Table {1}. {2}</h3>\n<p>{3}</p>\n",
                         id, kTableNumber, html_text(title), html_text(caption));
    constexpr std::size_t kShown = 60;  // rows; a longer table is folded
    body_ +=
        sources(id, title, rows, rows.cells.size() <= kShown ? Folding::open : Folding::folded);
    body_ += "</div>\n";
}

std::string PageWriter::page(const PageFrame& frame) const {
    const bool real = frame.kind == "real";
    std::string out = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"color-scheme\" content=\"light dark\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
        "'unsafe-inline'{}\">\n"
        "<meta name=\"generator\" content=\"palpate {}\">\n<title>{}{}</title>\n<style>\n\n{}{}",
        frame.script.empty() ? "" : fmt::format("; script-src '{}'", script_hash(frame.script)),
        html_text(frame.version), html_text(frame.name.empty() ? frame.title : frame.name),
        real ? "" : html_text(" (" + frame.kind + " data)"), page_style(), frame.style);
    if (!real) {
        std::string word = frame.kind;
        std::ranges::transform(word, word.begin(),
                               [](char c) { return static_cast<char>(c - 'a' + 'A'); });
        out += fmt::format("body::after {{ content: \"{}\"; }}\n", word);
    }
    out += fmt::format(
        "</style>\n</head>\n<body class=\"{}\">\n<header>\n<p "
        "class=\"kicker\">{}</p>\n<h1>{}</h1>\n",
        frame.kind, html_text(frame.kicker), html_text(frame.title));
    if (frame.kind == "simulated") {
        out +=
            "<p class=\"warning\" role=\"note\"><strong>Simulated data.</strong> The hand "
            "was computed, or the board an emulator: nobody felt anything, whoever answered. "
            "Nothing here is a result.</p>\n";
    } else if (!real) {
        out +=
            "<p class=\"warning\" role=\"note\"><strong>Pilot data.</strong> Sessions to try the "
            "study: no result follows from them.</p>\n";
    }
    out += fmt::format(
        "</header>\n<nav aria-label=\"Contents\">\n<ol>\n{}</ol>\n</nav>\n<main>\n{}{}</main>\n"
        "<footer><p>{}</p></footer>\n",
        contents_, numbered(body_), open_ ? "</section>\n" : "", html_text(frame.footer));
    out += frame.script.empty() ? "" : fmt::format("<script>{}</script>\n", frame.script);
    return out + "</body>\n</html>\n";
}

std::string tick_text(std::span<const std::int64_t> values) {
    std::string best = bytes_of(values, 0);
    for (const int order : {1, 2}) {
        std::string other = bytes_of(values, order);
        if (other.size() < best.size()) {
            best = std::move(other);
        }
    }
    return base64(best);
}

}  // namespace palpate::data
