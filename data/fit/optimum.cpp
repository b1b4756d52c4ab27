#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "engine/math/elementary.hpp"
#include "protocols/psychometric/exact_math.hpp"
#include "data/fit/curve_fit.hpp"
#include "data/statistics/solve.hpp"

namespace palpate::data {
namespace {

using protocols::exponential;

/// Values closer than this are of one maximum.
constexpr double kSameHill = 1e-6;

CurvePoint within(const CurveModel& model, CurvePoint point, const CurveMask& free) {
    for (std::size_t i = 0; i < kCurveParameters; ++i) {
        if (free[i]) {
            point[i] = std::clamp(point[i], model.low()[i], model.high()[i]);
        }
    }
    return point;
}

/// In how many levels a location is looked for by their shares; of more, every second, third ...
constexpr std::size_t kSharesUsed = 24;

/// Where a curve may lie: places whatever its slope is, and a level with the u of its share.
struct Places {
    std::vector<double> plain{};
    std::vector<std::pair<double, double>> shares{};

    Places(const CurveModel& model, const CurvePoint& rates, Search search) {
        const double range = model.last() - model.first();
        const int steps = search == Search::thorough ? 12 : 6;  // a range
        for (int i = -steps / 2; i <= steps + steps / 2; ++i) {
            plain.push_back(model.first() + range * i / steps);
        }
        const protocols::Family family = model.spec().family;
        const double half = core_quantile(family, 0.5);
        const auto z = model.places();
        const std::size_t stride = 1 + z.size() / kSharesUsed;
        for (std::size_t i = 0; i < z.size(); i += stride) {
            if (!std::isfinite(z[i])) {
                continue;
            }
            if (i + 1 < z.size()) {
                plain.push_back(0.5 * (z[i] + z[i + 1]));
            }
            const double share = (model.hits()[i] / model.counts()[i] - rates[2]) /
                                 std::max(1.0 - rates[2] - rates[3], 0.01);
            if (share > 0.0 && share < 1.0) {
                shares.emplace_back(z[i], core_quantile(family, share) - half);
            }
        }
    }

