#pragma once

#include <cstddef>

namespace palpate::tests {

/// Calls of operator new in this program so far; 0 for ever under a sanitizer. Link
/// tests/support/allocations.cpp.
[[nodiscard]] std::size_t allocations() noexcept;

}  // namespace palpate::tests
