#include "protocols/design/counterbalance.hpp"

#include <algorithm>

#include "protocols/design/factorial.hpp"
#include "protocols/design/williams.hpp"

namespace palpate::protocols {

std::size_t choose_row(std::size_t rows, const RowHistory& history, Pcg32& random) {
    if (history.own && *history.own < rows) {
        return *history.own;
    }
    std::vector<std::size_t> uses = history.uses;
    uses.resize(rows, 0);
    const std::size_t least = *std::min_element(uses.begin(), uses.end());
    std::vector<std::size_t> candidates;
    for (std::size_t row = 0; row < rows; ++row) {
        if (uses[row] == least) {
            candidates.push_back(row);
        }
    }
    return candidates[random.bounded(static_cast<std::uint32_t>(candidates.size()))];
}

std::vector<std::vector<std::size_t>> picture_rows(const Protocol& protocol) {
    if (protocol.response.kind != ResponseKind::identification) {
        return {{}};  // no pictures are shown
    }
    const std::vector<std::size_t> pictured = objects_of(protocol, true);
    auto rows = williams_rows(pictured.size());
    for (auto& row : rows) {
        for (std::size_t& place : row) {
            place = pictured[place];
        }
    }
    return rows;
}

RowHistory row_history(std::span<const std::vector<std::string>> rows,
                       std::span<const std::vector<std::string>> others,
                       const std::vector<std::string>& own) {
    const auto row_of = [&](const std::vector<std::string>& order) -> std::optional<std::size_t> {
        const auto found = std::find(rows.begin(), rows.end(), order);
        return found == rows.end() ? std::nullopt
                                   : std::optional(static_cast<std::size_t>(found - rows.begin()));
    };
    RowHistory history{.uses = std::vector<std::size_t>(rows.size(), 0), .own = row_of(own)};
    for (const auto& order : others) {
        if (const auto row = row_of(order)) {
            ++history.uses[*row];
        }
    }
    return history;
}

RowHistory picture_history(const Protocol& protocol,
                           std::span<const std::vector<std::string>> others,
                           const std::vector<std::string>& own) {
    std::vector<std::vector<std::string>> rows;
    for (const auto& row : picture_rows(protocol)) {
        auto& names = rows.emplace_back();
        for (const std::size_t object : row) {
            names.push_back(protocol.objects[object].name);
        }
    }
    return row_history(rows, others, own);
}

}  // namespace palpate::protocols