    /// Rising locations of a curve whose ln b at a location is `log_slope`.
    template <typename LogSlope>
    [[nodiscard]] std::vector<double> locations(const LogSlope& log_slope) const {
        std::vector<double> all = plain;
        for (const auto& [z, u] : shares) {
            all.push_back(z - u * exponential(-log_slope(z)));
        }
        std::ranges::sort(all);
        return all;
    }
};

/// Rows of points, each with its neighbours beside it; the rates as in `near`.
std::vector<std::vector<CurvePoint>> rows(const CurveModel& model,
                                          const CurvePoint& near,
                                          const CurveMask& free,
                                          Search search) {
    const double range = model.last() - model.first();
    const double lowest = engine::natural_log(0.25 / range);
    const double ratio = search == Search::thorough ? 0.5 * protocols::kLn2 : protocols::kLn2;
    const double step = std::max(ratio, (model.high()[1] - lowest) / 60.0);
    std::vector<double> slopes;
    for (double one = lowest; one < model.high()[1]; one += step) {
        slopes.push_back(one);
    }
    slopes.push_back(model.high()[1]);
    const Places places(model, near, search);
    std::vector<std::vector<CurvePoint>> all;
    const auto row_at = [&](const auto& log_slope) {
        std::vector<CurvePoint> row;
        for (const double location : places.locations(log_slope)) {
            row.push_back({location, log_slope(location), near[2], near[3]});
        }
        all.push_back(std::move(row));
    };
    const Tie::Kind tie = model.tied_by();
    if (tie == Tie::Kind::jnd || tie == Tie::Kind::weber) {
        row_at([&](double location) { return model.log_slope_at(location); });
    } else if (!free[1]) {
        row_at([&](double) { return near[1]; });
    } else if (free[0]) {
        for (const double slope : slopes) {
            row_at([slope](double) { return slope; });
        }
    } else {
        all.emplace_back();
        for (const double slope : slopes) {
            all.back().push_back({near[0], slope, near[2], near[3]});
        }
    }
    return all;
}

/// The local maxima of a row; of equals the middle.
std::vector<Optimum> tops_of(const std::vector<Optimum>& here) {
    std::vector<Optimum> tops;
    for (std::size_t i = 0; i < here.size();) {
        std::size_t end = i + 1;
        while (end < here.size() && here[end].value == here[i].value) {
            ++end;
        }
        const bool above_left = i == 0 || here[i].value > here[i - 1].value;
        const bool above_right = end == here.size() || here[i].value > here[end].value;
        if (above_left && above_right) {
            tops.push_back(here[(i + end - 1) / 2]);
        }
        i = end;
    }
    return tops;
}

/// The least value between two places, by golden section, as far as numbers lie between them.
double bottom(const std::function<double(double)>& value, double low, double high) {
    constexpr double kGolden = 0.6180339887498949;
    const double end = 1e-5 * (high - low);
    double a = high - kGolden * (high - low);
    double b = low + kGolden * (high - low);
    double at_a = value(a);
    double at_b = value(b);
    while (high - low > end && low < a && a < b && b < high) {
        if (at_a < at_b) {
            high = b;
            b = a;
            at_b = at_a;
            a = high - kGolden * (high - low);
            at_a = value(a);
        } else {
            low = a;
            a = b;
            at_a = at_b;
            b = low + kGolden * (high - low);
            at_b = value(b);
        }
    }
    return std::min(at_a, at_b);
}

}  // namespace

double dot(const CurvePoint& a, const CurvePoint& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

CurvePoint times(const CurveMatrix& matrix, const CurvePoint& vector) {
    CurvePoint out{};
    for (std::size_t r = 0; r < kCurveParameters; ++r) {
        out[r] = dot(matrix[r], vector);
    }
    return out;
}

DampedStep::DampedStep(const CurveModel& model,
                       const CurvePoint& at,
                       const CurvePoint& slopes,
                       const CurveMatrix& curvature,
                       const CurveMask& free,
                       double damping)
    : information(curvature) {
    CurveMask moving{};
    for (std::size_t i = 0; i < kCurveParameters; ++i) {
        moving[i] = free[i] && !(at[i] <= model.low()[i] && slopes[i] <= 0.0) &&
                    !(at[i] >= model.high()[i] && slopes[i] >= 0.0);
        gradient[i] = moving[i] ? slopes[i] : 0.0;
        information[i][i] += damping * curvature[i][i] + (damping > 0.0 ? 1e-12 : 0.0);
    }
    inverse = data::inverse(information, moving);
    move = times(inverse, gradient);
}

Highest highest(const CurveModel& model,
                const CurvePoint& near,
                const CurveMask& free,
                Search search,
                double tolerance) {
    const std::vector<double> guesses =
        free[2] ? std::vector{0.02, 0.15, 0.4} : std::vector{near[2]};
    const std::vector<double> lapses =
        free[3] ? std::vector{0.005, 0.05, 0.15} : std::vector{near[3]};
    const auto keep = [](std::vector<Optimum>& starts, std::size_t max) {
        max = std::min(max, starts.size());
        std::partial_sort(starts.begin(), starts.begin() + static_cast<std::ptrdiff_t>(max),
                          starts.end(),
                          [](const Optimum& a, const Optimum& b) { return a.value > b.value; });
        starts.resize(max);
    };
    std::vector<Optimum> all;
    const std::vector<std::vector<CurvePoint>> grid = rows(model, near, free, search);
    for (const std::vector<CurvePoint>& row : grid) {
        std::vector<Optimum> here;
        for (CurvePoint point : row) {
            Optimum best{.value = -std::numeric_limits<double>::infinity()};
            for (const double guess : guesses) {
                for (const double lapse : lapses) {
                    point[2] = guess;
                    point[3] = lapse;
                    const double value = model.value(point);
                    best = value > best.value ? Optimum{point, value} : best;
                }
            }
            here.push_back(best);
        }
        std::vector<Optimum> tops = tops_of(here);
        keep(tops, grid.size() == 1 ? 4 : 2);
        all.insert(all.end(), tops.begin(), tops.end());
    }
    keep(all, search == Search::quick ? 4 : all.size());
    Highest found{climb(model, near, free, tolerance), near};
    double reached = -std::numeric_limits<double>::infinity();  // from found.start
    for (const Optimum& start : all) {
        const Optimum one = climb(model, start.at, free, tolerance);
        if (one.value > reached + kSameHill) {
            reached = one.value;
            found.start = start.at;
        }
        if (one.value > found.best.value) {
            found.best = one;
        }
    }
    found.start = found.best.value > reached + kSameHill ? near : found.start;
    const int more = search == Search::thorough ? 20 : 0;
    for (int i = 0; i < more && !found.best.settled; ++i) {
        found.best = climb(model, found.best.at, free, tolerance);
    }
    return found;
}

CurveMatrix inverse(const CurveMatrix& matrix, const CurveMask& used) {
    CurveMatrix left = matrix;
    CurveMatrix right{};
    for (std::size_t i = 0; i < kCurveParameters; ++i) {
        right[i][i] = used[i] ? 1.0 : 0.0;
    }
    for (std::size_t p = 0; p < kCurveParameters; ++p) {
        if (!used[p]) {
            continue;
        }
        // Of the pivot 1e-13 is left by rounding where two parameters say the same.
        const double pivot = left[p][p];
        if (!(pivot > 1e-13 * matrix[p][p]) || !std::isfinite(pivot)) {
            return {};
        }
        for (std::size_t c = 0; c < kCurveParameters; ++c) {
            left[p][c] /= pivot;
            right[p][c] /= pivot;
        }
        for (std::size_t r = 0; r < kCurveParameters; ++r) {
            const double share = left[r][p];
            if (r == p || !used[r] || share == 0.0) {
                continue;
            }
            for (std::size_t c = 0; c < kCurveParameters; ++c) {
                left[r][c] -= share * left[p][c];
                right[r][c] -= share * right[p][c];
            }
        }
    }
    return right;
}

Optimum climb(const CurveModel& model,
              const CurvePoint& start,
              const CurveMask& free,
              double tolerance) {
    Optimum best{.at = within(model, start, free)};
    CurvePoint gradient;
    CurveMatrix information;
    best.value = model.derivatives(best.at, gradient, information);
    double damping = 0.0;
    for (int step = 0; step < 200; ++step) {
        const DampedStep made(model, best.at, gradient, information, free, damping);
        const double gain = dot(made.move, made.gradient);  // twice what the step promises
        const bool last = gain > 0.0 && damping == 0.0 && gain < tolerance;
        CurvePoint next = best.at;
        for (std::size_t i = 0; i < kCurveParameters; ++i) {
            next[i] += made.move[i];
        }
        next = within(model, next, free);
        CurvePoint next_gradient;
        CurveMatrix next_information;
        const double value = model.derivatives(next, next_gradient, next_information);
        if (last) {  // so short a step may look lower by rounding alone
            const bool lower = value < best.value - 1e-12 * std::fabs(best.value);
            return lower ? Optimum{best.at, best.value, true} : Optimum{next, value, true};
        }
        if (gain > 0.0 && value > best.value) {
            const double gained = value - best.value;
            best = {.at = next, .value = value};
            gradient = next_gradient;
            information = next_information;
            damping = damping < 1e-3 ? 0.0 : 0.1 * damping;
            if (damping == 0.0 && gained < tolerance) {
                best.settled = true;
                return best;
            }
        } else if (damping > 1e10 || made.gradient == CurvePoint{}) {
            best.settled = true;  // nowhere is higher
            return best;
        } else {
            damping = damping == 0.0 ? 1e-3 : 10.0 * damping;
        }
    }
    return best;
}

Optimum nelder_mead(const CurveModel& model, const CurvePoint& start, const CurveMask& free) {
    const double range = model.last() - model.first();
    const CurvePoint edges{0.1 * range, 0.3, 0.05, 0.02};
    Optimum best{.at = within(model, start, free)};
    best.value = model.value(best.at);
    // Beyond an end all values are alike: a simplex that shrank there begins anew inside.
    for (int i = 0; i < 12 && !best.settled; ++i) {
        const auto point_of = [&](std::span<const double> moving) {
            CurvePoint point = best.at;
            for (std::size_t p = 0, next = 0; p < kCurveParameters; ++p) {
                point[p] = free[p] ? moving[next++] : point[p];
            }
            return within(model, point, free);
        };
        std::vector<double> from;
        std::vector<double> edge;
        for (std::size_t p = 0; p < kCurveParameters; ++p) {
            if (free[p]) {
                from.push_back(best.at[p]);
                edge.push_back(best.at[p] + edges[p] > model.high()[p] ? -edges[p] : edges[p]);
            }
        }
        const SimplexMaximum top = simplex_maximum(
            [&](std::span<const double> moving) { return model.value(point_of(moving)); }, from,
            edge);
        best.settled = top.value - best.value < 1e-9;
        if (top.value > best.value) {
            best.at = point_of(top.at);
            best.value = top.value;
        }
    }
    return best;
}

double least_between(const std::function<double(double)>& loss, double one, double other) {
    constexpr int kSteps = 16;
    const double low = std::min(one, other);
    const double step = (std::max(one, other) - low) / kSteps;
    std::array<double, kSteps + 1> grid{};
    for (int i = 0; i <= kSteps; ++i) {
        grid.at(static_cast<std::size_t>(i)) = loss(low + step * i);
    }
    const double deepest = *std::ranges::min_element(grid);
    double least = deepest;
    const auto value = [&](int at) {
        return grid.at(static_cast<std::size_t>(std::clamp(at, 0, kSteps)));
    };
    for (int i = 0; i <= kSteps && step > 0.0; ++i) {
        constexpr double kNotDeeper = 0.5;  // of log-likelihood, than the deepest
        const bool dip = value(i) <= value(i - 1) && value(i) <= value(i + 1);
        if (dip && value(i) < deepest + kNotDeeper) {
            least = std::min(least, bottom(loss, low + step * std::max(i - 1, 0),
                                           low + step * std::min(i + 1, kSteps)));
        }
    }
    return least;
}

}  // namespace palpate::data
