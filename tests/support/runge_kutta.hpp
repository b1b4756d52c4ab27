#pragma once

namespace palpate::tests {

/// y after a step of h by the classical rule of Runge and Kutta, of order 4.
/// @param slope  of a state, at a time since the step began
template <class State, class Number, class Slope>
[[nodiscard]] State runge_kutta(const State& y, Number h, const Slope& slope) {
    const Number half = h / Number(2);
    const State a = slope(y, Number(0));
    const State b = slope(y + half * a, half);
    const State c = slope(y + half * b, half);
    const State d = slope(y + h * c, h);
    return y + h / Number(6) * (a + Number(2) * b + Number(2) * c + d);
}

}  // namespace palpate::tests
