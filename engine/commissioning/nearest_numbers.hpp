#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "engine/math/least_squares.hpp"

namespace palpate::engine {

/// Stands where nothing was measured.
inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// s by which answers may be older before that is not told from other things.
inline constexpr double kLatest = 0.05;

/// What numbers may be.
struct NumberRange {
    LeastSquares::Row least{};
    LeastSquares::Row max{};
    LeastSquares::Row small{};  ///< a step of the differences, where a number is near 0
};

namespace detail {

/// Measured less predicted, one by one; 0 where nothing was measured (NaN).
inline std::vector<double> missed(const std::vector<double>& measured,
                                  const std::vector<double>& predicted) {
    std::vector<double> all(measured.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
        all[k] = std::isnan(measured[k]) ? 0.0 : measured[k] - predicted[k];
    }
    return all;
}

/// Sum of squares.
inline double squares_of(const std::vector<double>& missed) {
    double sum = 0.0;
    for (const double one : missed) {
        sum += one * one;
    }
    return sum;
}

/// Where the numbers should go from `x`.
template <class Predict>
LeastSquares slopes_at(const Predict& predict,
                       const LeastSquares::Row& x,
                       const std::vector<double>& here,
                       const std::vector<double>& missed,
                       const NumberRange& range,
                       std::size_t unknowns) {
    std::array<std::vector<double>, LeastSquares::kMax> slope;
    for (std::size_t i = 0; i < unknowns; ++i) {
        LeastSquares::Row beside = x;
        const double step = std::fmax(0.02 * std::fabs(x[i]), range.small[i]);
        beside[i] += step;
        slope[i] = predict(beside);
        for (std::size_t k = 0; k < here.size(); ++k) {
            slope[i][k] = (slope[i][k] - here[k]) / step;
        }
    }
    LeastSquares squares(unknowns);
    for (std::size_t k = 0; k < here.size(); ++k) {
        LeastSquares::Row row{};
        for (std::size_t i = 0; i < unknowns; ++i) {
            row[i] = slope[i][k];
        }
        squares.add(row, missed[k]);
    }
    return squares;
}

}  // namespace detail

/// The numbers whose prediction is nearest to what was measured: Levenberg and Marquardt's method.
/// @param predict   from numbers to a std::vector<double> as long as `measured`
/// @param measured  kUnknown where nothing was
/// @param x         where to begin, within `range`
/// @param unknowns  the first so many are looked for, the others stay
template <class Predict>
[[nodiscard]] LeastSquares::Row nearest_numbers(const Predict& predict,
                                                const std::vector<double>& measured,
                                                LeastSquares::Row x,
                                                const NumberRange& range,
                                                std::size_t unknowns) {
    constexpr int kRounds = 25;
    std::vector<double> here = predict(x);
    std::vector<double> wrong = detail::missed(measured, here);
    double damped = 1e-2;
    for (int round = 0; round < kRounds && damped < 1e6; ++round) {
        const LeastSquares squares = detail::slopes_at(predict, x, here, wrong, range, unknowns);
        bool better = false;
        for (; !better && damped < 1e6; damped *= better ? 0.2 : 5.0) {
            const LeastSquares::Row change = squares.solved(damped);
            LeastSquares::Row next = x;
            for (std::size_t i = 0; i < unknowns; ++i) {
                next[i] = std::clamp(x[i] + change[i], range.least[i], range.max[i]);
            }
            std::vector<double> there = predict(next);
            std::vector<double> left = detail::missed(measured, there);
            better = detail::squares_of(left) < detail::squares_of(wrong);
            if (better) {
                const bool enough = detail::squares_of(left) > 0.9999 * detail::squares_of(wrong);
                x = next;
                here = std::move(there);
                wrong = std::move(left);
                if (enough) {
                    return x;
                }
            }
        }
    }
    return x;
}

/// A motion from rest as who reads it `late` samples later sees it, in place.
/// @param motion  rows of `width` numbers a sample, each from 0   @param late  samples, >= 0
inline void see_late(std::span<double> motion, std::size_t width, double late) {
    const double whole = std::floor(late);
    const double part = late - whole;
    const auto back = static_cast<std::ptrdiff_t>(whole) * static_cast<std::ptrdiff_t>(width);
    const auto at = [&](std::ptrdiff_t i) {
        return i < 0 ? 0.0 : motion[static_cast<std::size_t>(i)];
    };
    for (std::ptrdiff_t i = std::ssize(motion) - 1; i >= 0; --i) {
        const std::ptrdiff_t from = i - back;
        motion[static_cast<std::size_t>(i)] =
            at(from) + part * (at(from - static_cast<std::ptrdiff_t>(width)) - at(from));
    }
}

/// What is left of a motion by its size, root mean square, beyond the rounding of both its ends to
/// whole counts; 0 for a motion of no size.
/// @param measured  as above   @param count  in its unit
[[nodiscard]] inline double left_over(std::span<const double> measured,
                                      std::span<const double> predicted,
                                      double count) {
    constexpr double kRounding = 0.5;
    double left = 0.0;
    double size = 0.0;
    double n = 0.0;
    for (std::size_t k = 0; k < measured.size(); ++k) {
        if (!std::isnan(measured[k])) {
            left += (measured[k] - predicted[k]) * (measured[k] - predicted[k]);
            size += measured[k] * measured[k];
            n += 1.0;
        }
    }
    return size > 0.0
             ? std::fmax(std::sqrt(left / size) - kRounding * count * std::sqrt(n / size), 0.0)
             : 0.0;
}

}  // namespace palpate::engine
