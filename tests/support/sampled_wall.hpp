#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

/// A mass with a damper on a sampled, held spring: the textbook's virtual wall, without a linkage.
namespace palpate::tests {

struct SampledWall {
    double mass = 0.15;            ///< m, kg
    double damping = 0.5;          ///< b, N s/m, physical
    double period = 1e-3;          ///< T, s
    double virtual_damping = 0.0;  ///< B, N s/m, on the backward difference of the position
    int delay = 0;                 ///< ticks from a reading to its force, 0 or 1
};

/// b > K T (1/2 + delay) + |B| solved for K: the passivity bound of Colgate & Schenkel (1997) and
/// what a delay adds to it.
inline double passive_stiffness(const SampledWall& wall) {
    return (wall.damping - std::fabs(wall.virtual_damping)) / (wall.period * (0.5 + wall.delay));
}

/// All roots of the polynomial c[0] + c[1] z + ... + c[n] z^n inside the unit circle: the recursion
/// of Schur and Cohn.
template <std::size_t N>
bool schur_stable(std::array<double, N> c) {
    for (std::size_t n = N - 1; n >= 1; --n) {
        if (!(std::fabs(c[0]) < std::fabs(c[n]))) {
            return false;
        }
        std::array<double, N> next{};
        for (std::size_t i = 0; i < n; ++i) {
            next[i] = c[n] * c[i + 1] - c[0] * c[n - 1 - i];
        }
        c = next;
    }
    return true;
}

/// The closed loop's polynomial, from the exact zero-order-hold equivalent of 1 / (m s^2 + b s) and
/// the force -(K + B (1 - 1/z) / T) x / z^delay.
inline bool exactly_stable(const SampledWall& wall, double stiffness) {
    const double rate = wall.damping / wall.mass;
    const double left = std::exp(-rate * wall.period);
    const double gone = -std::expm1(-rate * wall.period) / rate;
    const double later = (wall.period - gone) / wall.damping;          // of z
    const double sooner = (gone - left * wall.period) / wall.damping;  // of 1
    const double now = stiffness + wall.virtual_damping / wall.period;
    const double before = -wall.virtual_damping / wall.period;
    // (z - 1)(z - left) z^(delay + 1) + (later z + sooner)(now z + before)
    std::array<double, 5> c{};
    const auto power = static_cast<std::size_t>(wall.delay) + 1U;
    c[power] += left;
    c[power + 1] -= 1.0 + left;
    c[power + 2] += 1.0;
    c[0] += sooner * before;
    c[1] += later * before + sooner * now;
    c[2] += later * now;
    return wall.delay == 1 ? schur_stable(c)
                           : schur_stable(std::array<double, 4>{c[0], c[1], c[2], c[3]});
}

/// The largest K below which `stable` holds and above which it does not, bisected between half and
/// ten times `guess`; NaN if it is not between them.
template <class Stable>
double stability_limit(double guess, int halvings, Stable&& stable) {
    double low = 0.5 * guess;
    double high = 10.0 * guess;
    if (!stable(low) || stable(high)) {
        return std::nan("");
    }
    for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (low + high);
        (stable(middle) ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/// The stiffness at which the sampled wall starts to swing up by itself, N/m: exact.
inline double exact_stiffness(const SampledWall& wall) {
    return stability_limit(wall.damping / wall.period, 60,
                           [&](double k) { return exactly_stable(wall, k); });
}

/// Growth a tick, ln r, of an oscillation x_k = r^k cos(...), read off its samples: x_k x_(k+2s) -
/// x_(k+s)^2 is multiplied by r^2 each tick, whatever phase and stride s. The sum over a window
/// late in the path over that of one early in it, so that rounded samples do no harm.
inline double growth_of(const std::vector<double>& x, std::size_t stride) {
    const std::size_t settle = x.size() / 10;  // the fast roots have died away
    const std::size_t window = x.size() / 4;
    const auto sum_from = [&](std::size_t first) {
        double sum = 0.0;
        for (std::size_t k = first; k < first + window; ++k) {
            sum += x[k] * x[k + 2 * stride] - x[k + stride] * x[k + stride];
        }
        return sum;
    };
    const std::size_t late = x.size() - window - 2 * stride;
    return 0.5 * std::log(sum_from(late) / sum_from(settle)) / static_cast<double>(late - settle);
}

/// Ticks of a quarter of a swing: the stride at which growth_of is surest.
inline std::size_t quarter_swing(const SampledWall& wall, double stiffness) {
    const double ticks = 1.5707963 / (std::sqrt(stiffness / wall.mass) * wall.period);
    return static_cast<std::size_t>(std::fmax(1.0, std::round(ticks)));
}

/// The same wall, stepped: mass and damper exact over each tick.
inline double stepped_growth(const SampledWall& wall, double stiffness, int ticks) {
    const double rate = wall.damping / wall.mass;
    const double left = std::exp(-rate * wall.period);
    const double gone = -std::expm1(-rate * wall.period) / rate;
    double x = 1.0;
    double v = 0.0;
    double previous = x;
    double waiting = 0.0;
    std::vector<double> path;
    for (int i = 0; i < ticks; ++i) {
        path.push_back(x);
        const double now = -stiffness * x - wall.virtual_damping * (x - previous) / wall.period;
        const double force = wall.delay == 1 ? waiting : now;
        waiting = now;
        previous = x;
        const double goal = force / wall.damping;  // speed that the force would bring at last
        x += goal * wall.period + (v - goal) * gone;
        v = goal + (v - goal) * left;
    }
    return growth_of(path, quarter_swing(wall, stiffness));
}

}  // namespace palpate::tests
