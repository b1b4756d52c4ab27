#include "protocols/design/counterbalance.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace palpate::protocols {
namespace {

/// Finds recorded orders, as names of levels, among `rows`. An order that is none of them counts
/// for nothing.
template <class Spec>
RowHistory row_history(const std::vector<std::vector<std::size_t>>& rows,
                       const std::vector<Spec>& levels,
                       std::span<const std::vector<std::string>> others,
                       const std::vector<std::string>& own) {
    const auto row_of = [&](const std::vector<std::string>& order) -> std::optional<std::size_t> {
        const auto found = std::ranges::find_if(rows, [&](const std::vector<std::size_t>& row) {
            return std::ranges::equal(row, order, {}, [&](std::size_t level) -> const std::string& {
                return levels[level].name;
            });
        });
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

}  // namespace

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
            rows.emplace_back(rows[i].rbegin(), rows[i].rend());
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

RowHistory picture_history(const Protocol& protocol,
                           std::span<const std::vector<std::string>> others,
                           const std::vector<std::string>& own) {
    return row_history(picture_rows(protocol), protocol.objects, others, own);
}

bool in_friction_blocks(const DesignSpec& design) noexcept {
    return design.friction_blocks != FrictionBlocks::interleaved;
}

std::size_t block_count(const Protocol& protocol) noexcept {
    const std::size_t rounds = protocol.design.blocks;
    return in_friction_blocks(protocol.design) ? rounds * protocol.frictions.size() : rounds;
}

std::vector<Condition> block_trials(const Protocol& protocol, std::size_t friction) {
    const DesignSpec& design = protocol.design;
    std::vector<Condition> trials = factorial(protocol, design.repetitions / design.blocks);
    if (in_friction_blocks(design)) {
        std::erase_if(trials, [&](const Condition& one) { return one.friction != friction; });
    }
    return trials;
}

RunLimits block_limits(const DesignSpec& design) noexcept {
    return {.object = design.max_run_object,
            .friction = in_friction_blocks(design) ? 0 : design.max_run_friction};
}

std::vector<std::vector<std::size_t>> friction_rows(const Protocol& protocol) {
    return williams_rows(protocol.frictions.size());
}

RowHistory friction_history(const Protocol& protocol,
                            std::span<const std::vector<std::string>> others,
                            const std::vector<std::string>& own) {
    return in_friction_blocks(protocol.design)
             ? row_history(friction_rows(protocol), protocol.frictions, others, own)
             : RowHistory{};
}

std::vector<std::size_t> friction_of_blocks(const DesignSpec& design,
                                            std::span<const std::size_t> row) {
    std::vector<std::size_t> frictions;
    for (std::size_t round = 0; round < design.blocks; ++round) {
        const bool back = design.friction_blocks == FrictionBlocks::abba && round % 2 == 1;
        for (std::size_t i = 0; i < row.size(); ++i) {
            frictions.push_back(row[back ? row.size() - 1 - i : i]);
        }
    }
    return frictions;
}

std::vector<std::size_t> first_round(const Protocol& protocol, const Plan& plan) {
    std::vector<std::size_t> row;
    for (const PlannedTrial& trial : plan.trials) {
        if (trial.phase == Phase::main && trial.block == row.size() &&
            row.size() < protocol.frictions.size()) {
            row.push_back(trial.condition.friction);
        }
    }
    return row;
}

std::string why_not_in_blocks(const Protocol& protocol) {
    const DesignSpec& design = protocol.design;
    if (!in_friction_blocks(design)) {
        return {};
    }
    if (protocol.frictions.size() < 2) {
        return "blocks of one friction each need two frictions or more: add a [[friction]], or "
               "give \"interleaved\"";
    }
    if (design.order == OrderRule::first_order) {
        return "order = \"first_order\" mixes the frictions: give \"interleaved\", or order = "
               "\"random\"";
    }
    if (design.friction_blocks == FrictionBlocks::abba && design.blocks % 2 != 0) {
        return fmt::format(
            "\"abba\" goes there and back, and blocks is {}: give an even number of blocks, each "
            "of them a round of all frictions, or \"blocked\"",
            design.blocks);
    }
    return {};
}

}  // namespace palpate::protocols
