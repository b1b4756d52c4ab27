#pragma once

namespace palpate::tests {

/// How many of `all` seeded cases are tried: a quarter under sanitizers, which look at memory,
/// where the next seed does what the last one did.
template <class Count>
[[nodiscard]] constexpr Count cases(Count all) {
#ifdef PALPATE_SANITIZED
    return (all + 3) / 4;
#else
    return all;
#endif
}

}  // namespace palpate::tests
