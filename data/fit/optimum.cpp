#include "data/fit/optimum.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "data/statistics/simplex.hpp"

namespace palpate::data {
namespace {

/// A parameter at the end of its range that would leave it does not take part in a step.
CurveMask inside(const CurveModel& model,
                 const CurvePoint& at,
                 const CurvePoint& gradient,
                 CurveMask free) {
    for (std::size_t i = 0; i < kCurveParameters; ++i) {
        free[i] = free[i] && !(at[i] <= model.low()[i] && gradient[i] <= 0.0) &&
                  !(at[i] >= model.high()[i] && gradient[i] >= 0.0);
    }
    return free;
}

CurvePoint within(const CurveModel& model, CurvePoint point, const CurveMask& free) {
    for (std::size_t i = 0; i < kCurveParameters; ++i) {
        if (free[i]) {
            point[i] = std::clamp(point[i], model.low()[i], model.high()[i]);
        }
    }
    return point;
}

CurvePoint times(const CurveMatrix& matrix, const CurvePoint& vector) {
    CurvePoint out{};
    for (std::size_t r = 0; r < kCurveParameters; ++r) {
        for (std::size_t c = 0; c < kCurveParameters; ++c) {
            out[r] += matrix[r][c] * vector[c];
        }
    }
    return out;
}

double dot(const CurvePoint& a, const CurvePoint& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < kCurveParameters; ++i) {
        sum += a[i] * b[i];
    }
    return sum;
}

}  // namespace

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
        const CurveMask moving = inside(model, best.at, gradient, free);
        CurveMatrix damped = information;
        CurvePoint pushed{};
        for (std::size_t i = 0; i < kCurveParameters; ++i) {
            damped[i][i] += damping * information[i][i] + (damping > 0.0 ? 1e-12 : 0.0);
            pushed[i] = moving[i] ? gradient[i] : 0.0;
        }
        const CurvePoint move = times(inverse(damped, moving), pushed);
        const double gain = dot(move, pushed);  // twice what the step promises
        const bool last = gain > 0.0 && damping == 0.0 && gain < tolerance;
        CurvePoint next = best.at;
        for (std::size_t i = 0; i < kCurveParameters; ++i) {
            next[i] += move[i];
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
        } else if (damping > 1e10 || std::ranges::none_of(moving, [](bool b) { return b; }) ||
                   std::ranges::all_of(pushed, [](double g) { return g == 0.0; })) {
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
    std::vector<double> from;
    std::vector<double> edge;
    for (std::size_t i = 0; i < kCurveParameters; ++i) {
        if (free[i]) {
            from.push_back(start[i]);
            edge.push_back(start[i] + edges[i] > model.high()[i] ? -edges[i] : edges[i]);
        }
    }
    const auto point_of = [&](std::span<const double> moving) {
        CurvePoint point = start;
        for (std::size_t i = 0, next = 0; i < kCurveParameters; ++i) {
            point[i] = free[i] ? moving[next++] : start[i];
        }
        return within(model, point, free);
    };
    const Summit top = simplex_maximum(
        [&](std::span<const double> moving) { return model.value(point_of(moving)); }, from, edge);
    return {point_of(top.at), top.value, top.settled};
}

}  // namespace palpate::data
