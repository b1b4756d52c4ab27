#pragma once

// What nearly every test uses beside Catch2.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tests/support/cases.hpp"

// Catch2 v3 (Debian 13, Ubuntu 24.04) and v2 (Debian 12) behind one include.
#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;  // v2 has it in the global namespace
#else
#include <catch2/catch.hpp>

namespace Catch::Matchers {

/// v3's name for v2's matcher of texts; v3 has another `Contains`.
inline auto ContainsSubstring(const std::string& text) {
    return Contains(text);
}  // NOLINT: Catch2's case

}  // namespace Catch::Matchers
#endif

namespace palpate::tests {

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;

/// For GENERATE: `all` seeds from 0, fewer under sanitizers.
template <class Count>
auto seeds(Count all) {
    return Catch::Generators::range(Count{0}, cases(all));
}

}  // namespace palpate::tests

/// In a test case that runs once for each of `count` seeds: `seed`, and a Random of it
/// (tests/support/random.hpp).
#define SEEDED(random, count)                                 \
    const auto seed = GENERATE(palpate::tests::seeds(count)); \
    CAPTURE(seed);                                            \
    palpate::tests::Random random(seed)
