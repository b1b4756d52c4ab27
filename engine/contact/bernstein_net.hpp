#pragma once

#include <array>
#include <cstddef>

#include "engine/geometry/rational_bezier.hpp"

namespace palpate::engine {

/// A polynomial g(u, v) on a square by its Bernstein coefficients, degree up to 18 x 18.
///
/// g lies between its smallest and largest coefficient (convex hull property), and so do its second
/// derivatives with theirs. Cutting halves makes these bounds converge quadratically.
class BernsteinNet {
public:
    static constexpr std::size_t kMaxSide = 2 * kMaxDegree + 1;

    /// Rubbish until another is copied or cut into it.
    BernsteinNet() noexcept = default;
    /// @param n, m  degrees in u and v, at most 18; the coefficients are rubbish until written
    // NOLINTNEXTLINE: 3 kB of coefficients are left as they are on purpose
    BernsteinNet(std::size_t n, std::size_t m) noexcept : n_(n), m_(m) {}
    /// Copies what its degrees need, not all 3 kB.
    BernsteinNet(const BernsteinNet& other) noexcept : n_(other.n_), m_(other.m_) { copy(other); }
    BernsteinNet& operator=(const BernsteinNet& other) noexcept {
        n_ = other.n_;
        m_ = other.m_;
        copy(other);
        return *this;
    }

    /// The degree in u.
    [[nodiscard]] std::size_t n() const noexcept { return n_; }
    /// The degree in v.
    [[nodiscard]] std::size_t m() const noexcept { return m_; }
    /// How many coefficients there are.
    [[nodiscard]] std::size_t count() const noexcept { return (n_ + 1) * (m_ + 1); }
    /// Coefficient i (m + 1) + j belongs to u^i v^j.
    [[nodiscard]] double* data() noexcept { return g_.data(); }
    [[nodiscard]] double at(std::size_t i, std::size_t j) const noexcept {
        return g_[i * (m_ + 1) + j];
    }

    struct Lowest {
        double value = 0.0;
        double u = 0.0;  ///< where its coefficient stands
        double v = 0.0;
    };
    /// The smallest coefficient and its place: no value of the polynomial is smaller.
    [[nodiscard]] Lowest lowest() const noexcept;
    /// The largest coefficient: no value of the polynomial is larger.
    [[nodiscard]] double highest() const noexcept;

    /// Second derivatives form a bowl everywhere, by more than `noise`.
    [[nodiscard]] bool convex(double noise) const noexcept;
    /// Largest second difference along u is larger than along v: cut u next.
    [[nodiscard]] bool bends_more_in_u() const noexcept;

    /// This net becomes the part beyond t of u (or v), `before` the part before.
    void cut_u(double t, BernsteinNet& before) noexcept;
    void cut_v(double t, BernsteinNet& before) noexcept;

private:
    void copy(const BernsteinNet& other) noexcept {
        for (std::size_t k = 0; k < count(); ++k) {
            g_[k] = other.g_[k];
        }
    }

    std::size_t n_;
    std::size_t m_;
    std::array<double, kMaxSide * kMaxSide> g_;
};

}  // namespace palpate::engine
