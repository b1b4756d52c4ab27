#include "protocols/file/object_tables.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/geometry/outline.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/procedure/grid.hpp"

namespace palpate::protocols {
namespace {

using SegmentKind = stimuli::Segment::Kind;

/// What a set of objects says.
struct SetTable {
    enum class Set : std::uint8_t { five_shapes, curvature_ladder, catch_pair };

    Set set = Set::five_shapes;
    std::string prefix{};
    double from = 0.0;
    double to = 0.0;
    std::size_t count = 2;
};

constexpr std::array<std::string_view, 3> kSets{"five_shapes", "curvature_ladder", "catch_pair"};

WordList words_of(SetTable::Set) {
    return kSets;
}

constexpr Range kCurvature{.min = -1000.0, .max = 1000.0};

using enum Need;

// clang-format off
constexpr Key kSet[]{
    {.name = "set", .slot = at<&SetTable::set>, .need = required,
     .meaning = "five_shapes: -10, -5, 0, 5 and 10 1/m, the objects of shape_friction; catch_pair: -20 and 20 1/m, not pictured; curvature_ladder: count of them, evenly"},
    {.name = "prefix", .slot = at<&SetTable::prefix>, .form = Form::any,
     .meaning = "before the names concave_5, straight, convex_7_5, ...; up to 32 letters a-z, digits and _"},
};
constexpr Key kLadder[]{
    {.name = "from_per_m", .slot = at<&SetTable::from>, .need = required, .range = kCurvature,
     .meaning = "the first curvature of a ladder"},
    {.name = "to_per_m", .slot = at<&SetTable::to>, .need = required, .range = kCurvature,
     .meaning = "the last"},
    {.name = "count", .slot = at<&SetTable::count>, .need = required, .range = {2, kMaxObjects},
     .meaning = "objects on a ladder"},
};

constexpr Key kSegment[]{
    {.name = "kind", .slot = at<&SegmentTable::kind>, .need = required,
     .meaning = "each begins where the one before ends"},
    {.name = "degree", .slot = at<&SegmentTable::degree>, .need = required, .range = {1, 1e6},
     .meaning = "of a nurbs: of its polynomials"},
    {.name = "knots", .slot = at<&SegmentTable::knots>, .need = required,
     .meaning = "of a nurbs: clamped, rising, of any spacing"},
    {.name = "points_m", .slot = at<&SegmentTable::points>, .need = required, .range = kPlace,
     .meaning = "of a nurbs: control points; in space [x, y, z]"},
    {.name = "weights", .slot = at<&SegmentTable::weights>,
     .meaning = "of a nurbs: of the control points, above 0; left out: all 1"},
    {.name = "from_m", .slot = at<&SegmentTable::from>, .need = required, .range = kPlace, .form = Form::point,
     .meaning = "of a line or an arc: its first end"},
    {.name = "to_m", .slot = at<&SegmentTable::to>, .need = required, .range = kPlace, .form = Form::point,
     .meaning = "of a line or an arc: its last end"},
    {.name = "curvature_per_m", .slot = at<&SegmentTable::curvature>, .need = required,
     .meaning = "of an arc: above 0 convex, below 0 concave"},
};
// clang-format on

/// "convex_7_5" for 7.5 1/m; to a thousandth.
std::string name_of(double curvature) {
    std::string number = fmt::format("{:.3f}", std::fabs(curvature));
    number.erase(number.find_last_not_of('0') + 1);
    if (number.back() == '.') {
        number.pop_back();
    }
    std::ranges::replace(number, '.', '_');
    return number == "0" ? "straight"
                         : fmt::format("{}_{}", curvature > 0.0 ? "convex" : "concave", number);
}

/// The curvatures that a set stands for.
std::vector<double> curvatures_of(const SetTable& set) {
    switch (set.set) {
        case SetTable::Set::five_shapes:
            return {-10.0, -5.0, 0.0, 5.0, 10.0};
        case SetTable::Set::catch_pair:
            return {-20.0, 20.0};
        case SetTable::Set::curvature_ladder:
            break;
    }
    return evenly(set.from, set.to, set.count);
}

void read_ladder(TableReader& table, SetTable& set) {
    const bool ladder = set.set == SetTable::Set::curvature_ladder;
    table.read(kLadder, &set, ladder);
    for (const Key& key : kLadder) {
        if (!ladder && table.has(key.name)) {
            table.refuse(key.name, fmt::format("{} is given, but set is not \"curvature_ladder\": "
                                               "delete it",
                                               key.name));
        }
    }
    if (ladder && !table.broken() && !(set.from < set.to)) {
        table.refuse("to_per_m", fmt::format("to_per_m is {}, and from_per_m is {}: give more",
                                             set.to, set.from));
    }
}

SetTable read_set_table(TableReader& table) {
    SetTable set;
    table.read(kSet, &set);
    const bool named = std::ranges::all_of(set.prefix, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
    constexpr std::size_t kLongest = 32;
    if (!named || set.prefix.size() > kLongest) {
        table.refuse("prefix", fmt::format("prefix is {}: give up to 32 letters a-z, digits and _",
                                           shown(set.prefix)));
    }
    for (const std::string_view key : {"name", "curvature_per_m", "segment"}) {
        if (table.has(key)) {
            table.refuse(key, fmt::format("{} is given beside set, which says it itself: delete "
                                          "one of them",
                                          key));
        }
    }
    read_ladder(table, set);
    return set;
}

void read_segments(TableReader& reader, const Entry& entry, ObjectSpec& object) {
    const auto* array = std::get_if<Array>(&entry.value.data);
    if (array == nullptr || array->empty() || array->size() > kMaxSegments) {
        reader.add(entry.at, fmt::format("segment of {} is {}: write 1 to {} tables "
                                         "[[object.segment]]",
                                         reader.name(), shown(entry.value), kMaxSegments));
        return;
    }
    for (std::size_t i = 0; i < array->size(); ++i) {
        const Value& value = (*array)[i];
        const std::string called = fmt::format("{} of {}", i + 1, reader.name());
        const auto* table = std::get_if<Table>(&value.data);
        if (table == nullptr) {
            reader.add(value.at,
                       fmt::format("segment {} is {}: write it as a table [[object.segment]]",
                                   called, shown(value)));
            continue;
        }
        TableReader inner = reader.of(*table, fmt::format("{}.segment.{}", reader.path(), i + 1),
                                      value.at, "[[object.segment]] " + called);
        const SegmentTable read = read_segment_table(inner);
        stimuli::Segment& segment = object.segments.emplace_back();
        inner.attempt([&] {
            segment = plane_segment(read);
            static_cast<void>(curve_of(segment));
        });
    }
}

/// An object for every curvature of the set; what else the table says is said of each.
void read_set(TableReader& reader, const ObjectSpec& object, std::vector<ObjectSpec>& objects) {
    const SetTable set = read_set_table(reader);
    for (const double curvature : reader.broken() ? std::vector<double>{} : curvatures_of(set)) {
        ObjectSpec& one = objects.emplace_back(object);
        one.name = set.prefix + name_of(curvature);
        one.curvature = curvature;
        one.pictured =
            reader.has("pictured") ? object.pictured : set.set != SetTable::Set::catch_pair;
        reader.note(fmt::format("object.{}", objects.size()));
    }
}

/// Two curves, or segments: one of both.
void read_form(TableReader& reader, ObjectSpec& object) {
    const bool curved = reader.has("curvature_per_m");
    if (const Entry* segments = find(reader.table(), "segment")) {
        if (curved) {
            reader.refuse("curvature_per_m",
                          fmt::format("{} has curvature_per_m and [[object.segment]] tables: "
                                      "delete one of them",
                                      reader.name()));
        }
        read_segments(reader, *segments, object);
    } else if (!curved) {
        reader.add(reader.at(),
                   fmt::format("{} lacks the key curvature_per_m: add it (two curves), or "
                               "[[object.segment]] tables (a free form), or set (several objects)",
                               reader.name()));
    }
}

}  // namespace

Keys keys_of_segment(SegmentKind kind) {
    const Keys all(kSegment);
    return kind == SegmentKind::nurbs ? all.subspan(1, 4)
         : kind == SegmentKind::line  ? all.subspan(5, 2)
                                      : all.subspan(5, 3);
}

SegmentTable read_segment_table(TableReader& table) {
    SegmentTable read;
    table.read(Keys(kSegment).first(1), &read);
    if (table.broken()) {
        return read;  // what else it needs depends on its kind
    }
    table.read_last(keys_of_segment(read.kind), &read);
    if (read.kind == SegmentKind::nurbs || table.broken()) {
        return read;
    }
    table.attempt([&] {
        refuse_if(read.to.dimension != read.from.dimension ||
                      (read.kind == SegmentKind::arc && read.to.dimension != 2),
                  "from_m and to_m need two coordinates each (three only for lines in space)");
    });
    read.points = read.from;
    read.points.values.push_back(read.to.values.at(0));
    return read;
}

stimuli::Segment plane_segment(const SegmentTable& table) {
    refuse_if(table.points.dimension != 2, "its points have three coordinates: give two each");
    return {.kind = table.kind,
            .degree = table.degree,
            .knots = table.knots,
            .points = table.points.plane(),
            .weights = table.weights,
            .curvature = table.curvature};
}

void read_object(const TableReader& given, std::vector<ObjectSpec>& objects) {
    constexpr std::array<std::string_view, 6> kMore{"segment",    "set",      "prefix",
                                                    "from_per_m", "to_per_m", "count"};
    TableReader reader =
        given.of(given.table(), fmt::format("object.{}", objects.size() + 1), given.at());
    ObjectSpec object;
    reader.fill(object, !reader.has("set"));
    reader.know(kMore);
    reader.refuse_unknown();
    if (reader.has("set")) {
        read_set(reader, object, objects);
        return;
    }
    for (const std::string_view key : WordList(kMore).subspan(2)) {
        if (const Entry* entry = find(given.table(), key)) {
            reader.add(entry->at, fmt::format("{} of {} is for a set: give set, or delete it", key,
                                              reader.name()));
        }
    }
    read_form(reader, object);
    objects.push_back(std::move(object));
}

std::string segments_toml(const ObjectSpec& object) {
    const auto listed = [](const engine::Vec2& point) {
        return PointList{.values = {{point.x, point.y, 0.0}}};
    };
    std::string text;
    for (const stimuli::Segment& segment : object.segments) {
        SegmentTable table{.kind = segment.kind,
                           .degree = segment.degree,
                           .knots = segment.knots,
                           .weights = segment.weights,
                           .curvature = segment.curvature};
        for (const engine::Vec2& point : segment.points) {
            table.points.values.push_back({point.x, point.y, 0.0});
        }
        if (segment.kind != SegmentKind::nurbs) {
            table.from = listed(segment.points.at(0));
            table.to = listed(segment.points.at(1));
        }
        text += "[[object.segment]]\n" + toml_lines(Keys(kSegment).first(1), &table) +
                toml_lines(keys_of_segment(segment.kind), &table);
    }
    return text;
}

std::vector<TableText> object_reference() {
    return {{.heading = "[[object]] with set",
             .remark = "instead of name and curvature_per_m: several objects at once",
             .keys = kSet},
            {.heading = "[[object]] with set = \"curvature_ladder\"", .keys = kLadder},
            segment_reference(
                "[[object.segment]]",
                fmt::format("instead of curvature_per_m, 1 to {}: a closed outline, clockwise, the "
                            "object on the right of travel; the same keys as in a scene",
                            kMaxSegments))};
}

TableText segment_reference(std::string heading, std::string remark) {
    return {std::move(heading), std::move(remark), kSegment};
}

}  // namespace palpate::protocols
