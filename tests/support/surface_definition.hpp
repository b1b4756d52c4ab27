#pragma once

#include "engine/surface/nurbs_surface.hpp"
#include "tests/support/random.hpp"

namespace palpate::tests {

/// A NURBS surface as its definition reads.
struct SurfaceData {
    int degree_u = 1;
    int degree_v = 1;
    std::vector<double> knots_u{};
    std::vector<double> knots_v{};
    std::vector<std::vector<engine::Vec3>> points{};
    std::vector<std::vector<double>> weights{};
};

inline engine::NurbsSurface make_surface(const SurfaceData& d) {
    return {d.degree_u, d.degree_v, d.knots_u, d.knots_v, d.points, d.weights};
}

using Long3 = std::array<long double, 3>;

inline Long3 operator+(const Long3& a, const Long3& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Long3 operator*(long double s, const Long3& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
inline long double inner(const Long3& a, const Long3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Long3 minus(const Long3& a, const engine::Vec3& h) {
    return {a[0] - h.x, a[1] - h.y, a[2] - h.z};
}

/// All N_i,p(u) of one degree on the piece [t_k, t_k+1] by Cox and de Boor (The NURBS Book, eq.
/// 2.5), as polynomials of that piece: u may be its closed end.
inline std::vector<long double> basis_row(
    const std::vector<double>& t, std::size_t piece, int p, std::size_t count, long double u) {
    std::vector<long double> n(t.size() - 1, 0.0L);
    n[piece] = 1.0L;
    for (int d = 1; d <= p; ++d) {
        const auto q = static_cast<std::size_t>(d);
        for (std::size_t i = 0; i + q + 1 < t.size(); ++i) {
            const long double left = static_cast<long double>(t[i + q]) - t[i];
            const long double right = static_cast<long double>(t[i + q + 1]) - t[i + 1];
            const long double a = left > 0.0L ? (u - t[i]) / left * n[i] : 0.0L;
            const long double b = right > 0.0L ? (t[i + q + 1] - u) / right * n[i + 1] : 0.0L;
            n[i] = a + b;
        }
    }
    n.resize(count);
    return n;
}

/// Derivatives 0, 1, 2 of the basis: eq. 2.7 of the same book, applied to lower degrees.
inline std::array<std::vector<long double>, 3> basis_jet(
    const std::vector<double>& t, std::size_t piece, int p, std::size_t count, long double u) {
    const auto lower = [&t](const std::vector<long double>& n, int d, std::size_t size) {
        std::vector<long double> slope(size, 0.0L);  // from degree d - 1 to the slope of degree d
        const auto q = static_cast<std::size_t>(d);
        for (std::size_t i = 0; i < size; ++i) {
            const long double left = static_cast<long double>(t[i + q]) - t[i];
            const long double right = static_cast<long double>(t[i + q + 1]) - t[i + 1];
            slope[i] = (left > 0.0L ? d / left * n[i] : 0.0L) -
                       (right > 0.0L ? d / right * n[i + 1] : 0.0L);
        }
        return slope;
    };
    std::array<std::vector<long double>, 3> jet;
    jet[0] = basis_row(t, piece, p, count, u);
    jet[1] = lower(basis_row(t, piece, p - 1, count + 1, u), p, count);
    jet[2].assign(count, 0.0L);
    if (p >= 2) {
        jet[2] = lower(lower(basis_row(t, piece, p - 2, count + 2, u), p - 1, count + 1), p, count);
    }
    return jet;
}

/// S, Su, Sv, Suu, Suv, Svv in long double from the definition and the quotient rule.
struct LongJet {
    Long3 s{}, su{}, sv{}, suu{}, suv{}, svv{};
};

}  // namespace palpate::tests
