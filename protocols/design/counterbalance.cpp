#include "protocols/design/counterbalance.hpp"

#include <algorithm>

#include "protocols/design/factorial.hpp"

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

std::vector<std::vector<std::size_t>> williams_rows(std::size_t n) {
    // 0, 1, n-1, 2, n-2, ...: its neighbours differ by every step 1 ... n-1 modulo n.
    std::vector<std::size_t> first;
    for (std::size_t place = 0; place < n; ++place) {
        first.push_back(place % 2 == 1 ? (place + 1) / 2 : (n - place / 2) % n);
    }
    std::vector<std::vector<std::size_t>> rows;
    for (std::size_t shift = 0; shift < n; ++shift) {
        std::vector<std::size_t> row;
        for (const std::size_t item : first) {
            row.push_back((item + shift) % n);
        }
        rows.push_back(std::move(row));
    }
    if (n % 2 == 1) {
        // An odd n balances the pairs only together with the mirror images.
        for (std::size_t i = 0; i < n; ++i) {
            std::vector<std::size_t> mirrored = rows[i];
            std::reverse(mirrored.begin(), mirrored.end());
            rows.push_back(std::move(mirrored));
        }
    }
    return rows;
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
