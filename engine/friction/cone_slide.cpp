#include "engine/friction/cone_slide.hpp"

#include "engine/friction/first_root.hpp"
#include "engine/geometry/arc_length.hpp"

namespace palpate::engine {
namespace {

/// A root is sharp if rounding leaves open less than this share of the span's size.
constexpr double kSharpRoot = 1e-12;

/// Pieces ahead that a proof is found for at once; behind it is one.
constexpr int kPiecesAhead = 3;

/// A place in a piece, in the direction of a walk: x from its start, y to its end.
struct InPiece {
    double x;
    double y;
};

InPiece in_piece(const ConeForms::Piece& piece, const Spot& spot, double dir) noexcept {
    const double width = piece.hi - piece.lo;
    const double from = (spot.u - piece.lo) / width;
    const double to = piece.hi == 1.0 ? spot.rest / width : (piece.hi - spot.u) / width;
    const InPiece at{std::clamp(from, 0.0, 1.0), std::clamp(to, 0.0, 1.0)};
    return dir > 0.0 ? at : InPiece{at.y, at.x};
}

/// The part of a net ahead of a place, x + y = 1. The smaller of the two is exact.
template <class Real>
void start_at(ConeNet<Real>& net, const InPiece& at) noexcept {
    if (at.x == 0.0) {
        return;
    }
    const bool early = at.x < at.y;
    const Real x = early ? Real(at.x) : Real(1.0) - Real(at.y);
    const Real y = early ? Real(1.0) - Real(at.x) : Real(at.y);
    cut_start<Real>(net, x, y);
}

/// tau and mu max(nu, 0) at a place, and their rounding.
struct Verdict {
    double direction;
    bool sure;
};

template <bool HasFriction, class Real>
Verdict verdict(const SlideTask& task, std::size_t piece, const Spot& spot) noexcept {
    ConeNet<Real> net;
    task.forms.net<Real>(piece, task.h, HasFriction ? task.mu : 0.0, 1.0, net);
    start_at<Real>(net, in_piece(task.forms[piece], spot, 1.0));
    const double noise = 3.0 * net.noise[0];
    const double tau = head(net.a[0]);
    const double load = head(net.a[0] - net.b[0]);  // mu nu
    const double excess = std::fabs(tau) - std::max(load, 0.0);
    return {.direction = excess <= noise ? 0.0
                       : tau < 0.0       ? -1.0
                                         : 1.0,
            .sure = std::fabs(excess) > noise};
}

template <bool HasFriction>
struct Slider {
    const SlideTask& task_;
    Spot& spot_;
    FallProof& proof_;
    double& used_;
    const RationalBezier<2>& curve_ = task_.forms.outline().spans()[task_.span];
    double mu_ = HasFriction ? task_.mu : 0.0;

    SlideEnd run() noexcept {
        const bool limited = task_.budget < std::numeric_limits<double>::infinity();
        std::size_t piece = first_piece();
        while (true) {
            bool in_cone = false;
            if (limited) {
                const Spot before = spot_;
                in_cone = goes_through(piece);
                if (!pays(before)) {
                    return SlideEnd::out_of_budget;
                }
            } else {
                in_cone = goes_through(piece);
            }
            if (in_cone) {
                return SlideEnd::in_cone;
            }
            if (task_.dir > 0.0 ? spot_.u == 1.0 : spot_.u == 0.0) {
                spot_.jet = curve_.at(spot_.u, spot_.rest);
                return SlideEnd::at_end;
            }
            piece += task_.dir > 0.0 ? 1 : static_cast<std::size_t>(-1);
        }
    }

    /// Mostly that of the last proof.
    [[nodiscard]] std::size_t first_piece() const noexcept {
        const ConeForms::Piece& last = task_.forms[proof_.piece];
        return last.span == task_.span && spot_.u > last.lo && spot_.u < last.hi
                 ? proof_.piece
                 : task_.forms.ahead(task_.span, spot_.u, task_.dir);
    }

    /// Goes to the first root in the piece, or to its end. @return whether there is one
    bool goes_through(std::size_t piece) noexcept {
        if (task_.forms.tame(task_.span) && falls(piece)) {
            switch (follow(piece)) {
                case FallEnd::root:
                    return true;
                case FallEnd::end:
                    return false;
                case FallEnd::lost:
                    break;
            }
        }
        FirstRoot root = search<double>(piece);
        if (root.answer == FirstRoot::Answer::unclear) {
            root = search<Twice>(piece);
        }
        if (root.answer == FirstRoot::Answer::none) {
            to_end(piece);
            return false;
        }
        return true;
    }

    /// A proof that the excess falls over the piece is known, or found, and then for some pieces
    /// beside it, too, as long as they cost it no more than half of its slack.
    bool falls(std::size_t piece) noexcept {
        const ConeForms::Piece& p = task_.forms[piece];
        if (proof_.span == p.span && p.lo >= proof_.lo && p.hi <= proof_.hi &&
            proof_.holds(task_.h)) {
            return true;
        }
        const double own = task_.forms.fall_slack(piece, task_.h);
        proof_ = {.span = p.span,
                  .piece = piece,
                  .lo = p.lo,
                  .hi = p.hi,
                  .h = task_.h,
                  .bend = proof_.bend};
        if (!(own > 0.0)) {
            return false;
        }
        double slack = own;
        const auto widen = [&](bool forward) {
            if (forward ? proof_.hi == 1.0 : proof_.lo == 0.0) {
                return false;
            }
            const std::size_t next =
                task_.forms.ahead(p.span, forward ? proof_.hi : proof_.lo, forward ? 1.0 : -1.0);
            const double more = task_.forms.fall_slack(next, task_.h);
            if (!(more > 0.5 * own)) {
                return false;
            }
            slack = std::min(slack, more);
            (forward ? proof_.hi : proof_.lo) =
                forward ? task_.forms[next].hi : task_.forms[next].lo;
            return true;
        };
        for (int i = 0; i < kPiecesAhead && widen(task_.dir > 0.0); ++i) {
        }
        widen(task_.dir < 0.0);
        proof_.slack2 = slack * slack;
        return true;
    }

