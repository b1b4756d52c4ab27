#include "engine/surface/distance_form.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/math/bernstein.hpp"
#include "engine/surface/surface_object.hpp"

namespace palpate::engine {
namespace {

/// Pieces are halved to 2^-22 in each direction: 1e-9 m of a 5 mm leaf, whose middle is then within
/// 1e-16 m of its lowest distance.
constexpr int kMaxDepth = 44;

/// Rounding of a coefficient, as a share of the sizes of its terms: sums of 5, and convex
/// combinations.
constexpr double kNoise = 8.0 * kEpsilon;

/// Shares of the products of coefficients i and k of two polynomials of degree p in coefficient i +
/// k of their product, at i (p + 1) + k.
std::vector<double> shares(std::size_t p) {
    std::vector<double> table;
    for (std::size_t i = 0; i <= p; ++i) {
        for (std::size_t k = 0; k <= p; ++k) {
            table.push_back(binomial(p, i) * binomial(p, k) / binomial(2 * p, i + k));
        }
    }
    return table;
}

/// The pieces still to be decided, halves of halves.
class Pieces {
public:
    Pieces(const SurfaceObject& surface,
           const DistanceForm& form,
           const SurfacePlace& patch,
           const PatchPart& part,
           const Vec3& h,
           double beta) noexcept
        : surface_(surface),
          form_(form),
          patch_(patch),
          h_(h),
          beta_(beta),
          even_(surface.patch(patch).polynomial()),
          whole_(part) {
        const double distance = std::sqrt(beta);
        const double rounding = 4.0 * kEpsilon * (surface.size() + distance);
        const double closer = std::max(distance - rounding, 0.0);
        clearly_closer2_ = closer * closer;
    }

    Verdict decide(Work& work) noexcept {
        work_ = &work;
        const Work piece = form_.cut_work() * (even_ ? 1 : 2);
        work -= 4 * piece;
        verdict_.lower2 = std::numeric_limits<double>::infinity();
        Piece& whole = push(whole_, 0);
        whole.nets->g = form_.net(h_, beta_);
        whole.nets->terms = form_.terms(h_, beta_);
        whole.noise = kNoise * whole.nets->terms.highest();
        while (top_ > 0 && !verdict_.closer) {
            work -= piece;
            if (work < 0) {
                verdict_.proven = false;
                lower(beta_);
                break;
            }
            look(stack_[top_ - 1]);
        }
        return verdict_;
    }

private:
    struct Nets {
        BernsteinNet g;
        BernsteinNet terms;
    };
    struct Piece {
        PatchPart part{};
        int depth = 0;
        double noise = 0.0;  ///< size of the rounding errors in g
        Nets* nets = nullptr;
    };

    Piece& push(const PatchPart& part, int depth) noexcept {
        Piece& piece = stack_[top_];
        piece = {.part = part, .depth = depth, .nets = &nets_[top_]};
        ++top_;
        return piece;
    }

    void lower(double distance2) noexcept {
        verdict_.lower2 = std::min(verdict_.lower2, distance2);
    }

    /// True when a point of the surface at (u, v) of the patch is closer.
    bool offer(const SurfacePlace& place, double distance2) noexcept {
        if (distance2 < clearly_closer2_) {
            verdict_.closer = true;
            verdict_.place = place;
        }
        return verdict_.closer;
    }

    void look(Piece& piece) noexcept {
        const BernsteinNet::Lowest low = piece.nets->g.lowest();
        if (low.value >= -piece.noise) {
            lower(beta_ + std::max(low.value, 0.0) / form_.largest_ww());
            --top_;
            return;
        }
        const PatchPart part = piece.part;
        SurfacePlace place = patch_;
        place.u = part.lo_u + low.u * (part.hi_u - part.lo_u);
        place.v = part.lo_v + low.v * (part.hi_v - part.lo_v);
        const Vec3 r = surface_.local_jet(place).point - h_;
        if (offer(place, glm::dot(r, r))) {
            return;
        }
        if (piece.nets->g.convex(piece.noise)) {
            const SurfaceFoot foot = descend_within(surface_, h_, place, part, *work_);
            if (offer(foot.place, foot.distance2)) {
                return;
            }
            if (is_bottom(foot, part)) {
                --top_;
                return;
            }
        }
        if (piece.depth >= kMaxDepth) {
            lower(beta_);  // below rounding, and its lowest corner was looked at
            --top_;
            return;
        }
        halve(piece);
    }

