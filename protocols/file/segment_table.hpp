#pragma once

#include <vector>

#include "stimuli/free_outline.hpp"
#include "protocols/file/table_view.hpp"

/// Private to protocols/format: a [[segment]] of a scene, or an [[object.segment]] of a protocol. Both say
/// the same with the same keys.
namespace palpate::protocols {

/// What the table says, in m, plane or in space. `points` of a line or an arc: its two ends.
struct SegmentTable {
    stimuli::Segment::Kind kind = stimuli::Segment::Kind::line;
    int degree = 1;
    std::vector<double> knots{};
    PointList points{};
    std::vector<double> weights{};
    double curvature = 0.0;
};

/// Whatever is wrong becomes a problem; `table` is broken() then.
[[nodiscard]] SegmentTable read_segment_table(TableView& table);

/// @throws std::invalid_argument if it is not plane
[[nodiscard]] stimuli::Segment plane_segment(const SegmentTable& table);

}  // namespace palpate::protocols
