#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <string>

namespace palpate::engine {

/// A value as it stands in a message: nine digits, "nan" and "inf" included.
[[nodiscard]] inline std::string number_text(double value) {
    std::array<char, 32> text{};
    const int length = std::snprintf(text.data(), text.size(), "%.9g", value);
    return {text.data(), static_cast<std::size_t>(length)};
}

}  // namespace palpate::engine
