#include "protocols/file/table_view.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace palpate::protocols {
namespace {

std::string range_text(const Range& range) {
    const bool up = std::isfinite(range.highest);
    if (range.above) {
        return up ? fmt::format("above {}, at most {}", range.lowest, range.highest)
                  : fmt::format("above {}", range.lowest);
    }
    if (std::isfinite(range.lowest)) {
        return up ? fmt::format("{} to {}", range.lowest, range.highest)
                  : fmt::format("{} or more", range.lowest);
    }
    return up ? fmt::format("up to {}", range.highest) : "a finite number";
}

std::optional<double> as_number(const Value& value) {
    if (const auto* real = std::get_if<double>(&value.data)) {
        return *real;
    }
    if (const auto* integer = std::get_if<std::int64_t>(&value.data)) {
        return static_cast<double>(*integer);
    }
    return std::nullopt;
}

}  // namespace

Positions<2> PointList::plane() const {
    Positions<2> points;
    for (const engine::Vec3& p : values) {
        points.push_back({p.x, p.y});
    }
    return points;
}

void TableView::add(const Position& at, std::string what) {
    broken_ = true;
    problems_->add(at, std::move(what));
}

const Entry* TableView::find(std::string_view key) {
    asked_.push_back(key);
    const auto entry = std::find_if(table_->begin(), table_->end(),
                                    [key](const Entry& e) { return e.key == key; });
    return entry == table_->end() ? nullptr : &*entry;
}

const Entry* TableView::require(std::string_view key, std::string_view kind) {
    const Entry* entry = find(key);
    if (entry == nullptr) {
        add(at_, fmt::format("{} needs the key {}: add it ({})", name_, key, kind));
    }
    return entry;
}

double TableView::in_range(const Entry& entry, double value, const Range& range) {
    const bool low = range.above ? value > range.lowest : value >= range.lowest;
    if (!std::isfinite(value) || !low || value > range.highest) {
        add(entry.value.at,
            fmt::format("{} is {}: give {}", entry.key, shown(entry.value), range_text(range)));
    }
    return value;
}

double TableView::number(std::string_view key, const Range& range, double otherwise) {
    return find(key) == nullptr ? otherwise : required_number(key, range);
}

double TableView::required_number(std::string_view key, const Range& range) {
    const Entry* entry = require(key, range_text(range));
    if (entry == nullptr) {
        return std::max(range.lowest, 1.0);
    }
    const auto value = as_number(entry->value);
    if (!value) {
        add(entry->value.at,
            fmt::format("{} is {}, {}: give a number ({})", key, shown(entry->value),
                        kind_of(entry->value), range_text(range)));
        return std::max(range.lowest, 1.0);
    }
    return in_range(*entry, *value, range);
}

std::int64_t TableView::integer(std::string_view key, const Range& range, std::int64_t otherwise) {
    return find(key) == nullptr ? otherwise : required_integer(key, range);
}

std::int64_t TableView::required_integer(std::string_view key, const Range& range) {
    const Entry* entry = require(key, range_text(range));
    if (entry == nullptr) {
        return 1;
    }
    const auto* value = std::get_if<std::int64_t>(&entry->value.data);
    if (value == nullptr) {
        add(entry->value.at,
            fmt::format("{} is {}, {}: give an integer ({})", key, shown(entry->value),
                        kind_of(entry->value), range_text(range)));
        return 1;
    }
    static_cast<void>(in_range(*entry, static_cast<double>(*value), range));
    return std::clamp<std::int64_t>(*value, range.lowest == 0.0 ? 0 : 1, 1'000'000);
}

