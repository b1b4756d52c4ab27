#pragma once

#include "tests/stress/stress_run.hpp"
#include "tests/support/catch.hpp"

namespace palpate::stress {

/// Feels a case, and no tick of it breaks a law.
template <class AnyCase>
void holds(const AnyCase& c, std::uint64_t seed, Tally& tally) {
    const Breach breach = feel(c, tally, false).value_or(Breach{});
    CAPTURE(seed, breach.tick, breach.value, breach.limit);
    CHECK(breach.law == "");
}

}  // namespace palpate::stress
