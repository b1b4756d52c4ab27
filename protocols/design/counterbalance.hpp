#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/pcg32.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/order/constrained_order.hpp"
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

/// Finds recorded orders, as names from left to right, among picture_rows(). An order that is none
/// of them belongs to another version of the protocol and counts for nothing.
[[nodiscard]] RowHistory picture_history(const Protocol& protocol,
                                         std::span<const std::vector<std::string>> others,
                                         const std::vector<std::string>& own);

// Designs in which the friction stays the same for a block of main trials. `blocks` of the
// protocol is then a number of rounds, in each of which every friction has one block; each block
// holds every pictured object repetitions / blocks times. With "abba" every second round goes
// backwards, so that two rounds of two frictions are A B B A: what grows or fades in a straight
// line over the session then weighs alike on both.

/// Whether the design has such blocks: "abba" or "blocked", not "interleaved".
[[nodiscard]] bool in_friction_blocks(const DesignSpec& design) noexcept;

/// Blocks of the main phase: `blocks`, or as many for every friction.
[[nodiscard]] std::size_t block_count(const Protocol& protocol) noexcept;

/// The main trials of one block in file order, and the limits that its order keeps.
/// @param friction  of the block; without meaning where frictions are interleaved
/// @pre blocks divides repetitions
[[nodiscard]] std::vector<Condition> block_trials(const Protocol& protocol, std::size_t friction);
[[nodiscard]] RunLimits block_limits(const DesignSpec& design) noexcept;

/// The orders of frictions in the first round that the study uses: the rows of their Williams
/// design, as indices into Protocol::frictions. Two frictions: off on, and on off.
[[nodiscard]] std::vector<std::vector<std::size_t>> friction_rows(const Protocol& protocol);

/// Finds recorded first rounds, as names of frictions, among friction_rows(). Where frictions are
/// interleaved there is no history.
[[nodiscard]] RowHistory friction_history(const Protocol& protocol,
                                          std::span<const std::vector<std::string>> others,
                                          const std::vector<std::string>& own);

/// The friction of each block of the session. @param row  one of friction_rows()
[[nodiscard]] std::vector<std::size_t> friction_of_blocks(const DesignSpec& design,
                                                          std::span<const std::size_t> row);

/// The first round of a plan made in friction blocks, as it is recorded.
[[nodiscard]] std::vector<std::size_t> first_round(const Protocol& protocol, const Plan& plan);

/// Why the design cannot be had in friction blocks, with a remedy; empty if it can.
[[nodiscard]] std::string why_not_in_blocks(const Protocol& protocol);

}  // namespace palpate::protocols
