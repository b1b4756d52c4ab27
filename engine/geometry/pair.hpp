#pragma once

#include <cstring>

#include "engine/geometry/rational_bezier.hpp"

namespace palpate::engine {

/// A Vec2 in one register, so that what both coordinates need is one instruction. The operations
/// are those of Vec2 in the same order, and give the same bits.
using Pair [[gnu::vector_size(16)]] = double;

[[nodiscard]] inline Pair pair(const Vec2& v) noexcept {
    return Pair{v.x, v.y};
}
inline void put(Pair from, Vec2& to) noexcept {
    static_assert(sizeof from == sizeof to);
    std::memcpy(&to, &from, sizeof from);
}
[[nodiscard]] inline double dot(Pair a, Pair b) noexcept {
    const Pair both = a * b;
    return both[0] + both[1];
}
[[nodiscard]] inline double cross(Pair a, Pair b) noexcept {
    const Pair both = a * Pair{b[1], b[0]};
    return both[0] - both[1];
}

/// A span that is its own Taylor series.
struct Cubic {
    const RationalBezier<2>& span;
};

/// Jet<2>.
struct PairJet {
    Pair point;
    Pair first;
    Pair second;

    explicit PairJet(const Jet<2>& jet) noexcept
        : point(pair(jet.point)), first(pair(jet.first)), second(pair(jet.second)) {}
    void put(Jet<2>& to) const noexcept {
        engine::put(point, to.point);
        engine::put(first, to.first);
        engine::put(second, to.second);
    }
    /// RationalBezier::at()
    PairJet(const RationalBezier<2>& span, double u) noexcept : PairJet(span.at(u)) {}
    PairJet(const Cubic& curve, double u) noexcept {
        const RationalBezier<2>& cubic = curve.span;
        const Pair twice = 2.0 * pair(cubic.power(2));
        const Pair third = pair(cubic.power(3));
        point = pair(cubic.origin()) +
                (pair(cubic.power(0)) +
                 u * (pair(cubic.power(1)) + u * (pair(cubic.power(2)) + u * third)));
        first = pair(cubic.power(1)) + u * (twice + (3.0 * u) * third);
        second = twice + (6.0 * u) * third;
    }
    /// RationalBezier::beside()
    PairJet(const Cubic& curve, const PairJet& jet, double du) noexcept {
        const Pair third = pair(curve.span.power(3));
        point = jet.point + du * (jet.first + du * (0.5 * jet.second + du * third));
        first = jet.first + du * (jet.second + (3.0 * du) * third);
        second = jet.second + (6.0 * du) * third;
    }
};

}  // namespace palpate::engine
