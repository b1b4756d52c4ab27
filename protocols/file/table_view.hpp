#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/geometry/vec.hpp"
#include "protocols/file/reader.hpp"

/// Private to protocols/format: one table of a file, key by key, for tables whose keys depend on one
/// another. Whatever is wrong becomes a problem at its place; the value given back is then a stand-in.
namespace palpate::protocols {

struct Range {
    double lowest = -std::numeric_limits<double>::infinity();
    double highest = std::numeric_limits<double>::infinity();
    bool above = false;  ///< `lowest` itself is refused
};

/// The largest coordinate, m: the squares of distances to farther places would overflow or round away.
inline constexpr double kFarthest = 1e6;

template <int D>
using Positions = std::vector<engine::Vec<D>>;

/// Points of two or of three coordinates.
struct PointList {
    int dimension = 2;
    Positions<3> values;  ///< z = 0 in the plane

    [[nodiscard]] Positions<2> plane() const;
    [[nodiscard]] const Positions<3>& space() const noexcept { return values; }
};

class TableView {
public:
    /// @param name  what messages call it: "[friction]", "[[segment]] 2"
    TableView(const Table& table, std::string name, const Position& at, Problems& problems)
        : table_(&table), name_(std::move(name)), at_(at), problems_(&problems) {}

    [[nodiscard]] double number(std::string_view key, const Range& range, double otherwise);
    [[nodiscard]] double required_number(std::string_view key, const Range& range);
    [[nodiscard]] std::int64_t integer(std::string_view key,
                                       const Range& range,
                                       std::int64_t otherwise);
    [[nodiscard]] std::int64_t required_integer(std::string_view key, const Range& range);
    /// Index of the text in `words`. @param otherwise  none: the key is required
    [[nodiscard]] std::size_t choice(std::string_view key,
                                     std::span<const std::string_view> words,
                                     std::optional<std::size_t> otherwise);
    [[nodiscard]] std::string required_text(std::string_view key);
    [[nodiscard]] std::vector<double> numbers(std::string_view key);
    [[nodiscard]] std::vector<double> numbers_or_none(std::string_view key);
    [[nodiscard]] PointList points(std::string_view key);
    [[nodiscard]] PointList point(std::string_view key);  ///< one
    [[nodiscard]] std::vector<std::vector<engine::Vec3>> point_grid(std::string_view key);
    [[nodiscard]] std::vector<std::vector<double>> number_grid_or_none(std::string_view key);

    [[nodiscard]] std::optional<TableView> table(std::string_view key);
    [[nodiscard]] std::vector<TableView> tables(std::string_view key);

    void refuse(std::string_view key, std::string what);
    /// Runs `make`; a std::invalid_argument becomes a problem of the key that it begins with, else of this
    /// table. Only if all keys were good.
    template <class Make>
    void attempt(Make&& make) {
        if (broken_) {
            return;
        }
        try {
            make();
        } catch (const std::invalid_argument& e) {
            add(spoken_of(*table_, e.what(), at_), name_ + ": " + e.what());
        }
    }
    [[nodiscard]] bool broken() const noexcept { return broken_; }  ///< a problem was found so far
    /// Every key that was not asked for is a problem.
    void refuse_unknown();

private:
    [[nodiscard]] const Entry* find(std::string_view key);
    [[nodiscard]] const Entry* require(std::string_view key, std::string_view kind);
    void add(const Position& at, std::string what);
    [[nodiscard]] double in_range(const Entry& entry, double value, const Range& range);
    [[nodiscard]] std::optional<double> number_in(std::string_view key, const Value& value);
    [[nodiscard]] std::vector<double> list_in(std::string_view key, const Value& value);
    [[nodiscard]] std::vector<double> place_in(std::string_view key, const Value& value);

    const Table* table_;
    std::string name_;
    Position at_;
    Problems* problems_;
    std::vector<std::string_view> asked_;
    bool broken_ = false;
};

}  // namespace palpate::protocols
