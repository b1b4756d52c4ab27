#include "data/export/number_text.hpp"

#include <cmath>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>

namespace palpate::data {
namespace {

/// What R makes of plain decimal text: all digits into a long double, then one scaling by a power
/// of ten.
double read_by_r(std::string_view text) {
    long double digits = 0.0L;
    int exponent = 0;
    bool fraction = false;
    std::size_t at = text.starts_with('-') ? 1 : 0;
    for (; at < text.size() && text[at] != 'e'; ++at) {
        if (text[at] == '.') {
            fraction = true;
            continue;
        }
        digits = 10.0L * digits + static_cast<long double>(text[at] - '0');
        exponent -= fraction ? 1 : 0;
    }
    if (at < text.size()) {
        exponent += std::atoi(std::string(text.substr(at + 1)).c_str());
    }
    long double scale = 1.0L;
    long double power = 10.0L;
    for (int left = std::abs(exponent); left > 0; left >>= 1, power *= power) {
        scale *= (left & 1) != 0 ? power : 1.0L;
    }
    const auto size = static_cast<double>(exponent < 0 ? digits / scale : digits * scale);
    return text.starts_with('-') ? -size : size;
}

}  // namespace

std::string number_text(double value) {
    std::string shortest = fmt::format("{}", value);
    if (!std::isfinite(value) || read_by_r(shortest) == value) {
        return shortest;
    }
    return fmt::format("{:.17e}", value);
}

}  // namespace palpate::data
