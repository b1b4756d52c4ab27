#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "engine/base/pcg32.hpp"
#include "protocols/order/constrained_order.hpp"

namespace palpate::protocols {

class OrderCounter;

/// Draws orders that keep the run limits, each uniform over ALL such orders, also where hardly any
/// shuffle keeps them.
///
/// An order is a sequence of objects and a sequence of frictions, side by side. A factor is either
/// DEALT (a shuffle, whatever its limit) or COUNTED (drawn by an OrderCounter of its own, so that
/// its limit holds). Every way below proposes orders out of a set that holds all admissible ones,
/// each of the set equally likely, and drops a proposal that is not admissible. What is kept is
/// therefore uniform over the admissible orders, whichever way it came:
///
///   shuffles      both dealt: all orders.
///   one counted   the sequence of factor A is counted, uniform over those that keep A's limit.
///                 Then the levels of B are dealt: for every level of A its own B's are shuffled
///                 over its places. How many ways there are to do that depends on the table "A x B"
///                 alone and not on the sequence, so that the pairs are uniform. Dropped: what
///                 breaks B's limit.
///   both counted  object and friction each by itself, neither knowing of the other. Dropped: pairs
///                 whose table of conditions is not the asked one. Rarely right (for k objects, f
///                 frictions and n trials about once in n^((k-1)(f-1)/2)), but however tight the
///                 limits are.
///   together      the OrderCounter of both factors at once: nothing is dropped. Small designs.
///
/// A proposal is given up at its first fault, so that one in a million is still quick. For the
/// default study one shuffle in 50,000 passes; with friction counted, one proposal in 22.
///
/// The ways are tried from the one that seems to need the fewest proposals (rarity_of); one that
/// cannot be counted is skipped, and one that finds nothing in kDeals trials dealt is left for the
/// next. What a way finds is uniform, whichever way it is, so that leaving one does no harm.
///
/// How far that goes, measured: blocks of five objects x two frictions up to 400 trials with limits
/// (2, 2) and (2, 3) for object and friction, 500 with (3, 3), 400 with (3, 4), 100 with (1, 2) and
/// (1, 3); three x two up to 240 with (1, 2), 180 with (2, 3); two x two with (2, 2) up to 400. Of
/// one factor: two levels with limit 2 up to 400 trials, five levels 250, without repeats 100.
/// Beyond, draw() gives up after seconds: what is dealt keeps its limit ever more rarely, and
/// counters grow with a power of the trials. Blocks have no such limit together, only each by
/// itself.
class OrderSampler {
public:
    /// @throws OrderError if no order keeps the limits
    OrderSampler(std::vector<Condition> trials, const RunLimits& limits);

    /// @throws OrderError if no way finds an order
    [[nodiscard]] ConstrainedOrder draw(Pcg32& random);

    /// Trials dealt, over all proposals of a way, before the next way is tried: about a second.
    static constexpr std::uint64_t kDeals = 10'000'000;
    /// A counter of more states is not made. A state of a long session is larger: fewer then.
    [[nodiscard]] static std::size_t max_states(std::size_t trials) noexcept;

    /// The way that draw() begins with.
    [[nodiscard]] OrderWay first_way();
    /// One proposal, or nothing if it was dropped. @pre the way can be counted
    [[nodiscard]] std::optional<std::vector<Condition>> propose(OrderWay way, Pcg32& random);
    /// Counter of one factor, as Condition::object of its trials; null if there are too many
    /// states.
    [[nodiscard]] const OrderCounter* counter_of(std::size_t Condition::*factor);
    /// Null if there are too many states. @throws OrderError if it counts none
    [[nodiscard]] const OrderCounter* counter_of_both();

private:
    using Level = std::size_t Condition::*;
    /// A counter is made when it is first asked for; null: it proved too large.
    using Lazy = std::optional<std::shared_ptr<const OrderCounter>>;

    /// The trials with one level of the counted factor; the first `left` are still to be dealt.
    struct Pile {
        std::vector<Condition> trials;
        std::size_t left = 0;
    };

    using Proposal = std::optional<std::vector<Condition>>;

    [[nodiscard]] std::vector<OrderWay> by_rarity() const;
    [[nodiscard]] bool can(OrderWay way);
    [[nodiscard]] Proposal deal_both(Pcg32& random);
    [[nodiscard]] Proposal deal_beside(Level counted, Pcg32& random);
    [[nodiscard]] Proposal count_apart(Pcg32& random);

    std::vector<Condition> trials_;
    RunLimits limits_;
    std::vector<OrderWay> ways_;
    std::size_t way_ = 0;  ///< earlier ones have been left
    std::uint64_t dealt_ = 0;
    Lazy object_, friction_, both_;
    std::map<std::size_t, Pile> piles_;  ///< by level of the factor that is counted now
};

}  // namespace palpate::protocols
