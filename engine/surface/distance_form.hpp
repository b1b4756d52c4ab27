#pragma once

#include <vector>

#include "engine/contact/bernstein_net.hpp"
#include "engine/surface/surface_foot.hpp"

namespace palpate::engine {

/// |S(u, v) - h|^2 of a part of a patch as polynomials, linear in h and |h|^2.
///
/// With S = P / W, homogeneous P and W relative to a centre c, and q = h - c:
///
///     g = (|S - h|^2 - beta) W^2 = P.P - 2 q . (P W) + (|q|^2 - beta) W^2
///
/// where P.P, P W and W^2 are prepared here once in Bernstein form (Farouki & Rajan 1988, eq. 44,
/// in both directions). No point of a part of the patch lies closer than sqrt(beta) if no
/// coefficient of g over that part is negative: a proof over the whole part, not over samples.
class DistanceForm {
public:
    /// @param net  (degree_u + 1)(degree_v + 1) values w (P, 1), row after row
    /// @param c    centre for the products, in the coordinates of `net`
    DistanceForm(int degree_u, int degree_v, std::span<const Quad> net, const Vec3& c);

    [[nodiscard]] std::size_t n() const noexcept { return n_; }  ///< degree in u, 2 degree_u
    [[nodiscard]] std::size_t m() const noexcept { return m_; }
    [[nodiscard]] const Vec3& centre() const noexcept { return centre_; }
    [[nodiscard]] const std::vector<double>& pp() const noexcept { return pp_; }  ///< P.P
    [[nodiscard]] const std::vector<double>& pw(int k) const noexcept {
        return pw_[static_cast<std::size_t>(k)];
    }
    [[nodiscard]] const std::vector<double>& ww() const noexcept { return ww_; }  ///< W^2
    /// What cutting a net of these degrees in two costs.
    [[nodiscard]] Work cut_work() const noexcept {
        return static_cast<Work>((n_ + 1) * (m_ + 1) * ((n_ + m_) / 2 + 12));
    }
    [[nodiscard]] double largest_ww() const noexcept { return largest_ww_; }
    /// By how much W^2 can change from one end of the part to the other at the slope of any place,
    /// as a share of its smallest value.
    [[nodiscard]] double tilt_u() const noexcept { return tilt_u_; }
    [[nodiscard]] double tilt_v() const noexcept { return tilt_v_; }

    /// g of the whole part.
    [[nodiscard]] BernsteinNet net(const Vec3& h, double beta) const noexcept;
    /// Sum of the sizes of the terms of each coefficient of g, with what the control values lost
    /// when they were brought to the centre: what its rounding is relative to.
    [[nodiscard]] BernsteinNet terms(const Vec3& h, double beta) const noexcept;

private:
    std::size_t n_;
    std::size_t m_;
    Vec3 centre_;
    std::vector<double> pp_;
    std::array<std::vector<double>, 3> pw_;
    std::vector<double> ww_;
    double largest_ww_ = 0.0;
    double tilt_u_ = 0.0;
    double tilt_v_ = 0.0;
    double reach_ = 0.0;  ///< of the control points from the centre, m
};

/// What is known about one part of a patch and a distance.
struct Verdict {
    bool closer = false;   ///< a point closer than asked for was found
    SurfacePlace place{};  ///< it
    double lower2 = 0.0;   ///< if not: no point of the part is closer than this, m^2
    bool proven = true;    ///< false: the work limit came first; lower2 is then what was hoped
};

/// Is any point of `part` of its patch closer to h than sqrt(beta)? Halves the part until each
/// piece is decided by its coefficients, or is a bowl and its bottom known, or is below rounding.
/// @param form  of that part
/// @param patch  any place on it
/// @param h  relative to surface.origin(), m
/// @param work  counted down; below 0 the answer is not proven
[[nodiscard]] Verdict any_closer(const SurfaceObject& surface,
                                 const DistanceForm& form,
                                 const SurfacePlace& patch,
                                 const PatchPart& part,
                                 const Vec3& h,
                                 double beta,
                                 Work& work) noexcept;

}  // namespace palpate::engine
