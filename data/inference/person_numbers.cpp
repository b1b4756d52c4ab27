#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "engine/base/pcg32.hpp"
#include "data/inference/stats_report.hpp"

namespace palpate::data {
namespace {

double n_log_n(double n) {
    return n > 0.0 ? n * std::log2(n) : 0.0;
}

/// How often each shape had each response.
class Confusion {
public:
    Confusion(std::span<const std::size_t> shapes, std::span<const std::size_t> responses)
        : columns_(1 + *std::ranges::max_element(responses)),
          counts_(columns_ * (1 + *std::ranges::max_element(shapes))) {
        fill(shapes, responses);
    }

    void fill(std::span<const std::size_t> shapes, std::span<const std::size_t> responses) {
        std::ranges::fill(counts_, 0.0);
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            counts_[shapes[i] * columns_ + responses[i]] += 1.0;
        }
    }

    /// Sum of n log2 n over the cells: all of the information that the margins do not give.
    [[nodiscard]] double cells() const {
        double sum = 0.0;
        for (const double n : counts_) {
            sum += n_log_n(n);
        }
        return sum;
    }

    /// Plug-in, bits.
    [[nodiscard]] double information() const {
        std::vector<double> columns(columns_);
        double rows = 0.0;
        double all = 0.0;
        for (std::size_t first = 0; first < counts_.size(); first += columns_) {
            double row = 0.0;
            for (std::size_t c = 0; c < columns_; ++c) {
                row += counts_[first + c];
                columns[c] += counts_[first + c];
            }
            rows += n_log_n(row);
            all += row;
        }
        double sum = cells() - rows + n_log_n(all);
        for (const double n : columns) {
            sum -= n_log_n(n);
        }
        return all > 0.0 ? sum / all : 0.0;
    }

    /// Of plug-in: each trial left out once, those of a cell alike.
    [[nodiscard]] double jackknife_error() const {
        Confusion less = *this;
        std::vector<std::pair<double, double>> without;  // how many trials, the information
        double n = 0.0;
        double mean = 0.0;
        for (std::size_t cell = 0; cell < counts_.size(); ++cell) {
            if (counts_[cell] > 0.0) {
                less.counts_[cell] -= 1.0;
                without.emplace_back(counts_[cell], less.information());
                less.counts_[cell] += 1.0;
                n += counts_[cell];
                mean += counts_[cell] * without.back().second;
            }
        }
        mean /= n;
        double squares = 0.0;
        for (const auto& [trials, bits] : without) {
            squares += trials * (bits - mean) * (bits - mean);
        }
        return std::sqrt(squares * (n - 1.0) / n);
    }

private:
    std::size_t columns_;
    std::vector<double> counts_;
};

double different(std::span<const std::size_t> values) {
    return static_cast<double>(std::set<std::size_t>(values.begin(), values.end()).size());
}

}  // namespace

Transmitted transmitted(std::span<const std::size_t> shapes,
                        std::span<const std::size_t> responses,
                        std::size_t permutations,
                        std::uint64_t seed,
                        std::uint64_t stream) {
    Transmitted made;
    if (shapes.empty()) {
        return made;
    }
    ConfusionCounts counts;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        ++counts[{std::to_string(shapes[i]), std::to_string(responses[i])}];
    }
    made.bits = mutual_information(counts);
    Confusion matrix(shapes, responses);
    const double cells = matrix.cells();
    if (shapes.size() >= 2) {
        const double least =
            made.bits.plug_in - (different(shapes) - 1.0) * (different(responses) - 1.0) /
                                    (2.0 * static_cast<double>(shapes.size()) * std::numbers::ln2);
        const double half = kNormal95 * matrix.jackknife_error();
        made.interval = Interval{std::clamp(least - half, 0.0, made.bits.most),
                                 std::clamp(made.bits.miller_madow + half, 0.0, made.bits.most)};
    }
    std::vector<std::size_t> dealt(responses.begin(), responses.end());
    Pcg32 random(seed, stream);
    const auto n = static_cast<double>(shapes.size());
    std::size_t reached = 1;
    double sum = 0.0;
    for (std::size_t i = 0; i < permutations; ++i) {
        shuffle(std::span(dealt), random);
        matrix.fill(shapes, dealt);
        const double other = matrix.cells();
        reached += other >= cells - 1e-9 * cells ? std::size_t{1} : 0;
        sum += made.bits.plug_in + (other - cells) / n;
    }
    if (permutations > 0) {
        made.null_p = static_cast<double>(reached) / static_cast<double>(permutations + 1);
        made.null_mean = sum / static_cast<double>(permutations);
    }
    return made;
}

std::optional<double> type_2_area(std::span<const double> when_right,
                                  std::span<const double> when_wrong) {
    if (when_right.empty() || when_wrong.empty()) {
        return std::nullopt;
    }
    std::vector<double> wrong(when_wrong.begin(), when_wrong.end());
    std::ranges::sort(wrong);
    double sum = 0.0;
    for (const double one : when_right) {
        const auto equal = std::ranges::equal_range(wrong, one);
        sum += static_cast<double>(equal.begin() - wrong.begin()) +
               0.5 * static_cast<double>(equal.size());
    }
    return sum / static_cast<double>(when_right.size()) / static_cast<double>(wrong.size());
}

Trend trend(std::span<const Moment> moments) {
    const bool rested =
        std::ranges::all_of(moments, [](const Moment& one) { return one.since_break.has_value(); });
    const auto n = static_cast<double>(moments.size());
    double x = 0.0;
    double z = 0.0;
    double y = 0.0;
    for (const Moment& one : moments) {
        x += one.trial / n;
        z += one.since_break.value_or(0.0) / n;
        y += one.value / n;
    }
    double xx = 0.0;
    double xz = 0.0;
    double zz = 0.0;
    double xy = 0.0;
    double zy = 0.0;
    double max = 0.0;
    for (const Moment& one : moments) {
        const double dx = one.trial - x;
        const double dz = one.since_break.value_or(0.0) - z;
        const double dy = one.value - y;
        xx += dx * dx;
        xz += dx * dz;
        zz += dz * dz;
        xy += dx * dy;
        zy += dz * dy;
        max = std::max(max, std::fabs(one.value));
    }
    // What one trial changes, against the values: rounding is no trend, and no sign of one.
    const auto slope = [&](double raw, double spread) {
        return std::fabs(raw) * std::sqrt(spread / n) <= 1e-12 * max ? 0.0 : raw;
    };
    Trend made;
    const double both = xx * zz - xz * xz;
    if (rested && moments.size() >= 4 && both > 1e-9 * xx * zz) {
        made.trial = slope((zz * xy - xz * zy) / both, xx);
        made.since_break = slope((xx * zy - xz * xy) / both, zz);
    } else if (moments.size() >= 3 && xx > 0.0) {
        made.trial = slope(xy / xx, xx);
    }
    return made;
}

}  // namespace palpate::data
