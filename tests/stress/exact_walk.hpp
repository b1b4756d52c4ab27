#pragma once

#include "engine/friction/god_object.hpp"
#include "tests/stress/exact_forms.hpp"

/// Where a god-object has to stop, found again by other means: in long double, by halving Bernstein
/// forms made afresh from the control points seen from HIP. Shares no code with the walk.
namespace palpate::stress {

/// A place where a walk may end.
struct ExactStop {
    engine::Vec2 point{};
    double nu = 0.0;      ///< load there, m
    double blur = 0.0;    ///< m, what is not known of the point: beside a centre of curvature
    double doubt = 0.0;   ///< m, what rounding in doubles makes of the tangent there, of nu
    bool corner = false;  ///< a concave vertex: two normals carry
};

/// What the law allows. More than one stop where rounding decides.
struct ExactAnswer {
    std::vector<ExactStop> stops;
    bool open = false;  ///< HIP is on the outline but for rounding: nothing is asked
    double band = 0.0;  ///< m: stretches nearer to the edge of the cone than this are on it
};

/// Whoever walks on it.
struct ExactOutline {
    explicit ExactOutline(const engine::Outline& outline);

    const engine::Outline* outline;  ///< must live as long
    std::vector<SpanRows> on;        ///< of each span, in the direction of the outline
    std::vector<SpanRows> back;
    double extent = 0.0;  ///< largest coordinate, m
};

/// From `from` in the direction of the drive to the first place where |tau| <= mu max(nu, 0), over
/// vertices by their rules. @param outline with every coordinate below 1e9 m, and so is h
[[nodiscard]] ExactAnswer exact_walk(const ExactOutline& outline,
                                     const engine::GodObject& from,
                                     const engine::Vec2& h,
                                     double mu);

/// Some curve has a foot of h, no farther than `within` and not at an end, whose normal says that h
/// is outside: so it is where two curves lie upon each other back to back. By sampling and thirds.
[[nodiscard]] bool outside_of_some(const ExactOutline& outline,
                                   const engine::Vec2& h,
                                   double within);

}  // namespace palpate::stress