std::size_t TableView::choice(std::string_view key,
                              std::span<const std::string_view> words,
                              std::optional<std::size_t> otherwise) {
    const std::string all = fmt::format("{}", fmt::join(words, ", "));
    const Entry* entry = otherwise ? find(key) : require(key, all);
    if (entry == nullptr) {
        return otherwise.value_or(0);
    }
    const auto* text = std::get_if<std::string>(&entry->value.data);
    const auto word = text == nullptr ? words.end() : std::find(words.begin(), words.end(), *text);
    if (word == words.end()) {
        const std::string_view given = text == nullptr ? std::string_view{} : *text;
        add(entry->value.at, fmt::format("{} is {}, give one of {}{}", key, shown(entry->value),
                                         all, text == nullptr ? "" : suggestion(given, words, "")));
        return otherwise.value_or(0);
    }
    return static_cast<std::size_t>(word - words.begin());
}

std::string TableView::required_text(std::string_view key) {
    const Entry* entry = require(key, "text in quotes");
    if (entry == nullptr) {
        return {};
    }
    const auto* text = std::get_if<std::string>(&entry->value.data);
    if (text == nullptr) {
        add(entry->value.at, fmt::format("{} is {}, {}: give text in quotes", key,
                                         shown(entry->value), kind_of(entry->value)));
        return {};
    }
    return *text;
}

std::optional<double> TableView::number_in(std::string_view key, const Value& value) {
    const auto number = as_number(value);
    if (!number || !std::isfinite(*number)) {
        add(value.at, fmt::format("{} holds {}: give finite numbers", key, shown(value)));
        return std::nullopt;
    }
    return number;
}

std::vector<double> TableView::list_in(std::string_view key, const Value& value) {
    std::vector<double> list;
    const auto* array = std::get_if<Array>(&value.data);
    if (array == nullptr) {
        add(value.at, fmt::format("{} holds {}, {}: give an array of numbers", key, shown(value),
                                  kind_of(value)));
        return list;
    }
    for (const Value& item : *array) {
        if (const auto number = number_in(key, item)) {
            list.push_back(*number);
        }
    }
    return list;
}

std::vector<double> TableView::place_in(std::string_view key, const Value& value) {
    std::vector<double> place = list_in(key, value);
    for (const double x : place) {
        if (std::fabs(x) > kFarthest) {
            add(value.at, fmt::format("{} holds {}: give metres from {} to {}", key, x, -kFarthest,
                                      kFarthest));
        }
    }
    return place;
}

std::vector<double> TableView::numbers(std::string_view key) {
    const Entry* entry = require(key, "an array of numbers");
    return entry == nullptr ? std::vector<double>{} : list_in(key, entry->value);
}

std::vector<double> TableView::numbers_or_none(std::string_view key) {
    return find(key) == nullptr ? std::vector<double>{} : numbers(key);
}

PointList TableView::points(std::string_view key) {
    PointList points;
    const Entry* entry = require(key, "an array of points [x, y]");
    const auto* array = entry == nullptr ? nullptr : std::get_if<Array>(&entry->value.data);
    if (entry != nullptr && array == nullptr) {
        add(entry->value.at, fmt::format("{} is {}, {}: give an array of points [x, y]", key,
                                         shown(entry->value), kind_of(entry->value)));
    }
    if (array == nullptr) {
        return points;
    }
    for (std::size_t i = 0; i < array->size(); ++i) {
        const std::vector<double> xyz = place_in(key, (*array)[i]);
        if (i == 0) {
            points.dimension = xyz.size() == 3 ? 3 : 2;
        }
        if (xyz.size() != static_cast<std::size_t>(points.dimension)) {
            add((*array)[i].at,
                fmt::format("point {} of {} has {} coordinates: give {}", i, key, xyz.size(),
                            i == 0 ? "2 (or 3 in space)" : "as many as the first point has"));
            continue;
        }
        points.values.push_back({xyz[0], xyz[1], points.dimension == 3 ? xyz[2] : 0.0});
    }
    return points;
}

PointList TableView::point(std::string_view key) {
    PointList point;
    const Entry* entry = require(key, "a point [x, y]");
    if (entry == nullptr) {
        return point;
    }
    const std::vector<double> xyz = place_in(key, entry->value);
    if (xyz.size() != 2 && xyz.size() != 3) {
        add(entry->value.at, fmt::format("{} has {} coordinates: give [x, y]", key, xyz.size()));
        return point;
    }
    point.dimension = static_cast<int>(xyz.size());
    point.values.push_back({xyz[0], xyz[1], xyz.size() == 3 ? xyz[2] : 0.0});
    return point;
}

