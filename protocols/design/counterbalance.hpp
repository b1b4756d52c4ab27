#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/pcg32.hpp"
#include "protocols/protocol/protocol.hpp"

namespace palpate::protocols {

/// Which rows of a design are taken: what the database knows of those who already ran.
struct RowHistory {
    std::vector<std::size_t> uses;   ///< of each row, by other participants; empty: none so far
    std::optional<std::size_t> own;  ///< the row that this participant already has

    friend bool operator==(const RowHistory&, const RowHistory&) = default;
};

/// The row for a participant: their own if they have one, else the one used least.
///
/// Among rows that are used equally little the stream decides, not the lowest number: else the row
/// would tell when somebody came, and two databases of one study, begun on two rigs, would both
/// begin with row 1. With nobody there yet, every row is as likely as every other. After n
/// participants no row is used more than once more than another, whatever the draws were.
///
/// @pre rows >= 1
[[nodiscard]] std::size_t choose_row(std::size_t rows, const RowHistory& history, Pcg32& random);

/// Rows of the Williams design for n items (E. J. Williams, 1949): n rows for even n, 2n for odd n.
/// Over all rows every item takes every place equally often, and every ordered pair of different
/// items stands side by side equally often. n = 0 gives no rows.
[[nodiscard]] std::vector<std::vector<std::size_t>> williams_rows(std::size_t n);

/// The orders of pictures that the study uses: the rows of the Williams design for its pictured
/// objects, each from left to right, as indices into Protocol::objects. One empty row where no
/// pictures are shown.
[[nodiscard]] std::vector<std::vector<std::size_t>> picture_rows(const Protocol& protocol);

/// Finds recorded orders, as names of levels, among `rows`. An order that is none of them counts
/// for nothing.
[[nodiscard]] RowHistory row_history(std::span<const std::vector<std::string>> rows,
                                     std::span<const std::vector<std::string>> others,
                                     const std::vector<std::string>& own);

/// Finds recorded orders, as names from left to right, among picture_rows(). An order that is none
/// of them belongs to another version of the protocol and counts for nothing.
[[nodiscard]] RowHistory picture_history(const Protocol& protocol,
                                         std::span<const std::vector<std::string>> others,
                                         const std::vector<std::string>& own);

}  // namespace palpate::protocols
