#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/protocol/condition.hpp"

namespace palpate::protocols {

/// Most trials in a row with the same level of a factor. 0: no limit.
struct RunLimits {
    std::size_t object = 0;
    std::size_t friction = 0;
    std::array<std::string_view, 2> words{"object", "friction"};  ///< as a sentence calls them
};

/// No order of the trials keeps the limits, or none was found in reasonable time.
class OrderError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// How often each level of a factor comes.
[[nodiscard]] std::map<std::size_t, std::size_t> occurrences(std::span<const Condition> trials,
                                                             std::size_t Condition::*factor);

/// Why no order of `trials` can keep the limits, where that is cheap to see; nothing otherwise.
///
/// A level that occurs n times among m others needs ceil(n / (m + 1)) in a row somewhere: pigeons
/// and holes. Exact for one factor. For both together only the one case is added where each factor
/// has two levels and both limits are 1: both alternate, and two of the four conditions can never
/// come.
struct Infeasible {
    enum class Factor : std::uint8_t { object, friction } factor = Factor::object;
    std::string reason;
};
/// @return none if no such reason was found: an order may still not exist
[[nodiscard]] std::optional<Infeasible> why_infeasible(std::span<const Condition> trials,
                                                       const RunLimits& limits);

/// How an order was found; see OrderSampler.
enum class OrderWay : std::uint8_t {
    shuffles,          ///< whole shuffles until one keeps the limits
    friction_counted,  ///< frictions drawn by counting, objects dealt beside them
    object_counted,    ///< objects drawn by counting, frictions dealt beside them
    together,          ///< both drawn at once by counting
    apart,             ///< both drawn by counting, each by itself, until the conditions are right
};

/// In words for people, such as "frictions counted, objects dealt".
[[nodiscard]] std::string_view to_string(OrderWay way) noexcept;

/// An order that keeps the limits, and how it was found.
struct ConstrainedOrder {
    std::vector<Condition> order;
    std::uint64_t attempts = 1;  ///< proposals drawn, with those of ways that were left
    OrderWay way = OrderWay::shuffles;
};

}  // namespace palpate::protocols
