#pragma once

#include "tests/bench/method.hpp"
#include "tests/bench/objects.hpp"

namespace palpate::bench {

/// Every tracker of the thesis, one on each curve of the object, the nearest of their feet: what
/// the thesis' switch between curves needs near a vertex.
[[nodiscard]] Methods<2> tracker_methods(const Object& object);

}  // namespace palpate::bench
