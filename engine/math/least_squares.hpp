#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace palpate::engine {

/// Least squares by normal equations, at most kMax unknowns.
class LeastSquares {
public:
    static constexpr std::size_t kMax = 11;
    using Row = std::array<double, kMax>;

    /// @param unknowns  at most kMax; of a row only so many are read
    explicit LeastSquares(std::size_t unknowns) : n_(unknowns) {}

    /// One equation: the unknowns times `row` should be `value`. All weigh alike.
    void add(const Row& row, double value) noexcept {
        for (std::size_t i = 0; i < n_; ++i) {
            for (std::size_t j = 0; j < n_; ++j) {
                a_[i][j] += row[i] * row[j];
            }
            b_[i] += row[i] * value;
        }
    }
    /// Gauss's elimination, each unknown scaled by its column; one that the rows do not tell is 0.
    /// @param damped  share of each diagonal added to it
    [[nodiscard]] Row solved(double damped = 1e-12) const noexcept {
        auto a = a_;
        Row b = b_;
        Row scale{};
        for (std::size_t i = 0; i < n_; ++i) {
            scale[i] = a_[i][i] > 0.0 ? 1.0 / std::sqrt(a_[i][i]) : 0.0;
        }
        for (std::size_t i = 0; i < n_; ++i) {
            for (std::size_t j = 0; j < n_; ++j) {
                a[i][j] *= scale[i] * scale[j];
            }
            a[i][i] += damped + 1e-12;
            b[i] *= scale[i];
        }
        for (std::size_t k = 0; k < n_; ++k) {  // symmetric, positive definite: no pivots
            for (std::size_t i = k + 1; i < n_; ++i) {
                const double share = a[i][k] / a[k][k];
                for (std::size_t j = k; j < n_; ++j) {
                    a[i][j] -= share * a[k][j];
                }
                b[i] -= share * b[k];
            }
        }
        Row x{};
        for (std::size_t k = n_; k-- > 0;) {
            double rest = b[k];
            for (std::size_t j = k + 1; j < n_; ++j) {
                rest -= a[k][j] * x[j];
            }
            x[k] = rest / a[k][k];
        }
        for (std::size_t i = 0; i < n_; ++i) {
            x[i] *= scale[i];
        }
        return x;
    }

private:
    std::size_t n_;
    std::array<Row, kMax> a_{};
    Row b_{};
};

}  // namespace palpate::engine
