#include "protocols/file/deformation_file.hpp"

#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "protocols/file/document.hpp"

namespace palpate::protocols {
namespace {

/// What a case says, as it stands.
struct CaseTable {
    engine::DnurbsSpec curve{};
    PointList points{};
    std::vector<double> fixed{};
    engine::Vec2 force{};
    double at_u = 0.0;
    double step = 0.001;
    bool at_rest = false;
    bool free_weights = false;
};

template <auto Member>
constexpr auto of_curve = at<&CaseTable::curve, Member>;

using engine::DnurbsSpec;
using enum Need;

// clang-format off
constexpr Key kCase[]{
    {.name = "degree", .slot = of_curve<&DnurbsSpec::degree>, .need = required, .range = {1, 1e6},
     .meaning = "of the polynomials"},
    {.name = "knots", .slot = of_curve<&DnurbsSpec::knots>, .need = required,
     .meaning = "clamped, rising, of any spacing"},
    {.name = "points_m", .slot = at<&CaseTable::points>, .need = required, .range = kPlace,
     .meaning = "control points at rest, in the plane"},
    {.name = "weights", .slot = of_curve<&DnurbsSpec::weights>,
     .meaning = "of the control points, above 0; left out: all 1"},
    {.name = "mu", .slot = of_curve<&DnurbsSpec::mu>, .range = kFromZero,
     .meaning = "mass per unit of u, kg; a motion needs some"},
    {.name = "gamma", .slot = of_curve<&DnurbsSpec::gamma>, .range = kFromZero,
     .meaning = "damping per unit of u, N s/m"},
    {.name = "alpha", .slot = of_curve<&DnurbsSpec::alpha>, .range = kFromZero,
     .meaning = "tension: times the square of the first derivative by u"},
    {.name = "beta", .slot = of_curve<&DnurbsSpec::beta>, .range = kFromZero,
     .meaning = "rigidity: times the square of the second"},
    {.name = "fixed", .slot = at<&CaseTable::fixed>, .range = kFromZero,
     .meaning = "control points that do not move, counted from 0"},
    {.name = "force_n", .slot = at<&CaseTable::force>, .need = required, .range = {-1e6, 1e6},
     .meaning = "on the curve, from time 0 on"},
    {.name = "at_u", .slot = at<&CaseTable::at_u>, .need = required,
     .meaning = "where the force acts, in the domain of the knots"},
    {.name = "dt_s", .slot = at<&CaseTable::step>, .range = kPositive,
     .meaning = "step of the trapezoid rule"},
    {.name = "static", .slot = at<&CaseTable::at_rest>,
     .meaning = "true: only where the curve comes to rest"},
    {.name = "free_weights", .slot = at<&CaseTable::free_weights>,
     .meaning = "true is refused, with the reason"},
};
// clang-format on

/// What no key says alone; `fixed` becomes the curve's.
void check(TableReader& top, CaseTable& read) {
    if (read.free_weights) {
        top.refuse("free_weights",
                   "free_weights is true: weights cannot be coordinates of the motion, because all "
                   "of them times one factor are the same curve, so that this motion has no mass; "
                   "delete it, weights stay as given");
    }
    if (!read.at_rest && !top.has("mu")) {
        top.refuse("mu",
                   "the case lacks the key mu: a motion needs mass; add it, or static = true");
    }
    if (read.points.dimension != 2) {
        top.refuse("points_m", "points_m has three coordinates: give two each");
    }
    for (const double index : read.fixed) {
        if (index < 0.0) {
            continue;  // its range has refused it
        }
        if (index != std::floor(index) || index > 1e6) {
            top.refuse("fixed",
                       fmt::format("fixed has {}: give whole numbers, the first control point is 0",
                                   index));
        } else {
            read.curve.fixed.push_back(static_cast<std::size_t>(index));
        }
    }
}

}  // namespace

DeformationCase parse_deformation(std::string_view text, std::string_view file_name) {
    const Table file = parse_document(text, file_name);
    Problems problems;
    Places places;
    TableReader top(file, "", {}, problems, places, "the case");
    CaseTable read;
    top.read_last(kCase, &read);
    check(top, read);
    std::optional<DeformationCase> found;
    top.attempt([&] {
        read.curve.points = read.points.plane();
        engine::Dnurbs curve(std::move(read.curve));
        refuse_if(!(read.at_u >= curve.front() && read.at_u <= curve.back()),
                  "at_u is {}: the knots go from {} to {}", read.at_u, curve.front(), curve.back());
        if (read.at_rest) {
            static_cast<void>(curve.equilibrium(read.at_u, read.force));
        } else {
            static_cast<void>(engine::DnurbsMotion(curve, read.step));
        }
        found = DeformationCase{std::move(curve), read.force, read.at_u, read.step, read.at_rest};
    });
    problems.throw_if_any(file_name);
    return std::move(found).value();
}

std::vector<TableText> deformation_reference() {
    return {{.heading = "the case", .keys = kCase}};
}

}  // namespace palpate::protocols
