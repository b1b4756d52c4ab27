#pragma once

#include "tests/bench/surfaces.hpp"

/// Other people's libraries behind our interface. Only in builds with -DPALPATE_BENCH_PEERS=ON.
namespace palpate::bench {

[[nodiscard]] bool have_peers() noexcept;
[[nodiscard]] Methods<2> peer_methods(const Object& object);
[[nodiscard]] Methods<3> peer_surface_methods(const Surface& surface);

/// SINTEF Spline Library 4.6: s1957 (one closest), s1953 (all), s1774 (local, warm); s1958, s1954,
/// s1775.
[[nodiscard]] Methods<2> sisl_methods(const Object& object);
[[nodiscard]] Methods<3> sisl_surface_methods(const Surface& surface);

/// Open CASCADE 7.6: Geom2dAPI_ProjectPointOnCurve, Extrema_ExtPC2d, Extrema_LocateExtPC2d;
/// GeomAPI_ProjectPointOnSurf, Extrema_GenLocateExtPS.
[[nodiscard]] Methods<2> occt_methods(const Object& object);
[[nodiscard]] Methods<3> occt_surface_methods(const Surface& surface);

/// CGAL 5.5: AABB tree of segments or triangles, with and without a warm hint.
[[nodiscard]] Methods<2> cgal_methods(const Object& object);
[[nodiscard]] Methods<3> cgal_surface_methods(const Surface& surface);

}  // namespace palpate::bench
