#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "stimuli/free_outline.hpp"
#include "protocols/file/schema.hpp"
#include "protocols/protocol/protocol.hpp"

/// Private to protocols/file: [[object]] tables, which say more than one key after the other can:
/// free forms by [[object.segment]] tables, and named sets that stand for several objects. A
/// [[segment]] of a scene says the same with the same keys.
namespace palpate::protocols {

inline constexpr std::size_t kMaxSegments = 64;  ///< of one object

/// Reads one [[object]]: appends one object, or those of a set. Each is noted in the file's places
/// as object.N with N its number among all objects.
void read_object(const TableReader& given, std::vector<ObjectSpec>& objects);

/// The [[object.segment]] tables of a free form as they are read; empty for two curves.
[[nodiscard]] std::string segments_toml(const ObjectSpec& object);

/// What a segment says, in m, plane or in space.
struct SegmentTable {
    stimuli::Segment::Kind kind = stimuli::Segment::Kind::line;
    int degree = 1;
    std::vector<double> knots{};
    PointList points{};  ///< of a nurbs
    std::vector<double> weights{};
    PointList from{}, to{};  ///< one point each, of a line or an arc
    double curvature = 0.0;
};

template <>
inline constexpr std::array<std::string_view, 3> kWordsOf<stimuli::Segment::Kind>{"nurbs", "line",
                                                                                  "arc"};
/// The keys that a segment has beside its kind.
[[nodiscard]] Keys keys_of_segment(stimuli::Segment::Kind kind);

/// Whatever is wrong becomes a problem; `table` is broken() then. Keys of another kind are unknown.
/// `points` of a line or an arc become its two ends.
[[nodiscard]] SegmentTable read_segment_table(TableReader& table);

/// @throws std::invalid_argument if it is not plane
[[nodiscard]] stimuli::Segment plane_segment(const SegmentTable& table);

/// What people can say about free forms and sets.
[[nodiscard]] std::vector<TableText> object_reference();
[[nodiscard]] TableText segment_reference(std::string heading, std::string remark);

}  // namespace palpate::protocols
