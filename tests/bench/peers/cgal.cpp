// CGAL 5.5 (Debian's libcgal-dev): closest point on a mesh by a tree of boxes.

#include <CGAL/AABB_segment_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include "tests/bench/peers/peers.hpp"
#include "tests/bench/polyline.hpp"

namespace palpate::bench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;  // its trees are of three dimensions: z = 0 on a curve

template <class Part, class Primitive>
struct Forest {
    using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;
    std::vector<Part> parts;
    Tree tree;

    explicit Forest(std::vector<Part> all)
        : parts(std::move(all)), tree(parts.begin(), parts.end()) {
        tree.accelerate_distance_queries();
    }
    Forest(const Forest&) = delete;
    Forest& operator=(const Forest&) = delete;
};

using Segment = Kernel::Segment_3;
using Segments =
    Forest<Segment, CGAL::AABB_segment_primitive<Kernel, std::vector<Segment>::const_iterator>>;
using Triangle = Kernel::Triangle_3;
using Triangles =
    Forest<Triangle, CGAL::AABB_triangle_primitive<Kernel, std::vector<Triangle>::const_iterator>>;

Point point_of(const Vec2& p) {
    return {p.x, p.y, 0.0};
}
Point point_of(const Vec3& p) {
    return {p.x, p.y, p.z};
}

template <int D, class Woods>
struct Query {
    std::shared_ptr<const Woods> woods;
    bool warm = false;
    std::shared_ptr<typename Woods::Tree::Point_and_primitive_id> hint{};

    void reset(const Vec<D>& first) {
        hint = std::make_shared<typename Woods::Tree::Point_and_primitive_id>(
            woods->tree.closest_point_and_primitive(point_of(first)));
    }
    Answer<D> answer(const Vec<D>& hip) {
        const Point at = point_of(hip);
        if (warm) {
            *hint = woods->tree.closest_point_and_primitive(at, *hint);
        } else {
            *hint = woods->tree.closest_point_and_primitive(at);
        }
        Vec<D> foot{};
        for (int k = 0; k < D; ++k) {
            foot[k] = hint->first[k];
        }
        return {foot, glm::length(foot - hip)};
    }
};

template <int D, class Woods>
void add(Methods<D>& methods, const std::string& what, const std::shared_ptr<const Woods>& woods) {
    methods.push_back(make_method<D>("CGAL AABB " + what, Kind::mesh, Query<D, Woods>{woods}));
    methods.push_back(
        make_method<D>("CGAL AABB " + what + ", hint", Kind::mesh, Query<D, Woods>{woods, true}));
}

}  // namespace

Methods<2> cgal_methods(const Object& object) {
    Methods<2> methods;
    for (const std::size_t count : {std::size_t{1000}, std::size_t{100000}}) {
        const std::vector<Vec2> points = polyline_of(object, count);
        std::vector<Segment> segments;
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            segments.emplace_back(point_of(points[i]), point_of(points[i + 1]));
        }
        add<2, Segments>(methods, count == 1000 ? "n=1e3" : "n=1e5",
                         std::make_shared<const Segments>(std::move(segments)));
    }
    return methods;
}

Methods<3> cgal_surface_methods(const Surface& surface) {
    Methods<3> methods;
    for (const std::size_t n : {std::size_t{71}, std::size_t{316}}) {
        const std::vector<Vec3> corners = grid_of(surface, n);
        std::vector<Triangle> triangles;
        for (std::size_t j = 0; j < n; ++j) {
            for (std::size_t i = 0; i < n; ++i) {
                const std::size_t at = j * (n + 1) + i;
                const Point a = point_of(corners[at]);
                const Point b = point_of(corners[at + 1]);
                const Point c = point_of(corners[at + n + 1]);
                const Point d = point_of(corners[at + n + 2]);
                triangles.emplace_back(a, b, d);
                triangles.emplace_back(a, d, c);
            }
        }
        add<3, Triangles>(methods, n == 71 ? "1e4 triangles" : "2e5 triangles",
                          std::make_shared<const Triangles>(std::move(triangles)));
    }
    return methods;
}

}  // namespace palpate::bench