    /// In a bowl: is the foot the lowest point of the part, to rounding? A bowl lies above its
    /// tangent plane, whose slope is that of the distance where W does not vary or g is 0.
    /// Elsewhere it is more by (D - beta) d(W^2), which takes away less than g = (D - beta) W^2
    /// has, while W^2 bends little.
    bool is_bottom(const SurfaceFoot& foot, const PatchPart& part) noexcept {
        const FootSlope slope(foot.jet, foot.jet.point - h_);
        const SurfacePlace& p = foot.place;
        const double room_u = slope.u > 0.0 ? p.u - part.lo_u : part.hi_u - p.u;
        const double room_v = slope.v > 0.0 ? p.v - part.lo_v : part.hi_v - p.v;
        const double drop = 2.0 * (std::fabs(slope.u) * room_u + std::fabs(slope.v) * room_v);
        const double distance = std::sqrt(foot.distance2);
        if (drop > 8.0 * kEpsilon * distance * (surface_.size() + distance)) {
            return false;
        }
        const double by_u = (part.hi_u - part.lo_u) / (whole_.hi_u - whole_.lo_u);
        const double by_v = (part.hi_v - part.lo_v) / (whole_.hi_v - whole_.lo_v);
        if (!even_ && form_.tilt_u() * by_u + form_.tilt_v() * by_v > 1.0 &&
            foot.distance2 > beta_ * (1.0 + 1e-9)) {
            return false;
        }
        lower(even_ ? foot.distance2 : beta_);
        return true;
    }

    /// The upper half stays, the lower half goes on top of it.
    void halve(Piece& piece) noexcept {
        PatchPart part = piece.part;
        ++piece.depth;
        Piece& before = push(part, piece.depth);
        before.noise = piece.noise;
        const bool in_u = piece.nets->g.bends_more_in_u();
        const auto cut = [in_u](BernsteinNet& net, BernsteinNet& first) {
            in_u ? net.cut_u(0.5, first) : net.cut_v(0.5, first);
        };
        cut(piece.nets->g, before.nets->g);
        if (!even_) {
            cut(piece.nets->terms, before.nets->terms);
            before.noise = kNoise * before.nets->terms.highest();
            piece.noise = kNoise * piece.nets->terms.highest();
        }
        double& end = in_u ? before.part.hi_u : before.part.hi_v;
        double& begin = in_u ? piece.part.lo_u : piece.part.lo_v;
        begin = end = begin + 0.5 * (end - begin);
    }

