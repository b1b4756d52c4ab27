#include "protocols/format/did_you_mean.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include <fmt/format.h>

namespace palpate::protocols {
namespace {

std::string lower(std::string_view text) {
    std::string out(text);
    for (char& c : out) {
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return out;
}

/// Levenshtein's distance, an exchange of two neighbours counted as two.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

}  // namespace

std::string suggestion(std::string_view unknown,
                       std::span<const std::string_view> known,
                       std::string_view otherwise) {
    constexpr std::size_t kLongest = 64;  // beyond any word of ours: no need to measure
    if (unknown.size() > kLongest) {
        return std::string(otherwise);
    }
    const std::string given = lower(unknown);
    std::string_view nearest;
    std::size_t least = std::max<std::size_t>(2, given.size() / 3) + 1;
    for (const std::string_view word : known) {
        // A forgotten unit is the commonest slip: stiffness for stiffness_n_per_m.
        const bool unit_forgotten = given.size() >= 3 && word.starts_with(given);
        const std::size_t distance = unit_forgotten ? 1 : edit_distance(given, lower(word));
        // A short word is near to everything: some of it must be right.
        if (distance < least && distance < std::max<std::size_t>(given.size(), 1)) {
            least = distance;
            nearest = word;
        }
    }
    return nearest.empty() ? std::string(otherwise) : fmt::format(": did you mean {}?", nearest);
}

std::string suggestion(std::string_view unknown,
                       std::span<const std::string> known,
                       std::string_view otherwise) {
    const std::vector<std::string_view> views(known.begin(), known.end());
    return suggestion(unknown, views, otherwise);
}

}  // namespace palpate::protocols
