#pragma once

#include "engine/surface/surface_object.hpp"
#include "tests/support/surface_oracle.hpp"

/// The end of a slide on a surface by its law, for a hand that is held:
///
///     dg/ds = t / |t|   to the first g with |t| <= mu max(nu, 0);   r = h - g = t - nu n
///
/// in long double, from the surface's definition: the Runge-Kutta pair of Dormand & Prince of
/// orders 5 and 4 in the surface's own parameters, each step halved until no stage of it lies
/// within the cone or beyond an edge, or its end is the place where that begins (a root of the
/// length of the step). It shares no code with the engine but for which patch lies beyond an
/// edge.
namespace palpate::stress {

struct FlowEnd {
    enum class Kind {
        cone,  ///< the first place within the cone
        foot,  ///< |t| falls to nothing without one
        edge,  ///< held: an open border, a crease that both sides lead into
        lost,  ///< a corner, a pole, no direction, too many steps
    };
    Kind kind = Kind::lost;
    tests::Long3 point{};     ///< m, world
    long double load = 0.0L;  ///< nu there, m
    long double way = 0.0L;   ///< m
};

class ExactFlow {
public:
    /// @param oracles  one for each surface of the object
    ExactFlow(const engine::SurfaceObject& object,
              const std::vector<tests::SurfaceOracle>& oracles) noexcept
        : object_(&object), oracles_(&oracles) {}

    /// @param h  m, world
    [[nodiscard]] FlowEnd end(const engine::SurfacePlace& from,
                              const engine::Vec3& h,
                              long double mu) const;

private:
    struct Piece {
        std::size_t surface = 0;
        std::size_t i = 0;
        std::size_t j = 0;
        std::size_t pu = 0;
        std::size_t pv = 0;
        std::array<long double, 2> lo{};
        std::array<long double, 2> hi{};
    };
    using Two = std::array<long double, 2>;
    struct Place {
        Two at{};
        Two way{};  ///< d(u, v)/ds
        tests::Long3 point{};
        long double along = 0.0L;  ///< |t|
        long double load = 0.0L;
        long double reach = 0.0L;  ///< |r|
        long double excess = 0.0L;
        std::array<long double, 3> metric{};
        bool regular = false;
    };
    struct Step {
        Place to{};
        long double error = 0.0L;  ///< m
        bool clean = false;        ///< no stage within the cone or off the piece
        bool regular = false;
    };
    [[nodiscard]] Piece piece_of(const engine::SurfacePlace& p) const;
    [[nodiscard]] Place look(const Piece& piece, const Two& at) const;
    [[nodiscard]] Step step(const Piece& piece, const Place& from, long double s) const;
    /// < 0 within the cone or beyond an edge.
    [[nodiscard]] long double room(const Piece& piece, const Place& p) const;
    [[nodiscard]] bool cross(Piece& piece, Place& p) const;

    const engine::SurfaceObject* object_;
    const std::vector<tests::SurfaceOracle>* oracles_;
    mutable tests::Long3 h_{};
    mutable long double mu_ = 0.0L;
};

}  // namespace palpate::stress
