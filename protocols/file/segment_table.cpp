#include "protocols/file/segment_table.hpp"

#include <array>
#include <stdexcept>
#include <string_view>

namespace palpate::protocols {
namespace {

using Kind = stimuli::Segment::Kind;

constexpr std::array<std::string_view, 3> kKinds{"nurbs", "line", "arc"};

}  // namespace

SegmentTable read_segment_table(TableView& table) {
    SegmentTable read;
    read.kind = static_cast<Kind>(table.choice("kind", kKinds, std::nullopt));
    if (table.broken()) {
        return read;  // what else it needs depends on its kind
    }
    if (read.kind == Kind::nurbs) {
        read.degree = static_cast<int>(table.required_integer("degree", {.lowest = 1.0}));
        read.knots = table.numbers("knots");
        read.points = table.points("points_m");
        read.weights = table.numbers_or_none("weights");
        table.refuse_unknown();
        return read;
    }
    read.points = table.point("from_m");
    const PointList to = table.point("to_m");
    if (read.kind == Kind::arc) {
        read.curvature = table.required_number("curvature_per_m", {});
    }
    table.refuse_unknown();
    table.attempt([&] {
        if (to.dimension != read.points.dimension ||
            (read.kind == Kind::arc && to.dimension != 2)) {
            throw std::invalid_argument(
                "from_m and to_m need two coordinates each (three only for lines in space)");
        }
    });
    read.points.values.insert(read.points.values.end(), to.values.begin(), to.values.end());
    return read;
}

stimuli::Segment plane_segment(const SegmentTable& table) {
    if (table.points.dimension != 2) {
        throw std::invalid_argument("its points have three coordinates: give two each");
    }
    return {.kind = table.kind,
            .degree = table.degree,
            .knots = table.knots,
            .points = table.points.plane(),
            .weights = table.weights,
            .curvature = table.curvature};
}

}  // namespace palpate::protocols
