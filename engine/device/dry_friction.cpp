#include "engine/device/dry_friction.hpp"

#include <cmath>
#include <limits>

namespace palpate::engine {
namespace {

double sign(double x) noexcept {
    return x == 0.0 ? 0.0 : std::copysign(1.0, x);
}

struct Trial {
    Vec2 rates{};
    double wrong = std::numeric_limits<double>::infinity();  ///< rad/s by which the case fails
};

/// By how much a joint that is said to turn that way turns the other way.
double backwards(double rate, double way, double limit) noexcept {
    const double back = -rate * way;
    return limit > 0.0 && back > 0.0 ? back : 0.0;
}

/// By how much the friction that holds a joint exceeds what it can, as a rate.
double too_strong(double hold, double limit, double diagonal) noexcept {
    const double beyond = std::fabs(hold) - limit;
    return beyond > 0.0 ? beyond / diagonal : 0.0;
}

Trial tried(const Vec2& row_1,
            const Vec2& row_2,
            const Vec2& right,
            const Vec2& limit,
            double way_1,
            double way_2) noexcept {
    const Vec2 driven = right - Vec2{limit.x * way_1, limit.y * way_2};
    Trial trial;
    if (way_1 != 0.0 && way_2 != 0.0) {
        const double det = cross(row_1, row_2);
        trial.rates =
            Vec2{row_2.y * driven.x - row_1.y * driven.y, row_1.x * driven.y - row_2.x * driven.x} /
            det;
        trial.wrong =
            backwards(trial.rates.x, way_1, limit.x) + backwards(trial.rates.y, way_2, limit.y);
    } else if (way_1 != 0.0) {
        trial.rates.x = driven.x / row_1.x;
        trial.wrong = backwards(trial.rates.x, way_1, limit.x) +
                      too_strong(row_2.x * trial.rates.x - right.y, limit.y, row_2.y);
    } else if (way_2 != 0.0) {
        trial.rates.y = driven.y / row_2.y;
        trial.wrong = backwards(trial.rates.y, way_2, limit.y) +
                      too_strong(row_1.y * trial.rates.y - right.x, limit.x, row_1.x);
    } else {
        trial.wrong = too_strong(right.x, limit.x, row_1.x) + too_strong(right.y, limit.y, row_2.y);
    }
    return trial;
}

}  // namespace

Vec2 after_dry_friction(const Vec2& row_1,
                        const Vec2& row_2,
                        const Vec2& right,
                        const Vec2& limit,
                        const Vec2& before) noexcept {
    Trial best = tried(row_1, row_2, right, limit, sign(before.x), sign(before.y));
    for (int way_1 = -1; way_1 <= 1 && best.wrong > 0.0; ++way_1) {
        for (int way_2 = -1; way_2 <= 1 && best.wrong > 0.0; ++way_2) {
            const Trial next = tried(row_1, row_2, right, limit, way_1, way_2);
            if (next.wrong < best.wrong) {
                best = next;
            }
        }
    }
    return best.rates;
}

Vec2 after_dry_friction(const Vec2& row_1,
                        const Vec2& row_2,
                        const Vec2& right,
                        const StepFriction& friction,
                        const Vec2& before) noexcept {
    constexpr int kRounds = 3;
    constexpr double kStands = 1e-3;
    const auto& [joints, handle, carry_1, carry_2] = friction;
    const auto larger = [](double a, double b) {  // as std::fmax, without a call
        return a > b ? a : b;
    };
    const auto speed = [&](const Vec2& rates) {
        return std::sqrt(
            larger(rates.x * glm::dot(carry_1, rates) + rates.y * glm::dot(carry_2, rates), 0.0));
    };
    const auto braked = [&](double by) {
        return after_dry_friction(row_1 + by * carry_1, row_2 + by * carry_2, right, joints,
                                  before);
    };
    const Vec2 loose = after_dry_friction(row_1, row_2, right, joints, before);
    if (!(handle > 0.0)) {
        return loose;
    }
    const double fastest = speed(loose);
    if (!(fastest > 0.0)) {
        return loose;
    }
    const double slowest = kStands * fastest;
    if (!(speed(braked(handle / slowest)) > slowest)) {
        return {};
    }
    // Of a mass m alone: speed = p / (m + handle / s), and s = p / m - handle / m.
    Vec2 rates = braked(handle / fastest);
    const double slower = larger(fastest * (fastest / speed(rates) - 1.0), 0.0);
    double s = larger(fastest - slower, slowest);
    for (int i = 0; i < kRounds; ++i) {
        rates = braked(handle / s);
        s = larger(speed(rates) * (1.0 + slower / s) - slower, slowest);
    }
    return rates;
}

}  // namespace palpate::engine
