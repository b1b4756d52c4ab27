#include "protocols/file/object_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "protocols/file/keys.hpp"
#include "protocols/file/segment_table.hpp"
#include "protocols/file/toml_text.hpp"

namespace palpate::protocols {
namespace {

/// Keys of [[object]] that keys_of<ObjectSpec>() does not have.
constexpr std::array<std::string_view, 6> kMore{"segment",    "set",      "prefix",
                                                "from_per_m", "to_per_m", "count"};
constexpr std::array<std::string_view, 4> kOfSets{"prefix", "from_per_m", "to_per_m", "count"};
constexpr std::array<std::string_view, 3> kSets{"five_shapes", "curvature_ladder", "catch_pair"};

const Entry* find(const Table& table, std::string_view key) {
    const auto found = std::find_if(table.begin(), table.end(),
                                    [key](const Entry& entry) { return entry.key == key; });
    return found == table.end() ? nullptr : &*found;
}

/// "convex_7_5" for 7.5 1/m; to a thousandth.
std::string name_of(double curvature) {
    std::string number = fmt::format("{:.3f}", std::fabs(curvature));
    number.erase(number.find_last_not_of('0') + 1);
    if (number.back() == '.') {
        number.pop_back();
    }
    std::replace(number.begin(), number.end(), '.', '_');
    return number == "0" ? "straight"
                         : fmt::format("{}_{}", curvature > 0.0 ? "convex" : "concave", number);
}

/// The curvatures that a set stands for.
std::vector<double> curvatures_of(TableView& view, std::size_t set) {
    constexpr Range kCurvature{.lowest = -1000.0, .highest = 1000.0};
    if (set == 0) {
        return {-10.0, -5.0, 0.0, 5.0, 10.0};
    }
    if (set == 2) {
        return {-20.0, 20.0};
    }
    const double from = view.required_number("from_per_m", kCurvature);
    const double to = view.required_number("to_per_m", kCurvature);
    const auto count = view.required_integer(
        "count", {.lowest = 2.0, .highest = static_cast<double>(kMaxObjects)});
    if (!view.broken() && !(from < to)) {
        view.refuse("to_per_m",
                    fmt::format("to_per_m is {}, and from_per_m is {}: give more", to, from));
    }
    std::vector<double> curvatures;
    for (std::int64_t i = 0; !view.broken() && i < count; ++i) {
        const double share = static_cast<double>(i) / static_cast<double>(count - 1);
        curvatures.push_back(i + 1 == count ? to : from + share * (to - from));
    }
    return curvatures;
}

/// The objects of a set. `common` holds their size and pose; pictured as the set is unless it says so.
void read_set(const Table& table,
              const std::string& path,
              const Position& at,
              Problems& problems,
              Places& places,
              const ObjectSpec& common,
              std::vector<ObjectSpec>& objects) {
    TableView view(table, fmt::format("the set of [[object]] {}", objects.size() + 1), at,
                   problems);
    const std::size_t set = view.choice("set", kSets, std::nullopt);
    const std::string prefix =
        find(table, "prefix") == nullptr ? std::string() : view.required_text("prefix");
    const bool named = std::all_of(prefix.begin(), prefix.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
    constexpr std::size_t kLongest = 32;
    if (!named || prefix.size() > kLongest) {
        view.refuse("prefix", fmt::format("prefix is {}: give up to 32 letters a-z, digits and _",
                                          shown(prefix)));
    }
    for (const std::string_view key : {"name", "curvature_per_m", "segment"}) {
        if (find(table, key) != nullptr) {
            view.refuse(key, fmt::format("{} is given beside set, which says it itself: delete one "
                                         "of them",
                                         key));
        }
    }
    if (set != 1) {
        for (const std::string_view key : {"from_per_m", "to_per_m", "count"}) {
            if (find(table, key) != nullptr) {
                view.refuse(key, fmt::format("{} is given, but set is not \"curvature_ladder\": "
                                             "delete it",
                                             key));
            }
        }
    }
    if (view.broken()) {
        return;
    }
    for (const double curvature : curvatures_of(view, set)) {
        ObjectSpec& object = objects.emplace_back(common);
        object.name = prefix + name_of(curvature);
        object.curvature = curvature;
        object.pictured = places.has(path + ".pictured") ? common.pictured : set != 2;
        places.note(fmt::format("object.{}", objects.size()), at);
    }
}

void read_segments(const Entry& entry,
                   const std::string& path,
                   std::size_t number,
                   Problems& problems,
                   Places& places,
                   ObjectSpec& object) {
    const auto* array = std::get_if<Array>(&entry.value.data);
    if (array == nullptr || array->empty() || array->size() > kMaxSegments) {
        problems.add(entry.at, fmt::format("segment of [[object]] {} is {}: write 1 to {} tables "
                                           "[[object.segment]]",
                                           number, shown(entry.value), kMaxSegments));
        return;
    }
    for (std::size_t i = 0; i < array->size(); ++i) {
        const Value& value = (*array)[i];
        const auto* table = std::get_if<Table>(&value.data);
        if (table == nullptr) {
            problems.add(value.at, fmt::format("segment {} of [[object]] {} is {}: write it as a "
                                               "table [[object.segment]]",
                                               i + 1, number, shown(value)));
            continue;
        }
        places.note(fmt::format("{}.segment.{}", path, i + 1), value.at);
        TableView view(*table, fmt::format("[[object.segment]] {} of [[object]] {}", i + 1, number),
                       value.at, problems);
        const SegmentTable read = read_segment_table(view);
        stimuli::Segment& segment = object.segments.emplace_back();
        view.attempt([&] {
            segment = plane_segment(read);
            static_cast<void>(curve_of(segment));
        });
    }
}

std::string points_text(const std::vector<engine::Vec2>& points) {
    std::string text;
    for (const engine::Vec2& point : points) {
        text += fmt::format("{}[{}, {}]", text.empty() ? "" : ", ", toml_text(point.x, 1.0),
                            toml_text(point.y, 1.0));
    }
    return text;
}

std::string numbers_text(const std::vector<double>& numbers) {
    std::string text;
    for (const double number : numbers) {
        text += fmt::format("{}{}", text.empty() ? "" : ", ", toml_text(number, 1.0));
    }
    return text;
}

}  // namespace

void read_object(const Table& table,
                 const Position& at,
                 Problems& problems,
                 Places& places,
                 std::vector<ObjectSpec>& objects) {
    const std::size_t number = objects.size() + 1;
    const std::string path = fmt::format("object.{}", number);
    const Entry* set = find(table, "set");
    const Entry* segments = find(table, "segment");
    ObjectSpec object;
    Reader(problems, places)
        .read(table, path, at, object, {.known_elsewhere = kMore, .complete = set == nullptr});
    if (set != nullptr) {
        read_set(table, path, at, problems, places, object, objects);
        return;
    }
    for (const std::string_view key : kOfSets) {
        if (const Entry* entry = find(table, key)) {
            problems.add(entry->at,
                         fmt::format("{} of [[object]] {} is for a set: give set, or delete it",
                                     key, number));
        }
    }
    const bool curved = find(table, "curvature_per_m") != nullptr;
    if (segments != nullptr) {
        if (curved) {
            problems.add(places.of(path + ".curvature_per_m"),
                         fmt::format("[[object]] {} has curvature_per_m and [[object.segment]] "
                                     "tables: delete one of them",
                                     number));
        }
        read_segments(*segments, path, number, problems, places, object);
    } else if (!curved) {
        problems.add(at, fmt::format("[[object]] {} lacks the key curvature_per_m: add it (two "
                                     "curves), or [[object.segment]] tables (a free form), or set "
                                     "(several objects)",
                                     number));
    }
    objects.push_back(std::move(object));
}

std::string segments_toml(const ObjectSpec& object) {
    using Kind = stimuli::Segment::Kind;
    std::string text;
    for (const stimuli::Segment& segment : object.segments) {
        text += "[[object.segment]]\n";
        if (segment.kind == Kind::nurbs) {
            text += fmt::format("kind = \"nurbs\"\ndegree = {}\nknots = [{}]\npoints_m = [{}]\n",
                                segment.degree, numbers_text(segment.knots),
                                points_text(segment.points));
            if (!segment.weights.empty()) {
                text += fmt::format("weights = [{}]\n", numbers_text(segment.weights));
            }
            continue;
        }
        const bool arc = segment.kind == Kind::arc;
        text +=
            fmt::format("kind = \"{}\"\nfrom_m = {}\nto_m = {}\n", arc ? "arc" : "line",
                        points_text({segment.points.at(0)}), points_text({segment.points.at(1)}));
        if (arc) {
            text += fmt::format("curvature_per_m = {}\n", toml_text(segment.curvature, 1.0));
        }
    }
    return text;
}

std::string object_reference() {
    const auto row = [](std::string_view name, std::string_view range, std::string_view need,
                        std::string_view meaning) {
        return fmt::format("    {:<22} {:<28} {:<11} {}\n", name, range, need, meaning);
    };
    return "  instead of name and curvature_per_m, several objects at once:\n" +
           row("set", "\"five_shapes\"", "",
               "-10, -5, 0, 5 and 10 1/m: the objects of shape_friction") +
           row("", "or \"catch_pair\"", "", "-20 and 20 1/m, not pictured") +
           row("", "or \"curvature_ladder\"", "",
               "count of them, evenly from from_per_m to to_per_m") +
           row("from_per_m, to_per_m", "-1000 to 1000", "of a ladder", "its ends") +
           row("count", fmt::format("2 to {}", kMaxObjects), "of a ladder", "objects on it") +
           row("prefix", "letters a-z, digits and _", "\"\"",
               "before the names concave_5, straight, convex_7_5, ...") +
           fmt::format(
               "\n[[object.segment]]  instead of curvature_per_m, 1 to {}: a closed outline, "
               "clockwise, the object on\n  the right of travel; the same keys as in a "
               "scene\n",
               kMaxSegments) +
           row("kind", "\"nurbs\", \"line\" or \"arc\"", "required",
               "each begins where the one before ends") +
           row("degree", "1 to 9", "of a nurbs", "of its polynomials") +
           row("knots", "rising numbers", "of a nurbs", "clamped; of any spacing") +
           row("points_m", "[[x, y], ...]", "of a nurbs", "control points") +
           row("weights", "above 0", "all 1", "of the control points") +
           row("from_m, to_m", "[x, y]", "of others", "the ends of a line or an arc") +
           row("curvature_per_m", "a number", "of an arc", "above 0 convex, below 0 concave");
}

}  // namespace palpate::protocols
