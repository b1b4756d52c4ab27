#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "engine/geometry/vec.hpp"
#include "data/csv/number_table.hpp"

/// Tables of points that the offline tools read: t_s, x_m, y_m and in space z_m.
namespace palpate::ui {

/// A path of a hand, or points at no time, checked as a whole when it is made and then read again
/// row by row: it may be longer than the memory.
class Trajectory {
public:
    /// @param timed  false: there is no column t_s; ticks have no time
    /// @throws data::CsvError for what is no table of finite numbers, a place out of reach, a time
    ///         that does not grow or a tick above an hour: file:line, the value and a remedy
    Trajectory(const std::filesystem::path& file, int dimension, bool timed);

    struct Tick {
        double t = 0.0;       ///< s
        double period = 0.0;  ///< s: since the tick before; of the first, that of the second
        engine::Vec3 hip{};   ///< m; z is 0 in the plane
    };

    /// One after the other.
    class Rows {
    public:
        explicit Rows(const Trajectory& path);
        /// @return false at the end @throws data::CsvError as Trajectory, if the file was changed
        /// meanwhile
        [[nodiscard]] bool next();
        [[nodiscard]] const Tick& tick() const noexcept { return tick_; }
        [[nodiscard]] std::size_t line() const { return rows_.line(); }  ///< in the file, from 1

    private:
        const Trajectory& path_;
        data::NumberRows rows_;
        std::size_t read_ = 0;
        Tick tick_{};
    };

    /// Of the first tick, s; of an empty path, or one of a single tick, 1 ms.
    [[nodiscard]] double first_period() const noexcept { return first_; }
    [[nodiscard]] const std::string& name() const noexcept { return text_.name(); }

private:
    /// Periods near the mean are the mean: t_s in decimals is rounded.
    [[nodiscard]] double evened(double period) const noexcept;

    data::RereadableText text_;
    int dimension_;
    bool timed_;
    double mean_ = 0.0;   ///< period, s; 0: not known yet
    double first_ = 0.0;  ///< period, s
};

}  // namespace palpate::ui
