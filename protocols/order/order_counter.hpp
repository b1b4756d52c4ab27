#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include <boost/multiprecision/cpp_int.hpp>

#include "engine/base/pcg32.hpp"
#include "protocols/order/constrained_order.hpp"
#include "protocols/protocol/condition.hpp"

namespace palpate::protocols {

/// A whole number of any size. Orders are counted with it, and drawn below what was counted: no
/// rounding anywhere, and the same on every machine.
using Natural = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<>,
                                              boost::multiprecision::et_off>;

/// Digits in base 2; 0 has none. @pre n >= 0
[[nodiscard]] std::size_t bits_of(const Natural& n);

/// part / whole to double precision, also where neither fits into a double. @pre part >= 0, whole >
/// 0
[[nodiscard]] double share_of(const Natural& part, const Natural& whole);

/// Uniform in 0 ... n - 1 without bias: as many random bits as n - 1 has, the highest first, until
/// they stay below n. n = 1 draws nothing. @pre n >= 1
[[nodiscard]] Natural draw_below(const Natural& n, Pcg32& random);

/// (sum of counts)! / product of counts!: the orders of things of which counts[i] are alike.
[[nodiscard]] Natural multinomial(const std::vector<std::size_t>& counts);

/// Counts the orders of some trials that keep the run limits, one by one in effect, and so can draw
/// one of them uniformly.
///
/// W(s) is the number of ways to go on from state s: what is left of each condition, the last
/// trial, and how long its runs of object and of friction already are. W = 1 when nothing is left,
/// else the sum of W over every next trial that the limits allow. A next trial is chosen with
/// probability W(after it) / W(s); along a whole order these factors cancel to 1 / W(start), the
/// same for every admissible order. All W are whole numbers, and each choice is a whole number
/// drawn below W(s): exact, not nearly so.
///
/// Objects that have the same left in every friction can stand for each other, so that W depends on
/// the rows of the table "object x friction" as a heap, not on which object has which row. One
/// factor alone is counted by giving all trials the same friction; then the states are few: 5,097
/// for 50 + 50 trials with runs of at most 3, 9,463 for five levels ten times each without repeats,
/// 202,097 for twenty times each. Two crossed factors are counted at once only for small designs.
class OrderCounter {
public:
    /// @param limits       0: no limit. Both may bind.
    /// @param max_states   give up beyond
    /// @returns nothing if there are more states than that
    [[nodiscard]] static std::optional<OrderCounter> build(std::span<const Condition> trials,
                                                           const RunLimits& limits,
                                                           std::size_t max_states);

    /// The exact number of admissible orders. Like trials count as alike.
    [[nodiscard]] const Natural& total() const noexcept { return total_; }
    [[nodiscard]] std::size_t states() const noexcept { return ways_.size(); }

private:
    friend class OrderWalk;

    /// The last trial, and its runs so far.
    struct Last {
        std::size_t object = 0, friction = 0;
        std::uint16_t object_run = 0, friction_run = 0;  ///< 0: before the first trial
    };
    /// Where an order has got to. `left` has a row an object and a column a friction.
    struct Place {
        std::vector<std::uint16_t> left;
        std::size_t rest = 0;  ///< sum of `left`
        Last last{};
    };
    using Key = std::u16string;

    OrderCounter(std::span<const Condition> trials, const RunLimits& limits);

    [[nodiscard]] Key key_of(const Place& at) const;
    /// Goes on with a trial, if there is one left and the limits allow it.
    [[nodiscard]] bool step(Place& at, std::size_t object, std::size_t friction) const noexcept;
    /// Back to before that step. @param from  the last trial of then
    void undo(Place& at, const Last& from) const noexcept;
    /// Fills the table from `at` on. Nothing: too many states.
    const Natural* count(Place& at, std::size_t max_states);

    std::size_t objects_ = 0, frictions_ = 0;
    std::vector<std::size_t> object_names_, friction_names_;  ///< row -> Condition::object
    RunLimits limits_;
    Place start_;
    std::unordered_map<Key, Natural> ways_;
    Natural total_;
};

/// One admissible order, dealt trial by trial; uniform over all of them. Whoever does not like how
/// it begins may drop it.
class OrderWalk {
public:
    /// @pre counter.total() > 0; the counter outlives the walk
    explicit OrderWalk(const OrderCounter& counter);
    [[nodiscard]] bool done() const noexcept { return at_.rest == 0; }
    /// @pre not done()
    Condition next(Pcg32& random);

private:
    const OrderCounter* counter_;
    OrderCounter::Place at_;
    const Natural* ways_;
};

/// How often each condition comes.
[[nodiscard]] std::map<Condition, std::size_t> cells_of(std::span<const Condition> trials);
/// The number of orders of the trials as they are, like ones alike.
[[nodiscard]] Natural orders_of(std::span<const Condition> trials);
/// How often each level of a factor comes, from the lowest level that does.
[[nodiscard]] std::vector<std::size_t> counts_of(std::span<const Condition> trials,
                                                 std::size_t Condition::*factor);

/// Whether some order of these trials has more than `limit` in a row. 0: no limit.
[[nodiscard]] bool binds(std::span<const std::size_t> counts, std::size_t limit) noexcept;

/// The exact number of orders of one factor, counts[i] times level i, with at most `limit` in a
/// row.
///
/// By clusters: cut an order into pieces of one level each, neighbours alike or not, and give a
/// piece of z trials the sign + if z = 1, - if z = 0 modulo limit + 1, else nothing. Then every
/// admissible order is summed to 1 and every other to 0 (I. P. Goulden and D. M. Jackson, "An
/// inversion theorem for cluster decompositions of sequences with distinguished subsequences",
/// 1979). n things of a level make j pieces in
///
///     Q(n, j) = sum over a L + b (L + 1) = n - j of (-1)^a C(j, a) C(j - 1 + b, b)
///
/// signed ways, L = limit, and pieces of all levels mix freely. This shares nothing with
/// OrderCounter, and neither trusts the other: the tests compare them. Time grows with the cube of
/// the trials.
///
/// @param limit  >= 1
[[nodiscard]] Natural count_orders(std::span<const std::size_t> counts, std::size_t limit);

/// Beyond, count_orders() takes more than a moment.
inline constexpr std::size_t kMaxCounted = 240;

/// How many bits an acceptance has before its first 1, about: one shuffle in 2^rarity keeps the
/// limit. By count_orders(); beyond kMaxCounted trials by the expected number of runs that are too
/// long.
[[nodiscard]] std::size_t rarity_of(std::span<const std::size_t> counts, std::size_t limit);

}  // namespace palpate::protocols
