#pragma once

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// Four doubles in two registers: homogeneous coordinates (w x, w y, w z, w). SSE2 is part of every
/// x86-64, and each lane is one IEEE operation, so that all machines agree to the bit. A bare
/// `Quad q;` holds rubbish: clearing scratch arrays would cost as much as an evaluation.
struct Quad {
    using Pair [[gnu::vector_size(16)]] = double;

    Pair xy;
    Pair zw;

    [[nodiscard]] double w() const noexcept { return zw[1]; }
    [[nodiscard]] Vec3 xyz() const noexcept { return Vec3{xy[0], xy[1], zw[0]}; }

    Quad& operator+=(const Quad& b) noexcept {
        xy += b.xy;
        zw += b.zw;
        return *this;
    }
    friend Quad operator+(const Quad& a, const Quad& b) noexcept {
        return {a.xy + b.xy, a.zw + b.zw};
    }
    friend Quad operator-(const Quad& a, const Quad& b) noexcept {
        return {a.xy - b.xy, a.zw - b.zw};
    }
    friend Quad operator*(double s, const Quad& a) noexcept { return {s * a.xy, s * a.zw}; }
};

[[nodiscard]] inline Quad quad(const Vec3& p, double w) noexcept {
    return Quad{Quad::Pair{p.x, p.y}, Quad::Pair{p.z, w}};
}

}  // namespace palpate::engine
