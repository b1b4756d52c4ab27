#pragma once

#include "engine/surface/nurbs_surface.hpp"
#include "tests/support/nurbs_oracle.hpp"

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

using Long3 = glm::vec<3, long double>;

inline double length(const Long3& a) {
    return static_cast<double>(std::sqrt(glm::dot(a, a)));
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

/// A place of a surface, and |S - h|^2 there, m^2.
struct LongFoot {
    long double distance2 = 1e300L;
    Long3 point{};
};

/// The two principal curvatures, 1/m, low <= high. > 0: the surface curves away from its normal, as
/// a ball seen from outside does (the convention of engine/geometry/arc.hpp).
struct Curvatures {
    double low = 0.0;
    double high = 0.0;
};

/// @param normal  unit normal at the place of `jet`
///
/// From the two fundamental forms (do Carmo, Differential Geometry, 3-3, eq. 7 and 8), relative
/// error about 1e-15 times the largest over the smallest of |du|^2, |dv|^2 and |du x dv|. Both are
/// 0 where du x dv vanishes.
///
/// The shape operator in an orthonormal frame of the tangent plane: half the difference of its
/// eigenvalues is then a length of two small numbers, not the root of a cancelled difference.
inline Curvatures principal_curvatures(const engine::SurfaceJet& jet, const engine::Vec3& normal) {
    const double e = glm::dot(jet.du, jet.du);
    const engine::Vec3 area = glm::cross(jet.du, jet.dv);
    const double area2 = glm::dot(area, area);  // e g - f^2 without its cancellation
    if (!(e > 0.0) || !(area2 > 0.0)) {
        return {};
    }
    const double shear = glm::dot(jet.du, jet.dv) / e;
    const double height2 = area2 / e;  // of dv above du
    const double l = -glm::dot(jet.duu, normal);
    const double m = -glm::dot(jet.duv, normal);
    const double n = -glm::dot(jet.dvv, normal);
    const double a = l / e;
    const double b = (m - shear * l) / std::sqrt(area2);
    const double c = (n - shear * (2.0 * m - shear * l)) / height2;
    const double mean = 0.5 * (a + c);
    const double skew = 0.5 * (a - c);
    const double half = std::sqrt(skew * skew + b * b);
    return {mean - half, mean + half};
}

/// A surface and distances from it by its definition in long double, written from the book and not
/// from the code under test.
class SurfaceOracle {
public:
    explicit SurfaceOracle(SurfaceData data) : d_(std::move(data)) {
        pieces_u_ = pieces(d_.knots_u);
        pieces_v_ = pieces(d_.knots_v);
    }

    [[nodiscard]] LongJet jet(std::size_t pu, std::size_t pv, long double u, long double v) const {
        const auto a = basis_jet(d_.knots_u, pu, d_.degree_u, d_.points.size(), u);
        const auto b = basis_jet(d_.knots_v, pv, d_.degree_v, d_.points[0].size(), v);
        const auto sum = [&](std::size_t k, std::size_t l) {
            glm::vec<4, long double> h(0.0L);
            for (std::size_t i = 0; i < a[k].size(); ++i) {
                for (std::size_t j = 0; j < b[l].size(); ++j) {
                    const long double w =
                        a[k][i] * b[l][j] * (d_.weights.empty() ? 1.0 : d_.weights[i][j]);
                    h += w * glm::vec<4, long double>(d_.points[i][j], 1.0);
                }
            }
            return h;
        };
        const auto h = sum(0, 0), hu = sum(1, 0), hv = sum(0, 1);
        const auto huu = sum(2, 0), huv = sum(1, 1), hvv = sum(0, 2);
        const long double w = 1.0L / h.w;
        LongJet r;
        r.s = w * Long3(h);
        r.su = w * (Long3(hu) + -hu.w * r.s);
        r.sv = w * (Long3(hv) + -hv.w * r.s);
        r.suu = w * (Long3(huu) + -2.0L * hu.w * r.su + -huu.w * r.s);
        r.suv = w * (Long3(huv) + -hu.w * r.sv + -hv.w * r.su + -huv.w * r.s);
        r.svv = w * (Long3(hvv) + -2.0L * hv.w * r.sv + -hvv.w * r.s);
        return r;
    }

    [[nodiscard]] LongJet jet(long double u, long double v) const {
        return jet(knot_piece(d_.knots_u, u), knot_piece(d_.knots_v, v), u, v);
    }

    /// The place of the surface next to h: a dense grid on every patch, then damped Newton within
    /// the patch from its best local grid minima. Samples, not a proof, but of another kind.
    [[nodiscard]] LongFoot closest(const engine::Vec3& h, std::size_t n = 24) {
        if (grid_.empty() || n_ != n) {
            sample(n);
        }
        LongFoot best;
        std::size_t patch = 0;
        for (const std::size_t pu : pieces_u_) {
            for (const std::size_t pv : pieces_v_) {
                best = nearer(best, h, pu, pv, grid_[patch]);
                ++patch;
            }
        }
        return best;
    }
    /// How far that is, m.
    [[nodiscard]] long double distance(const engine::Vec3& h, std::size_t n = 24) {
        return std::sqrt(closest(h, n).distance2);
    }

    [[nodiscard]] const SurfaceData& data() const { return d_; }

private:
    static std::vector<std::size_t> pieces(const std::vector<double>& t) {
        std::vector<std::size_t> found;
        for (std::size_t i = 0; i + 1 < t.size(); ++i) {
            if (t[i] < t[i + 1]) {
                found.push_back(i);
            }
        }
        return found;
    }
    void sample(std::size_t n) {
        n_ = n;
        grid_.clear();
        for (const std::size_t pu : pieces_u_) {
            for (const std::size_t pv : pieces_v_) {
                std::vector<Long3> points;
                for (std::size_t i = 0; i <= n; ++i) {
                    for (std::size_t j = 0; j <= n; ++j) {
                        points.push_back(
                            jet(pu, pv, at(d_.knots_u, pu, i), at(d_.knots_v, pv, j)).s);
                    }
                }
                grid_.push_back(std::move(points));
            }
        }
    }
    [[nodiscard]] long double at(const std::vector<double>& t,
                                 std::size_t piece,
                                 std::size_t i) const {
        const long double lo = t[piece];
        return lo +
               (t[piece + 1] - lo) * static_cast<long double>(i) / static_cast<long double>(n_);
    }

    /// `best`, or what is nearer on this patch.
    [[nodiscard]] LongFoot nearer(LongFoot best,
                                  const engine::Vec3& h,
                                  std::size_t pu,
                                  std::size_t pv,
                                  const std::vector<Long3>& grid) const {
        const std::size_t side = n_ + 1;
        std::vector<long double> d2(side * side);
        long double step2 = 0.0L;
        for (std::size_t k = 0; k < d2.size(); ++k) {
            const Long3 gap = grid[k] - Long3(h);
            d2[k] = glm::dot(gap, gap);
            if (k >= side) {
                const Long3 edge = grid[k] - grid[k - side];
                step2 = std::max(step2, glm::dot(edge, edge));
            }
            if (k % side != 0) {
                const Long3 edge = grid[k] - grid[k - 1];
                step2 = std::max(step2, glm::dot(edge, edge));
            }
        }
        const long double reach = std::sqrt(best.distance2) + 3.0L * std::sqrt(step2);
        std::vector<std::pair<long double, std::size_t>> starts;
        for (std::size_t i = 0; i < side; ++i) {
            for (std::size_t j = 0; j < side; ++j) {
                const std::size_t k = i * side + j;
                bool lowest = best.distance2 > 1e299L || std::sqrt(d2[k]) < reach;
                for (int a = -1; a <= 1 && lowest; ++a) {
                    for (int b = -1; b <= 1; ++b) {
                        const auto ii = static_cast<long>(i) + a;
                        const auto jj = static_cast<long>(j) + b;
                        const auto s = static_cast<long>(side);
                        if (ii >= 0 && jj >= 0 && ii < s && jj < s &&
                            d2[static_cast<std::size_t>(ii * s + jj)] < d2[k]) {
                            lowest = false;
                        }
                    }
                }
                if (lowest) {
                    starts.emplace_back(d2[k], k);
                }
            }
        }
        std::sort(starts.begin(), starts.end());
        starts.resize(std::min<std::size_t>(starts.size(), 12));
        for (const auto& [value, k] : starts) {
            const LongFoot foot =
                descend(h, pu, pv, at(d_.knots_u, pu, k / side), at(d_.knots_v, pv, k % side));
            best = foot.distance2 < best.distance2 ? foot : best;
        }
        return best;
    }

    /// Levenberg's method with bounds: lowers |S - h|^2 until no step does.
    [[nodiscard]] LongFoot descend(
        const engine::Vec3& h, std::size_t pu, std::size_t pv, long double u, long double v) const {
        const long double lo_u = d_.knots_u[pu], hi_u = d_.knots_u[pu + 1];
        const long double lo_v = d_.knots_v[pv], hi_v = d_.knots_v[pv + 1];
        LongJet j = jet(pu, pv, u, v);
        Long3 r = j.s - Long3(h);
        long double value = glm::dot(r, r);
        long double damp = 0.0L;
        for (int step = 0; step < 200; ++step) {
            const long double gu = glm::dot(r, j.su), gv = glm::dot(r, j.sv);
            const bool fix_u = (u <= lo_u && gu > 0.0L) || (u >= hi_u && gu < 0.0L);
            const bool fix_v = (v <= lo_v && gv > 0.0L) || (v >= hi_v && gv < 0.0L);
            long double a = glm::dot(j.su, j.su) + glm::dot(r, j.suu);
            long double c = glm::dot(j.sv, j.sv) + glm::dot(r, j.svv);
            const long double b = fix_u || fix_v ? 0.0L : glm::dot(j.su, j.sv) + glm::dot(r, j.suv);
            const long double scale_u = glm::dot(j.su, j.su) + 1e-300L;
            const long double scale_v = glm::dot(j.sv, j.sv) + 1e-300L;
            a += damp * scale_u;
            c += damp * scale_v;
            a = fix_u ? 1.0L : a;  // held: its curvature is nobody's business
            c = fix_v ? 1.0L : c;
            const long double det = a * c - b * b;
            if (!(a > 0.0L && c > 0.0L && det > 0.0L) && damp < 1e30L) {
                damp = std::max(2.0L * damp, 1e-3L);
                continue;
            }
            long double du = fix_u ? 0.0L : (b * gv - c * gu) / det;
            long double dv = fix_v ? 0.0L : (b * gu - a * gv) / det;
            if (u + du < lo_u || u + du > hi_u) {  // on the bound the other one settles anew
                du = std::clamp(u + du, lo_u, hi_u) - u;
                dv = fix_v ? 0.0L : -(gv + b * du) / c;
            }
            if (v + dv < lo_v || v + dv > hi_v) {
                dv = std::clamp(v + dv, lo_v, hi_v) - v;
                du = fix_u ? 0.0L : -(gu + b * dv) / a;
            }
            const long double nu = std::clamp(u + du, lo_u, hi_u);
            const long double nv = std::clamp(v + dv, lo_v, hi_v);
            const LongJet jn = jet(pu, pv, nu, nv);
            const Long3 rn = jn.s - Long3(h);
            const long double next = glm::dot(rn, rn);
            if (next <= value * (1.0L + 1e-18L)) {  // flat at its minimum: on until u and v settle
                const bool settled = std::fabs(nu - u) + std::fabs(nv - v) < 1e-17L;
                u = nu;
                v = nv;
                j = jn;
                r = rn;
                value = std::min(value, next);
                damp = damp < 1e-12L ? 0.0L : damp / 8.0L;
                if (settled) {
                    break;
                }
            } else if (damp > 1e20L) {
                break;
            } else {
                damp = std::max(8.0L * damp, 1e-12L);
            }
        }
        return {value, j.s};
    }

    SurfaceData d_;
    std::vector<std::size_t> pieces_u_;
    std::vector<std::size_t> pieces_v_;
    std::size_t n_ = 0;
    std::vector<std::vector<Long3>> grid_;
};

}  // namespace palpate::tests
