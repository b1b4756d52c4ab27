#pragma once

#include "engine/friction/friction_law.hpp"
#include "engine/surface/surface_object.hpp"

namespace palpate::engine {

/// A place of the god-object on a surface with everything that is measured there. A bare
/// `SurfaceSpot s;` holds rubbish: to clear one, or to copy it, costs a quarter of an evaluation.
struct SurfaceSpot {
    SurfacePlace place;
    SurfaceJet jet;   ///< relative to surface.origin()
    Vec3 normal;      ///< unit, outward
    Vec3 r;           ///< HIP - GO, m
    double r2;        ///< |r|^2, m^2
    Vec3 along;       ///< tangential part of r, m
    double length;    ///< of it
    double load;      ///< -r . normal, m
    double cone;      ///< mu max(load, 0), m
    double excess;    ///< length - cone, m; > 0: outside of the cone
    double noise;     ///< rounding of a place, m
    double rounding;  ///< the width of the cone's shell that counts as its edge, m
};

/// What the god-object may do where it is.
struct Footing {
    enum class Way : std::uint8_t {
        rests,    ///< within its cone
        open,     ///< into the patch, in the direction of its drive
        along_u,  ///< along an edge v = 0 or 1, as u changes
        along_v,  ///< along an edge u = 0 or 1
        held,     ///< out of the cone, but every way on is barred
        over,     ///< so, and HIP is in front of a convex edge or tip: nothing holds it
    };
    SurfaceSpot spot;  ///< on the patch on which it goes on
    Way way = Way::rests;
    double excess = 0.0;  ///< of the drive in that way, m
    bool crease = false;  ///< the spot has the felt normal of a concave crease (against_hip)
};

/// Of two patches: their normals are one, within 1e-6 rad.
[[nodiscard]] bool smooth(const Vec3& a, const Vec3& b) noexcept;

/// The spot as it is felt with another normal.
[[gnu::always_inline]] inline void feel(SurfaceSpot& s, const Vec3& normal, double mu) noexcept {
    const Stretch<3> parts = stretch<3>(s.r, normal);
    s.normal = normal;
    s.along = parts.tangential;
    s.length = parts.length;
    s.load = parts.load;
    s.cone = cone_radius<true>(mu, s.load);
    s.excess = s.length - s.cone;
    s.rounding = 1e-14 * s.cone + s.noise;
}

/// What the god-object finds under its feet.
class SurfaceGround {
public:
    /// @param h  HIP relative to surface.origin(), m
    SurfaceGround(const SurfaceObject& surface, const Vec3& h, double mu) noexcept
        : surface_(surface), h_(h), mu_(mu) {}

    /// As they were given.
    [[nodiscard]] const SurfaceObject& surface() const noexcept { return surface_; }
    [[nodiscard]] const Vec3& h() const noexcept { return h_; }
    [[nodiscard]] double mu() const noexcept { return mu_; }
    /// What looking has cost so far.
    [[nodiscard]] Work work() const noexcept { return work_; }

    /// The god-object at `place`: point, derivatives, normal, and how HIP pulls it against its
    /// cone. Work adds up.
    void look(const SurfacePlace& place, SurfaceSpot& s) noexcept;
    [[nodiscard]] SurfaceSpot look(const SurfacePlace& place) noexcept {
        SurfaceSpot s;
        look(place, s);
        return s;
    }
    /// Point and derivatives alone; u and v may lie outside of the patch. @param besides work that
    /// it is for
    [[nodiscard]] SurfaceJet jet(const SurfacePlace& place, Work besides) noexcept {
        work_ += surface_.patch(place).work() + besides;
        return surface_.local_jet(place);
    }

    /// Within its cone; where that is narrower than rounding (no load, no friction) at a foot.
    [[nodiscard]] static bool settled(const SurfaceSpot& s) noexcept {
        return s.excess <= 0.0 || (s.cone <= s.rounding && s.length <= 2.0 * s.rounding);
    }
    /// What the last bits of the normal do to the excess, m: derivatives are differences of
    /// coordinates.
    [[nodiscard]] double turn(const SurfaceSpot& s) const noexcept;
    /// Parameters of the way `t` in the tangent plane: the 2 x 2 metric.
    [[nodiscard]] static Vec2 parameters(const SurfaceJet& jet, const Vec3& t) noexcept;

    /// Where the GO goes on from at.spot. Inside a patch it follows its drive. On an edge all
    /// patches that meet there are asked, and the drive is the projection of the stretch on what
    /// each of them has to offer: the patch, or its edge. The steepest one wins. Where all bar the
    /// way, HIP is either behind a concave crease, whose sides carry together, or in front of a
    /// convex edge, which lets go.
    void footing(Footing& at) noexcept;

    /// What the patch of at.spot alone has to offer: the projection of the stretch on it.
    void on_patch(Footing& at) const noexcept;
    /// Held at the end of a way along an edge, by the patch there that carries most: which of two
    /// sides that way was measured on is a matter of last bits.
    [[nodiscard]] Footing carrier(const SurfaceSpot& s) noexcept;

    /// In a concave crease or pit: the normal of its internal fan that lies nearest to the force,
    /// away from HIP and square to the only way that is left, if any.
    void against_hip(SurfaceSpot& s, const Vec3& way) const noexcept;
    /// Back to that of its patch.
    void own_normal(Footing& at) const noexcept;

    /// The collapsed edge (a pole) that ends the patch of `s`, moved there; false if there is none.
    [[nodiscard]] bool to_pole(SurfacePlace& p) const noexcept;

private:
    void measure(SurfaceSpot& s) const noexcept;
    [[nodiscard]] int rank(const Footing& f) const noexcept;
    /// The drive leads off the patch.
    [[nodiscard]] static bool leads_off(const SurfaceSpot& s) noexcept;
    /// Over its edge u = 0 or 1 (`in_u`), or v = 0 or 1.
    [[nodiscard]] static bool leads_over(const SurfaceSpot& s, bool in_u) noexcept;
    /// Along the edge that the place is on.
    [[nodiscard]] static Vec3 edge_of(const SurfaceSpot& s) noexcept;
    /// Two sides of an edge that both bar the way over it.
    enum class Between : std::uint8_t { smooth, crease, tip };
    [[nodiscard]] static Between between(const SurfaceSpot& a, const SurfaceSpot& b) noexcept;
    [[nodiscard]] bool look_beyond(const Footing& at,
                                   SurfaceHeading& over,
                                   SurfaceSpot& s) noexcept;
    [[nodiscard]] bool crease_beyond(const Footing& at) noexcept;
    /// The same place on the other side of a concave crease. @return false: it is none
    [[nodiscard]] bool look_over_crease(const Footing& at, SurfaceSpot& other) noexcept;
    void rest_in_crease(Footing& at) noexcept;
    void ask_beyond_crease(Footing& at) noexcept;
    void in_crease(Footing& at, const Vec3& way) const noexcept;
    void at_corner(Footing& best, const SurfaceObject::Around& all) noexcept;
    [[nodiscard]] Footing at_pole(const SurfacePlace& place) noexcept;
    template <class Ask>
    void round_pole(const SurfaceObject::Around& all, const Ask& ask) const noexcept;
    [[nodiscard]] bool better(const Footing& next, const Footing& best) const noexcept;
    [[nodiscard]] double way_off(const SurfacePlace& p, bool in_u) noexcept;

    const SurfaceObject& surface_;
    Vec3 h_;
    double mu_;
    Work work_ = 0;
};

}  // namespace palpate::engine
