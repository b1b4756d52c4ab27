#include "engine/contact/bernstein_net.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::engine {

BernsteinNet::Lowest BernsteinNet::lowest() const noexcept {
    std::size_t best = 0;
    for (std::size_t k = 1; k < count(); ++k) {
        best = g_[k] < g_[best] ? k : best;
    }
    return {g_[best], static_cast<double>(best / (m_ + 1)) / static_cast<double>(n_),
            static_cast<double>(best % (m_ + 1)) / static_cast<double>(m_)};
}

double BernsteinNet::highest() const noexcept {
    return *std::max_element(g_.data(), g_.data() + count());
}

bool BernsteinNet::convex(double noise) const noexcept {
    double uu = 1e300;
    double vv = 1e300;
    double uv = 0.0;
    for (std::size_t i = 0; i + 2 <= n_; ++i) {
        for (std::size_t j = 0; j <= m_; ++j) {
            uu = std::min(uu, (at(i + 2, j) - at(i + 1, j)) - (at(i + 1, j) - at(i, j)));
        }
    }
    for (std::size_t i = 0; i <= n_; ++i) {
        for (std::size_t j = 0; j + 2 <= m_; ++j) {
            vv = std::min(vv, (at(i, j + 2) - at(i, j + 1)) - (at(i, j + 1) - at(i, j)));
        }
    }
    for (std::size_t i = 0; i < n_; ++i) {
        for (std::size_t j = 0; j < m_; ++j) {
            uv = std::max(uv,
                          std::fabs((at(i + 1, j + 1) - at(i + 1, j)) - (at(i, j + 1) - at(i, j))));
        }
    }
    const auto n = static_cast<double>(n_);
    const auto m = static_cast<double>(m_);
    uu = n * (n - 1.0) * (uu - 4.0 * noise);
    vv = m * (m - 1.0) * (vv - 4.0 * noise);
    uv = n * m * (uv + 4.0 * noise);
    return uu > 0.0 && vv > 0.0 && uu * vv > uv * uv;
}

bool BernsteinNet::bends_more_in_u() const noexcept {
    double u = 0.0;
    double v = 0.0;
    for (std::size_t i = 0; i <= n_; ++i) {
        for (std::size_t j = 0; j <= m_; ++j) {
            if (i + 2 <= n_) {
                u = std::max(u, std::fabs(at(i + 2, j) - 2.0 * at(i + 1, j) + at(i, j)));
            }
            if (j + 2 <= m_) {
                v = std::max(v, std::fabs(at(i, j + 2) - 2.0 * at(i, j + 1) + at(i, j)));
            }
        }
    }
    const auto n = static_cast<double>(n_);
    const auto m = static_cast<double>(m_);
    return n * n * u >= m * m * v;
}

void BernsteinNet::cut_u(double t, BernsteinNet& before) noexcept {
    before.n_ = n_;
    before.m_ = m_;
    const double s = 1.0 - t;
    const std::size_t row = m_ + 1;
    for (std::size_t level = 0; level <= n_; ++level) {
        std::copy_n(g_.data(), row, before.g_.data() + level * row);
        for (std::size_t k = 0; k < (n_ - level) * row; ++k) {
            g_[k] = s * g_[k] + t * g_[k + row];
        }
    }
}

void BernsteinNet::cut_v(double t, BernsteinNet& before) noexcept {
    before.n_ = n_;
    before.m_ = m_;
    const double s = 1.0 - t;
    const std::size_t row = m_ + 1;
    for (std::size_t i = 0; i <= n_; ++i) {
        double* line = g_.data() + i * row;
        double* left = before.g_.data() + i * row;
        for (std::size_t level = 0; level <= m_; ++level) {
            left[level] = line[0];
            for (std::size_t k = 0; k < m_ - level; ++k) {
                line[k] = s * line[k] + t * line[k + 1];
            }
        }
    }
}

}  // namespace palpate::engine
