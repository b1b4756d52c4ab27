#pragma once

#include <cstddef>
#include <vector>

namespace palpate::protocols {

/// Rows of the Williams design for n items (E. J. Williams, 1949): n rows for even n, 2n for odd n.
/// Over all rows every item takes every place equally often, and every ordered pair of different
/// items stands side by side equally often. n = 0 gives no rows.
[[nodiscard]] std::vector<std::vector<std::size_t>> williams_rows(std::size_t n);

}  // namespace palpate::protocols
