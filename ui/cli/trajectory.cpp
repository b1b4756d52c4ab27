#include "ui/cli/trajectory.hpp"

#include <array>
#include <cmath>
#include <span>
#include <string_view>

#include "engine/base/refuse.hpp"
#include "protocols/file/scene_file.hpp"

namespace palpate::ui {
namespace {

constexpr std::array<std::string_view, 4> kColumns{"t_s", "x_m", "y_m", "z_m"};

/// Tick periods that differ by less than this share are the same.
constexpr double kSamePeriod = 1e-6;
constexpr double kShortestPeriod = 1e-12;  ///< s: a speed over less may be no number
constexpr double kLongestPeriod = 3600.0;  ///< s
/// Tick period of a path of a single row, s.
constexpr double kUsualPeriod = 0.001;

std::span<const std::string_view> columns_of(int dimension, bool timed) {
    const std::size_t first = timed ? 0 : 1;
    return std::span(kColumns).subspan(first, static_cast<std::size_t>(dimension) + 1 - first);
}

void check_reach(const std::string& file,
                 std::size_t line,
                 std::string_view column,
                 double metres) {
    refuse_if<data::CsvError>(std::fabs(metres) > protocols::kFarthest,
                              "{}:{}: {} is {}: give metres from {} to {}", file, line, column,
                              metres, -protocols::kFarthest, protocols::kFarthest);
}

}  // namespace

Trajectory::Trajectory(const std::filesystem::path& file, int dimension, bool timed)
    : text_(file), dimension_(dimension), timed_(timed), first_(kUsualPeriod) {
    Rows rows(*this);
    std::size_t count = 0;
    double begin = 0.0;
    double second = 0.0;
    for (; rows.next(); ++count) {
        begin = count == 0 ? rows.tick().t : begin;
        second = count == 1 ? rows.tick().t : second;
    }
    if (timed && count > 1) {
        mean_ = (rows.tick().t - begin) / static_cast<double>(count - 1);
        first_ = evened(second - begin);
    }
}

double Trajectory::evened(double period) const noexcept {
    return std::fabs(period - mean_) <= kSamePeriod * mean_ ? mean_ : period;
}

Trajectory::Rows::Rows(const Trajectory& path)
    : path_(path), rows_(path.text_, columns_of(path.dimension_, path.timed_)) {}

bool Trajectory::Rows::next() {
    if (!rows_.next()) {
        return false;
    }
    const std::string& file = path_.name();
    const double before = tick_.t;
    tick_ = {.t = path_.timed_ ? rows_.at(0) : 0.0, .period = path_.first_};
    for (int k = 0; k < path_.dimension_; ++k) {
        const auto column = static_cast<std::size_t>(k);
        tick_.hip[k] = rows_.at(column + (path_.timed_ ? 1 : 0));
        check_reach(file, rows_.line(), kColumns.at(column + 1), tick_.hip[k]);
    }
    if (!path_.timed_ || read_++ == 0) {
        return true;
    }
    const double period = tick_.t - before;
    refuse_if<data::CsvError>(!(period > 0.0),
                              "{}:{}: t_s is {} after {}: time has to grow from row to row", file,
                              rows_.line(), tick_.t, before);
    refuse_if<data::CsvError>(period < kShortestPeriod || period > kLongestPeriod,
                              "{}:{}: t_s is {} after {}: give ticks of {} to {} s", file,
                              rows_.line(), tick_.t, before, kShortestPeriod, kLongestPeriod);
    tick_.period = path_.evened(period);
    return true;
}

}  // namespace palpate::ui
