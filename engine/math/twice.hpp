#pragma once

namespace palpate::engine {

/// A number as the unevaluated sum of two doubles, about 32 digits (Dekker 1971). From + - * / of
/// doubles only: the same to the bit on every machine. For magnitudes of 1e-250 to 1e290.
struct Twice {
    double hi;
    double lo;

    Twice() noexcept = default;  // rubbish until written, as a bare double is
    // NOLINTNEXTLINE: a double is such a number, in every sum and product
    constexpr Twice(double value) noexcept : hi(value), lo(0.0) {}
    /// @pre low is at most half a unit in the last place of high
    constexpr Twice(double high, double low) noexcept : hi(high), lo(low) {}

    friend constexpr Twice operator-(const Twice& a) noexcept { return {-a.hi, -a.lo}; }
};

/// Largest relative error of one sum or product of them: 2^-104, with room to spare.
inline constexpr double kTwiceEpsilon = 0x1p-102;

/// a + b without any rounding (Knuth 1969).
[[nodiscard]] constexpr Twice exact_sum(double a, double b) noexcept {
    const double s = a + b;
    const double of_b = s - a;
    return {s, (a - (s - of_b)) + (b - of_b)};
}

/// a b without any rounding (Veltkamp, Dekker 1971).
[[nodiscard]] constexpr Twice exact_product(double a, double b) noexcept {
    constexpr double kSplit = 134217729.0;  // 2^27 + 1
    const double p = a * b;
    const double ca = kSplit * a;
    const double a1 = ca - (ca - a);
    const double a2 = a - a1;
    const double cb = kSplit * b;
    const double b1 = cb - (cb - b);
    const double b2 = b - b1;
    return {p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2};
}

[[nodiscard]] constexpr Twice operator+(const Twice& a, const Twice& b) noexcept {
    Twice s = exact_sum(a.hi, b.hi);
    const Twice t = exact_sum(a.lo, b.lo);
    const double low = s.lo + t.hi;
    const double high = s.hi + low;
    s = {high, (low - (high - s.hi)) + t.lo};
    return {s.hi + s.lo, s.lo - ((s.hi + s.lo) - s.hi)};
}

[[nodiscard]] constexpr Twice operator-(const Twice& a, const Twice& b) noexcept {
    return a + (-b);
}

[[nodiscard]] constexpr Twice operator*(const Twice& a, const Twice& b) noexcept {
    const Twice p = exact_product(a.hi, b.hi);
    const double low = p.lo + (a.hi * b.lo + a.lo * b.hi);
    const double high = p.hi + low;
    return {high, low - (high - p.hi)};
}

[[nodiscard]] constexpr Twice operator/(const Twice& a, double b) noexcept {
    const double q = a.hi / b;
    const Twice rest = a - exact_product(q, b);
    const double more = (rest.hi + rest.lo) / b;
    const double high = q + more;
    return {high, more - (high - q)};
}

constexpr Twice& operator+=(Twice& a, const Twice& b) noexcept {
    return a = a + b;
}
constexpr Twice& operator-=(Twice& a, const Twice& b) noexcept {
    return a = a - b;
}

/// The double next to it: its sign is the number's own.
[[nodiscard]] constexpr double head(double x) noexcept {
    return x;
}
[[nodiscard]] constexpr double head(const Twice& x) noexcept {
    return x.hi;
}

}  // namespace palpate::engine
