#include <algorithm>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "protocols/file/schema.hpp"
#include "protocols/procedure/grid.hpp"

namespace palpate::protocols {
namespace {

constexpr double kMaxValues = 100'000.0;  ///< of an axis

bool on_one_line(char c) {
    return static_cast<unsigned char>(c) >= 0x20 && c != 0x7f;
}

bool is_name(std::string_view text) {
    constexpr std::size_t kLongest = 64;
    return !text.empty() && text.size() <= kLongest && std::ranges::all_of(text, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
}

bool is_free_text(std::string_view text) {
    constexpr std::size_t kLongest = 200;
    return !text.empty() && text.size() <= kLongest && std::ranges::all_of(text, on_one_line);
}

/// Lines end with \n alone; each is free text, or empty to leave room.
bool is_instruction(std::string_view text) {
    return text.size() <= kMaxInstruction &&
           std::ranges::count(text, '\n') < static_cast<std::ptrdiff_t>(kMaxInstructionLines) &&
           std::ranges::any_of(text, [](char c) { return c != ' ' && c != '\n'; }) &&
           std::ranges::all_of(text, [](char c) { return c == '\n' || on_one_line(c); });
}

/// Integers are numbers, too.
std::optional<double> as_number(const Value& value) {
    if (const auto* integer = std::get_if<std::int64_t>(&value.data)) {
        return static_cast<double>(*integer);
    }
    if (const auto* number = std::get_if<double>(&value.data)) {
        return *number;
    }
    return std::nullopt;
}

/// An axis as { from, to, count } or { from, to, step }.
struct Spread {
    double from = 0.0;
    double to = 0.0;
    double step = 0.0;
    std::size_t count = 0;
};

// clang-format off
constexpr Key kSpreadByStep[]{
    {.name = "from", .slot = at<&Spread::from>, .need = Need::required, .meaning = "the first value"},
    {.name = "to", .slot = at<&Spread::to>, .need = Need::required, .meaning = "the last value"},
    {.name = "step", .slot = at<&Spread::step>, .need = Need::required, .range = kPositive, .meaning = "between two values"},
};
constexpr Key kSpreadByCount[]{
    kSpreadByStep[0],
    kSpreadByStep[1],
    {.name = "count", .slot = at<&Spread::count>, .need = Need::required, .range = {1.0, kMaxValues}, .meaning = "of values"},
};
// clang-format on

/// One value into one slot; what is wrong is said to the table.
class Cell {
public:
    Cell(const Key& key, const Value& value, TableReader& table)
        : key_(key), value_(value), table_(table) {}

    /// A number, or one that may be left out.
    template <class Number>
    void operator()(Number* out) const {
        if (const auto number = this->number()) {
            *out = to_si(*number);
        }
    }

    void operator()(const Whole& out) const {
        const auto* integer = std::get_if<std::int64_t>(&value_.data);
        if (integer == nullptr) {
            wrong_kind(fmt::format("an integer ({})", range_of(key_)));
        } else if (!key_.range.has(static_cast<double>(*integer))) {
            out_of_range(value_);
        } else {
            out.set(out.at, *integer);
        }
    }

    void operator()(const OneOf& out) const {
        const auto* text = std::get_if<std::string>(&value_.data);
        if (text == nullptr) {
            wrong_kind(range_of(key_));
            return;
        }
        const auto found = std::ranges::find(out.words, *text);
        if (found == out.words.end()) {
            say(fmt::format("{} is {}, give {}{}", key_.name, shown(*text), range_of(key_),
                            suggestion(*text, out.words, "")));
        } else {
            out.number.set(out.number.at, found - out.words.begin());
        }
    }

    void operator()(bool* out) const {
        if (const auto* flag = std::get_if<bool>(&value_.data)) {
            *out = *flag;
        } else {
            wrong_kind("true or false");
        }
    }

    void operator()(std::string* out) const {
        const auto* text = std::get_if<std::string>(&value_.data);
        if (text == nullptr) {
            wrong_kind("text in quotes");
        } else if (key_.form == Form::name && !is_name(*text)) {
            say(fmt::format("{} is {}: give 1 to 64 letters a-z, digits and _", key_.name,
                            shown(*text)));
        } else if (key_.form == Form::free && !is_free_text(*text)) {
            say(fmt::format("{} is {}: give 1 to 200 bytes of text on one line", key_.name,
                            shown(*text)));
        } else if (key_.form == Form::lines && !is_instruction(*text)) {
            say(fmt::format(
                "{} is {}, {} bytes: give 1 to {} bytes of text in at most {} lines, without tabs",
                key_.name, shown(*text), text->size(), kMaxInstruction, kMaxInstructionLines));
        } else {
            *out = *text;
        }
    }

    void operator()(engine::Vec2* out) const { *out = point().value_or(*out); }
    void operator()(std::optional<engine::Vec2>* out) const {
        if (const auto point = this->point()) {
            *out = point;
        }
    }

    void operator()(std::vector<double>* out) const {
        const bool one = as_number(value_).has_value();
        if (one && (key_.form == Form::axis || key_.form == Form::one_or_more)) {
            if (const auto number = this->number()) {
                *out = {*number};
            }
        } else if (const auto* table = std::get_if<Table>(&value_.data);
                   table != nullptr && key_.form == Form::axis) {
            *out = spread(*table);
        } else if (std::holds_alternative<Array>(value_.data)) {
            *out = list(value_);
            const auto wrong = std::find_if(out->begin(), out->end(),
                                            [this](double x) { return !key_.range.has(x); });
            if (wrong != out->end()) {
                say(fmt::format("{} holds {}: give numbers {}", key_.name, *wrong,
                                range_of(key_.range)));
            } else if (out->empty() && key_.form == Form::axis) {
                say(fmt::format("{} has no values: give {}", key_.name, kind_wanted()));
            }
        } else {
            wrong_kind(kind_wanted());
        }
    }

    void operator()(std::vector<std::string>* out) const {
        for (const Value& value : items(value_, "a list of names")) {
            const auto* text = std::get_if<std::string>(&value.data);
            if (text == nullptr || !is_name(*text)) {
                table_.add(value.at, fmt::format("{} holds {}: give names in quotes", key_.name,
                                                 shown(value)));
            } else {
                out->push_back(*text);
            }
        }
    }

    void operator()(PointList* out) const {
        if (key_.form == Form::point) {
            add_point(value_, *out);
            return;
        }
        for (const Value& value : items(value_, "an array of points [x, y]")) {
            add_point(value, *out);
        }
    }

    void operator()(PointGrid* out) const {
        for (const Value& row : items(value_, "rows of points [x, y, z]")) {
            PointList line{.dimension = 3};
            for (const Value& value : items(row, "rows of points [x, y, z]")) {
                add_point(value, line, true);
            }
            out->push_back(std::move(line.values));
        }
    }

    void operator()(NumberGrid* out) const {
        for (const Value& row : items(value_, "rows of numbers")) {
            out->push_back(list(row));
        }
    }

private:
    void say(std::string what) const { table_.add(value_.at, std::move(what)); }
    void wrong_kind(std::string_view wanted) const {
        say(fmt::format("{} is {} ({}): give {}", key_.name, shown(value_), kind_of(value_),
                        wanted));
    }
    void out_of_range(const Value& value) const {
        table_.add(value_.at,
                   fmt::format("{} is {}: give {}", key_.name, shown(value), range_of(key_.range)));
    }

    /// A quotient is rounded once: 40 mm is the double that 0.04 is. Adding 0 makes -0 into 0.
    [[nodiscard]] double to_si(double value) const { return value / key_.per_si + 0.0; }

    [[nodiscard]] std::string_view kind_wanted() const {
        return key_.form == Form::axis
                 ? "a number, a list, { from, to, count } or { from, to, step }"
             : key_.form == Form::one_or_more ? "a number or a list of numbers"
                                              : "a list of numbers";
    }

    [[nodiscard]] std::optional<double> number() const {
        const auto number = as_number(value_);
        if (!number) {
            wrong_kind(fmt::format("a number ({})", range_of(key_.range)));
        } else if (!key_.range.has(*number) ||
                   (to_si(*number) == 0.0 && !key_.range.has(0.0))) {  // 5e-324 mm are 0 m
            out_of_range(value_);
            return std::nullopt;
        }
        return number;
    }

    [[nodiscard]] std::optional<engine::Vec2> point() const {
        const auto* array = std::get_if<Array>(&value_.data);
        const bool two = array != nullptr && array->size() == 2;
        const auto x = two ? as_number((*array)[0]) : std::nullopt;
        const auto y = two ? as_number((*array)[1]) : std::nullopt;
        if (!x || !y) {
            wrong_kind("two numbers as [x, y]");
            return std::nullopt;
        }
        if (!key_.range.has(*x) || !key_.range.has(*y)) {
            out_of_range((*array)[key_.range.has(*x) ? 1 : 0]);
            return std::nullopt;
        }
        return engine::Vec2{to_si(*x), to_si(*y)};
    }

    /// The items of an array; none with a problem if it is something else.
    [[nodiscard]] const Array& items(const Value& value, std::string_view wanted) const {
        static const Array none;
        if (const auto* array = std::get_if<Array>(&value.data)) {
            return *array;
        }
        table_.add(value.at, fmt::format("{} is {} ({}): give {}", key_.name, shown(value),
                                         kind_of(value), wanted));
        return none;
    }

    [[nodiscard]] std::vector<double> list(const Value& value) const {
        std::vector<double> list;
        for (const Value& item : items(value, "an array of numbers")) {
            const auto number = as_number(item);
            if (!number || !std::isfinite(*number)) {
                table_.add(item.at,
                           fmt::format("{} holds {}: give finite numbers", key_.name, shown(item)));
            } else {
                list.push_back(*number);
            }
        }
        return list;
    }

    /// The first point says how many coordinates all have. @param space  it has to be three
    void add_point(const Value& value, PointList& out, bool space = false) const {
        const std::vector<double> xyz = list(value);
        for (const double x : xyz) {
            if (!key_.range.has(x)) {
                table_.add(value.at, fmt::format("{} holds {}: give metres from {} to {}",
                                                 key_.name, x, key_.range.min, key_.range.max));
            }
        }
        if (out.values.empty() && !space) {
            out.dimension = xyz.size() == 3 ? 3 : 2;
        }
        if (xyz.size() != static_cast<std::size_t>(out.dimension)) {
            table_.add(value.at,
                       fmt::format("point {} of {} has {} coordinates: give {}",
                                   out.values.size() + 1, key_.name, xyz.size(),
                                   space                ? "[x, y, z]"
                                   : out.values.empty() ? "[x, y] (or three in space)"
                                                        : "as many as the first point has"));
            return;
        }
        out.values.push_back({xyz[0], xyz[1], out.dimension == 3 ? xyz[2] : 0.0});
    }

    [[nodiscard]] std::vector<double> spread(const Table& table) const;

    const Key& key_;
    const Value& value_;
    TableReader& table_;
};

std::vector<double> Cell::spread(const Table& table) const {
    const std::string name(key_.name);
    TableReader reader = table_.of(table, name, value_.at, name);
    const bool by_step = reader.has("step");
    Spread all;
    reader.read_last(by_step ? Keys(kSpreadByStep) : Keys(kSpreadByCount), &all);
    if (reader.broken()) {
        table_.fail();
        return {};
    }
    const double steps =
        by_step ? std::round((all.to - all.from) / all.step) : static_cast<double>(all.count) - 1.0;
    if (!(all.to >= all.from) || !(steps < kMaxValues) || (steps == 0.0) != (all.to == all.from)) {
        say(
            fmt::format("{} goes from {} to {} in {} steps: give from < to and a step or count "
                        "that fits, at most {} values",
                        key_.name, all.from, all.to, steps, kMaxValues));
        return {};
    }
    if (by_step && std::fabs((all.to - all.from) / all.step - steps) > 1e-6) {
        say(fmt::format(
            "{} goes from {} to {} by {}, which does not end there: give another step, or a count",
            key_.name, all.from, all.to, all.step));
    }
    if (!key_.range.has(all.from) || !key_.range.has(all.to)) {
        say(fmt::format("{} holds {}: give numbers {}", key_.name,
                        key_.range.has(all.from) ? all.to : all.from, range_of(key_.range)));
    }
    std::vector<double> values = evenly(all.from, all.to, static_cast<std::size_t>(steps) + 1);
    for (std::size_t i = 1; by_step && i + 1 < values.size(); ++i) {  // .3, not .30000000000000004
        values[i] = twelve_digits(values[i], std::max(std::fabs(all.from), std::fabs(all.to)));
    }
    return values;
}

}  // namespace

void read_value(const Key& key, const Value& value, const Slot& slot, TableReader& table) {
    std::visit(Cell(key, value, table), slot);
}

std::vector<engine::Vec2> PointList::plane() const {
    std::vector<engine::Vec2> points;
    for (const engine::Vec3& p : values) {
        points.push_back({p.x, p.y});
    }
    return points;
}

}  // namespace palpate::protocols
