#include "protocols/file/toml_text.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace palpate::protocols {
namespace {

/// Empty if `si` is no quotient.
std::string shortest(double si, double per_si) {
    constexpr int kNeighbours = 2;  // si * per_si is at most one rounding away from y
    std::string best;
    double y = si * per_si;
    for (int i = 0; i < kNeighbours; ++i) {
        y = std::nextafter(y, -std::numeric_limits<double>::infinity());
    }
    for (int i = -kNeighbours; i <= kNeighbours; ++i) {
        const std::string text = fmt::format("{}", y + 0.0);
        if (y / per_si == si && (best.empty() || text.size() < best.size())) {
            best = text;
        }
        y = std::nextafter(y, std::numeric_limits<double>::infinity());
    }
    return best;
}

}  // namespace

std::string toml_text(double si, double per_si) {
    const std::string exact = shortest(si, per_si);
    return exact.empty() ? shortest(si * per_si / per_si, per_si) : exact;
}

std::string toml_text(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            quoted += '\\';
            quoted += c;
        } else if (byte < 0x20 || byte == 0x7f) {
            quoted += fmt::format("\\u{:04x}", byte);
        } else {
            quoted += c;
        }
    }
    return quoted + '"';
}

}  // namespace palpate::protocols
