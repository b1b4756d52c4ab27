#pragma once

#include "engine/geometry/outline.hpp"
#include "tests/support/nurbs_oracle.hpp"

namespace palpate::bench {

/// Curves joined end to end, the object on the right of travel; about 0.1 m large.
struct Object {
    std::string name;
    std::string what;
    std::vector<tests::NurbsData<2>> curves;
};

/// The five of the work-precision table:
///   A  two convex cubics joined at a convex vertex
///   B  two concave cubics, a spike of 13 degrees at the vertex
///   C  one rational cubic, 10 control points, weights 0.5 to 3
///   D  a cubic whose tip has a radius of 0.63 mm and max|C'| / min|C'| = 21
///   E  two circular arcs joined at a vertex, as the studies have them
[[nodiscard]] std::vector<Object> contact_objects();

/// N like curves, 10 mm each, bulging out of a regular N-gon: closed, clockwise. N >= 2.
[[nodiscard]] Object ring_of(std::size_t curves);

/// All spans of an object, in order.
[[nodiscard]] std::vector<engine::RationalBezier<2>> spans_of(const Object& object);

/// Open, since the objects are parts of one.
[[nodiscard]] engine::Outline outline_of(const Object& object, bool closed = false);

}  // namespace palpate::bench
