#pragma once

#include "tests/support/std.hpp"

namespace palpate::tests {

/// What a screen shows, from its upper left corner, row by row.
struct ScreenImage {
    int width = 0;
    int height = 0;
    std::vector<std::uint32_t> pixels{};  ///< 0xRRGGBB

    [[nodiscard]] std::uint32_t at(int x, int y) const {
        return pixels.at(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                         static_cast<std::size_t>(x));
    }

    friend bool operator==(const ScreenImage&, const ScreenImage&) = default;
};

/// @throws std::runtime_error if it is no picture
[[nodiscard]] ScreenImage read_png(const std::string& file);

}  // namespace palpate::tests
