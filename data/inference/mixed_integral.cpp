#include "data/inference/mixed_integral.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "data/statistics/solve.hpp"

namespace palpate::data {
namespace {

/// What (s0, s1) = L u does to a person's two logits, and their answers.
struct PersonIntegral {
    const TwoCounts& person;
    std::array<double, 2> fixed;
    std::array<std::array<double, 2>, 2> along;  ///< d logit c / d u

    [[nodiscard]] double value(double u0, double u1) const {
        double sum = -0.5 * (u0 * u0 + u1 * u1);
        for (std::size_t c = 0; c < 2; ++c) {
            const double logit = fixed[c] + along[c][0] * u0 + along[c][1] * u1;
            // log(1 + e^x) without overflow
            const double soft = std::max(logit, 0.0) + std::log1p(std::exp(-std::fabs(logit)));
            sum += person.k[c] * logit - person.n[c] * soft;
        }
        return sum;
    }
};

/// The maximum of a PersonIntegral, and L of its curvature L L'.
struct Peak {
    double u0 = 0.0;
    double u1 = 0.0;
    double l00 = 1.0;
    double l10 = 0.0;
    double l11 = 1.0;
};

Peak peak_of(const PersonIntegral& of) {
    Peak peak;
    for (int step = 0; step < 100; ++step) {
        double g0 = -peak.u0;
        double g1 = -peak.u1;
        double h00 = 1.0;
        double h10 = 0.0;
        double h11 = 1.0;
        for (std::size_t c = 0; c < 2; ++c) {
            const auto& z = of.along[c];
            const double p =
                1.0 / (1.0 + std::exp(-(of.fixed[c] + z[0] * peak.u0 + z[1] * peak.u1)));
            const double residual = of.person.k[c] - of.person.n[c] * p;
            const double weight = of.person.n[c] * p * (1.0 - p);
            g0 += residual * z[0];
            g1 += residual * z[1];
            h00 += weight * z[0] * z[0];
            h10 += weight * z[0] * z[1];
            h11 += weight * z[1] * z[1];
        }
        peak.l00 = std::sqrt(h00);
        peak.l10 = h10 / peak.l00;
        peak.l11 = std::sqrt(h11 - peak.l10 * peak.l10);
        const double y0 = g0 / peak.l00;
        const double y1 = (g1 - peak.l10 * y0) / peak.l11;
        if (y0 * y0 + y1 * y1 < 1e-22) {
            break;
        }
        const double s1 = y1 / peak.l11;
        const double s0 = (y0 - peak.l10 * s1) / peak.l00;
        double share = 1.0;
        if (y0 * y0 + y1 * y1 > 0.25) {  // the sum is concave: a short enough step gains
            const double now = of.value(peak.u0, peak.u1);
            while (share > 1e-6 && of.value(peak.u0 + share * s0, peak.u1 + share * s1) < now) {
                share *= 0.5;
            }
        }
        peak.u0 += share * s0;
        peak.u1 += share * s1;
    }
    return peak;
}

double log_integral(const PersonIntegral& of, const Nodes& nodes) {
    const Peak peak = peak_of(of);
    const double top = of.value(peak.u0, peak.u1);
    double sum = 0.0;
    for (std::size_t i = 0; i < nodes.at.size(); ++i) {
        for (std::size_t j = 0; j < nodes.at.size(); ++j) {
            const double zi = nodes.at[i];
            const double zj = nodes.at[j];
            const double d1 = std::numbers::sqrt2 * zj / peak.l11;
            const double d0 = (std::numbers::sqrt2 * zi - peak.l10 * d1) / peak.l00;
            sum += nodes.weight[i] * nodes.weight[j] *
                   std::exp(of.value(peak.u0 + d0, peak.u1 + d1) - top + zi * zi + zj * zj);
        }
    }
    return top - std::log(peak.l00 * peak.l11) + std::log(sum / std::numbers::pi);
}

}  // namespace

Nodes gauss_hermite(int count) {
    const auto n = static_cast<std::size_t>(count);
    std::vector<double> jacobi(n * n);
    for (std::size_t i = 1; i < n; ++i) {
        jacobi[i * n + i - 1] = std::sqrt(0.5 * static_cast<double>(i));
        jacobi[(i - 1) * n + i] = jacobi[i * n + i - 1];
    }
    Spectrum parts = spectrum_of(jacobi);
    Nodes nodes{.at = std::move(parts.values)};
    for (const double first : parts.first) {
        nodes.weight.push_back(std::sqrt(std::numbers::pi) * first * first);
    }
    return nodes;
}

double mixed_deviance(std::span<const TwoCounts> people,
                      double b0,
                      double b1,
                      const std::array<double, 3>& l,
                      const Nodes& nodes) {
    double sum = 0.0;
    for (const TwoCounts& one : people) {
        sum += log_integral(
            {.person = one, .fixed = {b0, b0 + b1}, .along = {{{l[0], 0.0}, {l[0] + l[1], l[2]}}}},
            nodes);
    }
    return -2.0 * sum;
}

}  // namespace palpate::data
