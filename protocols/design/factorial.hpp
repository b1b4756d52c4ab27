#pragma once

#include <cstddef>
#include <vector>

#include "protocols/protocol/condition.hpp"
#include "protocols/protocol/protocol.hpp"

/// The cells of a design.
namespace palpate::protocols {

/// Indices of the objects that are pictured, or of those that are not (catch objects), in file
/// order.
[[nodiscard]] std::vector<std::size_t> objects_of(const Protocol& protocol, bool pictured);

/// Every pictured object with every friction, `repetitions` times, in file order.
[[nodiscard]] std::vector<Condition> factorial(const Protocol& protocol, std::size_t repetitions);

}  // namespace palpate::protocols