    const SurfaceObject& surface_;
    const DistanceForm& form_;
    SurfacePlace patch_;
    Vec3 h_;
    double beta_;
    bool even_;  ///< W = 1
    PatchPart whole_;
    double clearly_closer2_ = 0.0;  ///< beta, less the rounding of a point of the surface
    std::size_t top_ = 0;
    Work* work_ = nullptr;
    Verdict verdict_{};
    std::array<Piece, kMaxDepth + 2> stack_{};
    std::array<Nets, kMaxDepth + 2>
        nets_;  // NOLINT: 270 kB, rubbish until pushed; most need the first alone
};

}  // namespace

DistanceForm::DistanceForm(int degree_u, int degree_v, std::span<const Quad> net, const Vec3& c)
    : n_(2 * static_cast<std::size_t>(degree_u)),
      m_(2 * static_cast<std::size_t>(degree_v)),
      centre_(c) {
    const std::size_t p = n_ / 2;
    const std::size_t q = m_ / 2;
    const std::size_t count = (n_ + 1) * (m_ + 1);
    pp_.assign(count, 0.0);
    pw_.fill(std::vector<double>(count, 0.0));
    ww_.assign(count, 0.0);
    std::vector<Vec3> local;
    for (const Quad& point : net) {
        local.push_back(point.xyz() - point.w() * c);
        reach_ = std::max(reach_, glm::length(local.back()) / point.w());
    }
    const std::vector<double> share_u = shares(p);
    const std::vector<double> share_v = shares(q);
    for (std::size_t i = 0; i <= p; ++i) {
        for (std::size_t k = 0; k <= p; ++k) {
            const double by_u = share_u[i * (p + 1) + k];
            for (std::size_t j = 0; j <= q; ++j) {
                for (std::size_t l = 0; l <= q; ++l) {
                    const double by = by_u * share_v[j * (q + 1) + l];
                    const std::size_t a = i * (q + 1) + j;
                    const std::size_t b = k * (q + 1) + l;
                    const std::size_t at = (i + k) * (m_ + 1) + j + l;
                    pp_[at] += by * glm::dot(local[a], local[b]);
                    pw_[0][at] += by * net[b].w() * local[a].x;
                    pw_[1][at] += by * net[b].w() * local[a].y;
                    pw_[2][at] += by * net[b].w() * local[a].z;
                    ww_[at] += by * net[a].w() * net[b].w();
                }
            }
        }
    }
    largest_ww_ = largest_magnitude(ww_);
    const double least_ww = *std::min_element(ww_.begin(), ww_.end());
    const auto steepest = [&](std::size_t step, bool in_u) {
        double max = 0.0;
        for (std::size_t k = step; k < count; ++k) {
            const bool beside = in_u || k % (m_ + 1) != 0;
            max = beside ? std::max(max, std::fabs(ww_[k] - ww_[k - step])) : max;
        }
        return max / least_ww;
    };
    tilt_u_ = static_cast<double>(n_) * steepest(m_ + 1, true);
    tilt_v_ = static_cast<double>(m_) * steepest(1, false);
}

BernsteinNet DistanceForm::net(const Vec3& h, double beta) const noexcept {
    const Vec3 q = h - centre_;
    const double x = 2.0 * q.x;
    const double y = 2.0 * q.y;
    const double z = 2.0 * q.z;
    const double rest = glm::dot(q, q) - beta;
    BernsteinNet g(n_, m_);
    double* out = g.data();
    for (std::size_t k = 0; k < pp_.size(); ++k) {
        out[k] = (pp_[k] - (x * pw_[0][k] + y * pw_[1][k] + z * pw_[2][k])) + rest * ww_[k];
    }
    return g;
}

BernsteinNet DistanceForm::terms(const Vec3& h, double beta) const noexcept {
    const Vec3 q = h - centre_;
    const double x = std::fabs(2.0 * q.x);
    const double y = std::fabs(2.0 * q.y);
    const double z = std::fabs(2.0 * q.z);
    const double rest = glm::dot(q, q) + beta;
    const double lost = 2.0 * glm::length(centre_) * (reach_ + glm::length(q)) * largest_ww_;
    BernsteinNet sizes(n_, m_);
    double* out = sizes.data();
    for (std::size_t k = 0; k < pp_.size(); ++k) {
        out[k] = std::fabs(pp_[k]) + x * std::fabs(pw_[0][k]) + y * std::fabs(pw_[1][k]) +
                 z * std::fabs(pw_[2][k]) + rest * ww_[k] + lost;
    }
    return sizes;
}

Verdict any_closer(const SurfaceObject& surface,
                   const DistanceForm& form,
                   const SurfacePlace& patch,
                   const PatchPart& part,
                   const Vec3& h,
                   double beta,
                   Work& work) noexcept {
    return Pieces(surface, form, patch, part, h, beta).decide(work);
}

}  // namespace palpate::engine