std::vector<std::vector<engine::Vec3>> TableView::point_grid(std::string_view key) {
    std::vector<std::vector<engine::Vec3>> grid;
    const Entry* entry = require(key, "rows of points [x, y, z]");
    const auto* rows = entry == nullptr ? nullptr : std::get_if<Array>(&entry->value.data);
    if (entry != nullptr && rows == nullptr) {
        add(entry->value.at,
            fmt::format("{} is {}: give rows of points [x, y, z]", key, shown(entry->value)));
    }
    if (rows == nullptr) {
        return grid;
    }
    for (const Value& row : *rows) {
        auto& line = grid.emplace_back();
        const auto* points = std::get_if<Array>(&row.data);
        if (points == nullptr) {
            add(row.at, fmt::format("{} holds {}: give rows of points [x, y, z]", key, shown(row)));
            continue;
        }
        for (const Value& point : *points) {
            const std::vector<double> xyz = place_in(key, point);
            if (xyz.size() != 3) {
                add(point.at, fmt::format("a point of {} has {} coordinates: give [x, y, z]", key,
                                          xyz.size()));
                continue;
            }
            line.push_back({xyz[0], xyz[1], xyz[2]});
        }
    }
    return grid;
}

std::vector<std::vector<double>> TableView::number_grid_or_none(std::string_view key) {
    std::vector<std::vector<double>> grid;
    const Entry* entry = find(key);
    if (entry == nullptr) {
        return grid;
    }
    const auto* rows = std::get_if<Array>(&entry->value.data);
    if (rows == nullptr) {
        add(entry->value.at,
            fmt::format("{} is {}: give rows of numbers", key, shown(entry->value)));
        return grid;
    }
    for (const Value& row : *rows) {
        grid.push_back(list_in(key, row));
    }
    return grid;
}

std::optional<TableView> TableView::table(std::string_view key) {
    const Entry* entry = find(key);
    if (entry == nullptr) {
        return std::nullopt;
    }
    const auto* table = std::get_if<Table>(&entry->value.data);
    if (table == nullptr) {
        add(entry->at, fmt::format("{} is {}, {}: write it as a table [{}]", key,
                                   shown(entry->value), kind_of(entry->value), key));
        return std::nullopt;
    }
    return TableView(*table, fmt::format("[{}]", key), entry->at, *problems_);
}

std::vector<TableView> TableView::tables(std::string_view key) {
    std::vector<TableView> views;
    const Entry* entry = find(key);
    if (entry == nullptr) {
        return views;
    }
    const auto* array = std::get_if<Array>(&entry->value.data);
    if (array == nullptr) {
        add(entry->at, fmt::format("{} is {}: write each as a table [[{}]], with two brackets", key,
                                   shown(entry->value), key));
        return views;
    }
    for (const Value& value : *array) {
        const auto* table = std::get_if<Table>(&value.data);
        if (table == nullptr) {
            add(value.at,
                fmt::format("{} holds {}: write it as a table [[{}]]", key, shown(value), key));
            continue;
        }
        views.emplace_back(*table, fmt::format("[[{}]] {}", key, views.size()), value.at,
                           *problems_);
    }
    return views;
}

void TableView::refuse(std::string_view key, std::string what) {
    const Entry* entry = find(key);
    add(entry == nullptr ? at_ : entry->value.at, std::move(what));
}

void TableView::refuse_unknown() {
    for (const Entry& entry : *table_) {
        if (std::find(asked_.begin(), asked_.end(), entry.key) == asked_.end()) {
            add(entry.at, fmt::format("{} has no key {}{}", name_, shown(entry.key),
                                      suggestion(entry.key, asked_)));
        }
    }
}

}  // namespace palpate::protocols
