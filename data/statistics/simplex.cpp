#include "data/statistics/simplex.hpp"

#include <algorithm>
#include <limits>

namespace palpate::data {
namespace {

using Value = std::function<double(std::span<const double>)>;

struct Corner {
    std::vector<double> at{};
    double value = 0.0;
};

bool higher(const Corner& a, const Corner& b) {
    return a.value > b.value;
}

Corner run(const Value& value, const std::vector<double>& start, const std::vector<double>& edge) {
    const auto corner = [&](std::vector<double> point) {
        const double at = value(point);
        return Corner{std::move(point), at};
    };
    std::vector<Corner> all{corner(start)};
    for (std::size_t i = 0; i < start.size(); ++i) {
        std::vector<double> moved = start;
        moved[i] += edge[i];
        all.push_back(corner(std::move(moved)));
    }
    const std::size_t worst = all.size() - 1;
    for (std::size_t step = 0; step < 400 * start.size(); ++step) {
        std::stable_sort(all.begin(), all.end(), higher);
        if (all.front().value - all.back().value < 1e-12) {
            break;
        }
        std::vector<double> middle(start.size(), 0.0);
        for (std::size_t c = 0; c < worst; ++c) {
            for (std::size_t i = 0; i < middle.size(); ++i) {
                middle[i] += all[c].at[i] / static_cast<double>(worst);
            }
        }
        const auto along = [&](double t) {
            std::vector<double> point = middle;
            for (std::size_t i = 0; i < point.size(); ++i) {
                point[i] += t * (all.back().at[i] - middle[i]);
            }
            return corner(std::move(point));
        };
        Corner mirrored = along(-1.0);
        if (higher(mirrored, all.front())) {
            Corner farther = along(-2.0);
            all.back() = higher(farther, mirrored) ? std::move(farther) : std::move(mirrored);
        } else if (higher(mirrored, all[worst - 1])) {
            all.back() = std::move(mirrored);
        } else {
            const bool outside = higher(mirrored, all.back());
            Corner nearer = along(outside ? -0.5 : 0.5);
            if (higher(nearer, outside ? mirrored : all.back())) {
                all.back() = std::move(nearer);
            } else {
                for (std::size_t c = 1; c < all.size(); ++c) {
                    std::vector<double> half = all[c].at;
                    for (std::size_t i = 0; i < half.size(); ++i) {
                        half[i] = 0.5 * (half[i] + all.front().at[i]);
                    }
                    all[c] = corner(std::move(half));
                }
            }
        }
    }
    return *std::min_element(all.begin(), all.end(), higher);
}

}  // namespace

SimplexMaximum simplex_maximum(const Value& value,
                               std::vector<double> start,
                               std::vector<double> edge) {
    Corner best{std::move(start), -std::numeric_limits<double>::infinity()};
    for (int i = 0; i < 12; ++i) {
        Corner found = run(value, best.at, edge);
        const double gained = found.value - best.value;
        if (gained > 0.0) {
            best = std::move(found);
        }
        if (gained < 1e-9) {
            return {std::move(best.at), best.value, true};
        }
        for (double& one : edge) {  // another shape than the one that shrank
            one *= -0.7;
        }
    }
    return {std::move(best.at), best.value, false};
}

}  // namespace palpate::data
