#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "protocols/design/condition.hpp"
#include "protocols/design/pcg32.hpp"

namespace palpate::protocols {

/// Most trials in a row with the same level of a factor. 0: no limit.
struct RunLimits {
    std::size_t object = 0;
    std::size_t friction = 0;

    friend bool operator==(const RunLimits&, const RunLimits&) = default;
};

[[nodiscard]] bool within_limits(std::span<const Condition> order,
                                 const RunLimits& limits) noexcept;

/// No order of the trials keeps the limits, or none was found in reasonable time.
class OrderError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Why no order of `trials` can keep the limits, where that is cheap to see; nothing otherwise.
///
/// A level that occurs n times among m others needs ceil(n / (m + 1)) in a row somewhere: pigeons and
/// holes. Exact for one factor. For both together only the one case is added where each factor has two
/// levels and both limits are 1: both alternate, and two of the four conditions can never come.
struct Infeasible {
    enum class Factor : std::uint8_t { object, friction } factor = Factor::object;
    std::string reason;
};
[[nodiscard]] std::optional<Infeasible> why_infeasible(std::span<const Condition> trials,
                                                       const RunLimits& limits);

struct ConstrainedOrder {
    std::vector<Condition> order;
    std::uint64_t attempts = 1;  ///< whole shuffles drawn
    double acceptance = 1.0;  ///< 1 / attempts: an estimate from a single success, so a rough one
};

/// `trials` in an order that keeps the run limits, uniform over all such orders.
///
/// Whole shuffles are drawn until one keeps the limits (a shuffle is given up once the part that is
/// already dealt breaks one). Every admissible order is then equally likely, which repairing a bad
/// shuffle by swaps does not give. Five objects ten times each: a run of at most 2 passes in .268 of the
/// shuffles, at most 3 in .829, at most 1 in 4.9e-5. The default study's two limits together pass in
/// about 1.9e-5: some 50,000 shuffles, a few milliseconds.
///
/// @throws OrderError if the limits cannot be kept (why_infeasible), or after most_attempts shuffles
[[nodiscard]] ConstrainedOrder constrained_order(std::vector<Condition> trials,
                                                 const RunLimits& limits,
                                                 Pcg32& random);

/// Shuffles after which the limits count as hopeless: 2,000,000, fewer for sessions of more than 100
/// trials, so that the answer comes within about a second. Limits that pass in 1e-5 of the shuffles fail
/// here once in 5e8 sessions, limits that pass in 1e-6 once in seven.
[[nodiscard]] std::uint64_t most_attempts(std::size_t trials) noexcept;

}  // namespace palpate::protocols