    /// To the one root that the piece may have.
    FallEnd follow(std::size_t piece) noexcept {
        return follow_fall<HasFriction>(way(piece), spot_, proof_.bend,
                                        fall_at<HasFriction>(spot_.jet, task_.h, mu_, task_.dir));
    }

    [[nodiscard]] FallingWay way(std::size_t piece) const noexcept {
        const ConeForms::Piece& p = task_.forms[piece];
        return {.curve = curve_, .lo = p.lo, .hi = p.hi, .h = task_.h, .mu = mu_, .dir = task_.dir};
    }

    void move_to(double u) noexcept { spot_ = spot_at(curve_, u, 1.0 - u); }

    void to_end(std::size_t piece) noexcept {
        const ConeForms::Piece& p = task_.forms[piece];
        move_to(task_.dir > 0.0 ? p.hi : p.lo);
    }

    template <class Real>
    FirstRoot search(std::size_t piece) noexcept {
        const ConeForms::Piece& p = task_.forms[piece];
        const InPiece start = in_piece(p, spot_, task_.dir);
        ConeNet<Real> net;
        task_.forms.net<Real>(piece, task_.h, mu_, task_.dir, net);
        start_at<Real>(net, start);
        FirstRoot root = first_root<Real>(net);
        if (root.answer != FirstRoot::Answer::found) {
            return root;
        }
        if (root.z > 0.0 && !land(piece, start, root, std::is_same_v<Real, double>)) {
            root.answer = FirstRoot::Answer::unclear;
        }
        return root;
    }

    /// Goes to a root. False, and nothing moved, if it has to be sharp and is not.
    bool land(std::size_t index, const InPiece& start, const FirstRoot& root, bool sharp) noexcept {
        const ConeForms::Piece& piece = task_.forms[index];
        const double x = start.x + root.z * start.y;
        const double y = root.rest * start.y;
        const double width = piece.hi - piece.lo;
        const bool forward = task_.dir > 0.0;
        const double u = piece.lo + (forward ? x : y) * width;
        const double rest = (1.0 - piece.hi) + (forward ? y : x) * width;
        const Spot there = spot_at(curve_, u, rest);
        const double blur = root.blur * start.y * width * glm::length(there.jet.first);
        if (sharp && !(blur <= kSharpRoot * task_.forms.size(task_.span))) {
            return false;
        }
        spot_ = there;
        if (task_.forms.tame(task_.span)) {
            static_cast<void>(falling::finish<HasFriction>(
                way(index), spot_, 0.0, -std::numeric_limits<double>::infinity()));
        }
        return true;
    }

    /// Takes the way of a slide from the budget. @return false if the budget ends on it: the spot
    /// is there then
    bool pays(const Spot& before) noexcept {
        const double left = std::max(task_.budget - used_, 0.0);
        const double way = way_along(curve_, {before.u, before.rest}, {spot_.u, spot_.rest});
        if (way <= left) {
            used_ += way;
            return true;
        }
        spot_ = place_along(before, left, way);
        used_ = task_.budget;
        return false;
    }

    /// The place `left` m along the way from a spot to this one, by Newton's steps between two
    /// places that enclose it. @param way  all of it, m
    [[nodiscard]] Spot place_along(const Spot& before, double left, double way) const noexcept {
        constexpr int kMaxSteps = 40;
        constexpr double kNear = 1e-13;  // of the whole way
        const Parameter from{before.u, before.rest};
        const Parameter to{spot_.u, spot_.rest};
        double lo = 0.0;  // shares of what the parameter goes by
        double hi = 1.0;
        double share = left / way;
        Spot at = before;
        for (int i = 0; i < kMaxSteps; ++i) {
            const Parameter there = between(from, to, share);
            at = spot_at(curve_, there.u, there.rest);
            const double over = way_along(curve_, from, there) - left;
            if (std::fabs(over) <= kNear * way) {
                break;
            }
            (over < 0.0 ? lo : hi) = share;
            const double newton = share - over / (distance(from, to) * glm::length(at.jet.first));
            share = newton > lo && newton < hi ? newton : 0.5 * (lo + hi);
        }
        return at;
    }
};

}  // namespace

template <bool HasFriction>
double direction_by_forms(const SlideTask& task, const Spot& spot) noexcept {
    const std::size_t piece = task.forms.ahead(task.span, spot.u, 1.0);
    const Verdict quick = verdict<HasFriction, double>(task, piece, spot);
    return quick.sure ? quick.direction : verdict<HasFriction, Twice>(task, piece, spot).direction;
}

template <bool HasFriction>
SlideEnd slide_to_cone(const SlideTask& task, Spot& spot, FallProof& proof, double& used) noexcept {
    return Slider<HasFriction>{task, spot, proof, used}.run();
}

template double direction_by_forms<true>(const SlideTask&, const Spot&) noexcept;
template double direction_by_forms<false>(const SlideTask&, const Spot&) noexcept;
template SlideEnd slide_to_cone<true>(const SlideTask&, Spot&, FallProof&, double&) noexcept;
template SlideEnd slide_to_cone<false>(const SlideTask&, Spot&, FallProof&, double&) noexcept;

}  // namespace palpate::engine
