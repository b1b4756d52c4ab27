#pragma once

#include "tests/support/cases.hpp"

// Catch2 v3 (Debian 13, Ubuntu 24.04) and v2 (Debian 12) behind one include.
#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;  // v2 has it in the global namespace
#else
#include <string>

#include <catch2/catch.hpp>

namespace Catch::Matchers {

/// v3's name for v2's matcher of texts; v3 has another `Contains`.
inline auto ContainsSubstring(const std::string& text) {
    return Contains(text);
}  // NOLINT: Catch2's case

}  // namespace Catch::Matchers
#endif

namespace palpate::tests {

/// For GENERATE: `all` seeds from 0, fewer under sanitizers.
template <class Count>
auto seeds(Count all) {
    return Catch::Generators::range(Count{0}, cases(all));
}

}  // namespace palpate::tests
