#include "data/plot/svg_text.hpp"

#include <cstddef>

#include <fmt/format.h>

#include "engine/base/text.hpp"

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

}  // namespace palpate::data
