#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace palpate::protocols {

/// One dimension of a grid: the values that a stimulus or a parameter can take.
struct Axis {
    std::string name;
    std::vector<double> values;  ///< finite, strictly increasing, at least one

    friend bool operator==(const Axis&, const Axis&) = default;
};

/// The product of its axes. Cells are numbered with the last axis running fastest.
class Grid {
public:
    Grid() = default;
    /// @throws std::invalid_argument without axes, for a name that comes twice, for values that do
    ///         not increase, or for more than kMaxCells cells
    explicit Grid(std::vector<Axis> axes);

    /// Axes, and cells: the product of the axes' lengths.
    [[nodiscard]] std::size_t dimensions() const noexcept { return axes_.size(); }
    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    /// @throws std::out_of_range for k >= dimensions()
    [[nodiscard]] const Axis& axis(std::size_t k) const { return axes_.at(k); }
    [[nodiscard]] std::span<const Axis> axes() const noexcept { return axes_; }
    /// Which value of axis k cell `cell` has. @pre cell < size()
    [[nodiscard]] std::size_t index(std::size_t cell, std::size_t k) const noexcept {
        return cell / strides_[k] % axes_[k].values.size();
    }
    /// Coordinates of a cell. @pre cell < size()
    [[nodiscard]] std::vector<double> point(std::size_t cell) const;
    /// The cell at a point; a coordinate may be off by 1e-9 of its axis' range or size, as decimals
    /// are.
    /// @throws std::invalid_argument if the point has other dimensions or is not on the grid
    [[nodiscard]] std::size_t cell_at(std::span<const double> point) const;

    friend bool operator==(const Grid&, const Grid&) = default;

private:
    std::vector<Axis> axes_;
    std::vector<std::size_t> strides_;
    std::size_t size_ = 0;
};

/// More cells than a participant could wait for.
inline constexpr std::size_t kMaxCells = 10'000'000;

/// "from" to "to" in `count` equal steps, the ends exact. @pre count >= 1
[[nodiscard]] std::vector<double> evenly(double from, double to, std::size_t count);

}  // namespace palpate::protocols
