#include "ui/subject/paragraph.hpp"

#include <algorithm>

#include "engine/base/text.hpp"

namespace palpate::ui {
namespace {

/// Of the first character, at least 1.
std::size_t bytes_of(std::string_view text) {
    return std::max<std::size_t>(utf8_length(text), 1);
}

/// The longest beginning of `word` that is no wider than `width`, at least one character.
std::size_t fitting(Window& window, std::string_view word, double height, double width) {
    std::size_t end = bytes_of(word);
    while (end < word.size()) {
        const std::size_t next = end + bytes_of(word.substr(end));
        if (window.text_width(word.substr(0, next), height) > width) {
            break;
        }
        end = next;
    }
    return end;
}

void wrap_line(Window& window,
               std::string_view line,
               double height,
               double width,
               std::vector<std::string>& rows) {
    rows.emplace_back();
    while (!line.empty()) {
        const std::size_t begin = line.find_first_not_of(' ');
        if (begin == std::string_view::npos) {
            return;
        }
        line.remove_prefix(begin);
        std::string_view word = line.substr(0, line.find(' '));
        line.remove_prefix(word.size());
        const std::string longer =
            rows.back().empty() ? std::string(word) : rows.back() + ' ' + std::string(word);
        if (window.text_width(longer, height) <= width) {
            rows.back() = longer;
            continue;
        }
        if (!rows.back().empty()) {
            rows.emplace_back();
        }
        while (window.text_width(word, height) > width && word.size() > bytes_of(word)) {
            const std::size_t cut = fitting(window, word, height, width);
            rows.back() = std::string(word.substr(0, cut));
            rows.emplace_back();
            word.remove_prefix(cut);
        }
        rows.back() = std::string(word);
    }
}

}  // namespace

std::vector<std::string> wrapped(Window& window,
                                 std::string_view text,
                                 double height,
                                 double width) {
    std::vector<std::string> rows;
    for (;;) {
        const std::size_t end = text.find('\n');
        wrap_line(window, text.substr(0, end), height, width, rows);
        if (end == std::string_view::npos) {
            return rows;
        }
        text.remove_prefix(end + 1);
    }
}

double fitting_height(Window& window,
                      std::string_view text,
                      const engine::Vec2& size,
                      double height) {
    constexpr double kSmaller = 0.9;
    const auto rows = [&] {
        return static_cast<double>(wrapped(window, text, height, size.x).size());
    };
    while (rows() * kLeading * height > size.y && kSmaller * height >= kSmallestType) {
        height *= kSmaller;
    }
    return height;
}

double write_into(Window& window,
                  std::string_view text,
                  const Area& area,
                  double height,
                  Colour colour,
                  Align align) {
    height = fitting_height(window, text, area.size, height);
    const std::vector<std::string> rows = wrapped(window, text, height, area.size.x);
    const double taken = static_cast<double>(rows.size()) * kLeading * height;
    const double share = align == Align::left ? 0.0 : align == Align::centre ? 0.5 : 1.0;
    double y = area.corner.y + 0.5 * (area.size.y - taken) + 0.5 * kLeading * height;
    for (const std::string& row : rows) {
        window.text(row, {area.corner.x + share * area.size.x, y}, height, colour, align);
        y += kLeading * height;
    }
    return taken;
}

}  // namespace palpate::ui
