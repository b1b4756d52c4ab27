#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/plot/svg_panel.hpp"

namespace palpate::data {
namespace {

/// Bytes of the character at `at`, 0 if there is none: U+FFFE and U+FFFF are none of XML.
std::size_t character_length(std::string_view text, std::size_t at) {
    const std::string_view rest = text.substr(at);
    return rest.starts_with("\xEF\xBF\xBE") || rest.starts_with("\xEF\xBF\xBF") ? 0
                                                                                : utf8_length(rest);
}

/// Advance of one ASCII letter, as a share of the font size.
double advance(char c) {
    const std::string_view text(&c, 1);
    const auto among = [&](std::string_view set) {
        return set.find(text) != std::string_view::npos;
    };
    return among("ijl'|.,:; ")                   ? 0.32
         : among("frtI()[]!/\\-\"")              ? 0.41
         : among("mw%@MW")                       ? 0.96
         : among("ABCDEFGHJKLNOPQRSTUVXYZ+=<>~") ? 0.74
                                                 : 0.62;
}

/// A share of a step by which a tick may lie beyond the axis: rounding of low / step.
constexpr double kSlack = 1e-9;

AxisTicks linear_ticks(const AxisRange& range, int wanted) {
    const double raw = (range.high - range.low) / std::max(wanted, 1);
    int power = static_cast<int>(std::floor(std::log10(raw)));
    const double mantissa = raw / std::pow(10.0, power);
    int digit = mantissa < 1.5 ? 1 : mantissa < 3.5 ? 2 : mantissa < 7.5 ? 5 : 10;
    if (digit == 10) {
        digit = 1;
        ++power;
    }
    const double step = digit * std::pow(10.0, power);

    AxisTicks out;
    const double max = std::max(std::fabs(range.low), std::fabs(range.high));
    if (max >= 1e5 || max < 1e-2) {
        out.exponent = 3 * static_cast<int>(std::floor(std::log10(max) / 3.0));
    }
    const int decimals = std::max(0, out.exponent - power);
    const double unit = digit * std::pow(10.0, power - out.exponent);
    const double first = std::ceil(range.low / step - kSlack);
    const double last = std::floor(range.high / step + kSlack);
    for (double k = first; k <= last; k += 1.0) {
        std::string label = fmt::format("{:.{}f}", k == 0.0 ? 0.0 : k * unit, decimals);
        if (label.front() == '-') {
            label.replace(0, 1, "−");
        }
        out.ticks.push_back({k * step, label});
    }
    return out;
}

AxisTicks log_ticks(const AxisRange& range, int wanted) {
    const int first = static_cast<int>(std::floor(std::log10(range.low) - kSlack));
    const int last = static_cast<int>(std::ceil(std::log10(range.high) + kSlack));
    const int every = std::max(1, (last - first) / std::max(wanted, 1));
    const bool plain = first >= -3 && last <= 4;                 // 0.001 to 10000 need no powers
    const bool close = plain && range.high < 100.0 * range.low;  // room to name 2 and 5 too
    AxisTicks out;
    for (int decade = first; decade <= last; ++decade) {
        for (int digit = 1; digit <= 9; ++digit) {
            const double at = digit * std::pow(10.0, decade);
            const bool named =
                (digit == 1 && decade % every == 0) || (close && (digit == 2 || digit == 5));
            if (at < range.low * (1.0 - kSlack) || at > range.high * (1.0 + kSlack) ||
                (digit > 1 && last - first > 8)) {
                continue;
            }
            const std::string label = plain ? fmt::format("{:.{}f}", at, std::max(0, -decade))
                                            : "10" + superscript(decade);
            out.ticks.push_back({at, named ? label : ""});
        }
    }
    return out;
}

}  // namespace

std::string xml_escaped(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = character_length(text, i);
        const char c = text[i];
        if (length == 0) {
            out += "\xEF\xBF\xBD";
        } else if (length > 1) {
            out += text.substr(i, length);
        } else if (c == '&') {
            out += "&amp;";
        } else if (c == '<') {
            out += "&lt;";
        } else if (c == '>') {
            out += "&gt;";
        } else if (c == '"') {
            out += "&quot;";
        } else if (c == '\'') {
            out += "&#39;";
        } else if (c >= ' ' || c == '\n' || c == '\t') {
            out += c;
        }
        i += length == 0 ? 1 : length;
    }
    return out;
}

std::string px(double value) {
    std::string text = fmt::format("{:.2f}", value);
    return text == "-0.00" ? "0.00" : text;
}

double text_width(std::string_view text, double size) {
    double width = 0.0;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = character_length(text, i);
        width += length == 1 ? advance(text[i]) : 0.64;
        i += length == 0 ? 1 : length;
    }
    return width * size;
}

std::vector<std::string> wrapped(std::string_view text, double width, double size) {
    std::vector<std::string> lines;
    std::string line;
    const auto flush = [&] {
        lines.push_back(line);
        line.clear();
    };
    for (std::size_t i = 0; i < text.size();) {
        if (text[i] == '\n') {
            flush();
            ++i;
            continue;
        }
        if (text[i] == ' ') {
            ++i;
            continue;
        }
        const std::size_t end = std::min(text.find_first_of(" \n", i), text.size());
        const std::string word(text.substr(i, end - i));
        if (!line.empty() && text_width(line + " " + word, size) > width) {
            flush();
        }
        line += (line.empty() ? "" : " ") + word;
        i = end;
    }
    if (!line.empty()) {
        flush();
    }
    return lines;
}

std::string superscript(int n) {
    constexpr std::string_view kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text;
    for (const char c : std::to_string(n)) {
        text += c == '-' ? std::string_view("⁻") : kDigits[c - '0'];
    }
    return text;
}

std::string svg_text(
    double x, double y, std::string_view text, double size, Anchor anchor, std::string_view extra) {
    const std::string_view where = anchor == Anchor::middle ? " text-anchor=\"middle\""
                                 : anchor == Anchor::end    ? " text-anchor=\"end\""
                                                            : "";
    return fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{:g}\"{}{}{}>{}</text>\n", px(x), px(y),
                       size, where, extra.empty() ? "" : " ", extra, xml_escaped(text));
}

double AxisRange::share(double value) const {
    return log ? std::log10(value / low) / std::log10(high / low) : (value - low) / (high - low);
}

bool AxisRange::holds(double value) const {
    return std::isfinite(value) && (!log || value > 0.0);
}

AxisTicks nice_ticks(const AxisRange& range, int wanted) {
    return range.log && range.high >= 10.0 * range.low ? log_ticks(range, wanted)
                                                       : linear_ticks(range, wanted);
}

}  // namespace palpate::data
