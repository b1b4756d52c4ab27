#pragma once

#include <vector>

#include "engine/geometry/outline.hpp"

namespace palpate::engine {

/// How long an outline is up to each of its places, whatever its parameter: a table, made once.
class ArcLength {
public:
    /// Of no outline.
    ArcLength() = default;
    explicit ArcLength(const Outline& outline);

    /// From the outline's beginning to u on a span, m; within 1e-6 of a span that moves at all
    /// evenly. @param u  0 to 1
    [[nodiscard]] double at(std::size_t span, double u) const noexcept;
    /// Of the whole outline, m.
    [[nodiscard]] double whole() const noexcept { return nodes_.empty() ? 0.0 : nodes_.back().at; }

private:
    static constexpr std::size_t kPieces = 64;  ///< of each span, evenly by u

    struct Node {
        double at = 0.0;    ///< m
        double rate = 0.0;  ///< m for each piece of u
    };
    std::vector<Node> nodes_;  ///< of each span kPieces + 1
};

}  // namespace palpate::engine
