#include <numbers>
#include <numeric>

#include "data/choice/thurstone.hpp"
#include "data/statistics/solve.hpp"

namespace palpate::data::thurstone {
namespace {

/// Below this share of the least distance of two items nothing but lapses is left: sigma is
/// unbounded.
constexpr double kSharp = 0.1;

/// Beyond this many times the items' range an answer tells nothing of the item.
constexpr double kBlunt = 1000.0;

double above(double z) {
    return 0.5 * std::erfc(z * std::numbers::sqrt2 / 2.0);
}

}  // namespace

/// Where the place of a response ends for one item: sigmas from the percept's mean.
struct Edge {
    double z = 0.0;
    double tail = 0.0;     ///< P(beyond it), on the side away from the mean
    double density = 0.0;  ///< at z; 0 unless slopes are asked for, and without end

    Edge(double at, bool slopes) : z(at), tail(above(std::fabs(at))) {
        if (slopes && !std::isinf(at)) {
            density = std::exp(-0.5 * at * at) / std::sqrt(2.0 * std::numbers::pi);
        }
    }

    /// P(percept from here to there) without loss in either tail.
    [[nodiscard]] double to(const Edge& high) const {
        return z > 0.0 ? tail - high.tail : (high.z > 0.0 ? above(-high.z) : high.tail) - tail;
    }
    /// z * density; 0 without end.
    [[nodiscard]] double pull() const { return std::isinf(z) ? 0.0 : z * density; }
};

/// What value() computes of one row after the other.
struct Model::Row {
    std::vector<Edge> edges{};  ///< of the places of responses in use, and the last one's end
    Parameters slope{};         ///< of a place's share, by each parameter
};

double least_distance(const std::vector<double>& items) {
    double least = kInfinite;
    for (std::size_t i = 0; i + 1 < items.size(); ++i) {
        least = std::min(least, items[i + 1] - items[i]);
    }
    return least;
}

Interval sigma_limits(const ThurstoneSpec& spec, bool ratio) {
    const double range = spec.items.back() - spec.items.front();
    const double sharp = std::log(kSharp * least_distance(spec.items));
    const double blunt = std::log(kBlunt * range);
    return ratio ? Interval{sharp - blunt, blunt - sharp} : Interval{sharp, blunt};
}

double Model::value(const Parameters& at, Parameters* gradient, Parameters* information) const {
    if (gradient != nullptr) {
        gradient->assign(layout_.size(), 0.0);
        information->assign(layout_.size() * layout_.size(), 0.0);
    }
    for (std::size_t j = 0; j + 1 < layout_.criteria(); ++j) {
        if (!(at[j] < at[j + 1])) {
            return kLowest;
        }
    }
    Row row;
    double sum = 0.0;
    for (std::size_t f = 0; f < counts_.size(); ++f) {
        for (std::size_t i = 0; i < spec_.items.size(); ++i) {
            sum += row_value(at, f, i, row, gradient, information);
        }
    }
    return std::isfinite(sum) ? sum : kLowest;
}

double Model::row_value(const Parameters& at,
                        std::size_t f,
                        std::size_t i,
                        Row& row,
                        Parameters* gradient,
                        Parameters* information) const {
    const std::vector<std::int64_t>& counts = counts_[f][i];
    const auto total =
        static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::int64_t{0}));
    if (!(total > 0.0)) {
        return 0.0;
    }
    const double one_sigma = sigma(at, f);
    const double scale = (1.0 - spec_.lapse) / one_sigma;
    row.edges.clear();
    row.edges.emplace_back(-kInfinite, false);
    for (std::size_t j = 0; j < layout_.criteria(); ++j) {
        row.edges.emplace_back((at[j] - spec_.items[i] - shift(at, f)) / one_sigma,
                               gradient != nullptr);
    }
    row.edges.emplace_back(kInfinite, false);
    double sum = 0.0;
    const std::size_t n = layout_.size();
    for (std::size_t j = 0; j < layout_.used.size(); ++j) {
        const Edge& low = row.edges[j];
        const Edge& high = row.edges[j + 1];
        const auto given = static_cast<double>(counts[layout_.used[j]]);
        const double p =
            (1.0 - spec_.lapse) * low.to(high) + spec_.lapse / static_cast<double>(counts.size());
        sum += given > 0.0 ? given * std::log(p) : 0.0;
        if (gradient == nullptr || !(p > 0.0)) {
            continue;
        }
        Parameters& slope = row.slope;
        slope.assign(n, 0.0);
        if (j < layout_.criteria()) {
            slope[j] += scale * high.density;
        }
        if (j > 0) {
            slope[j - 1] -= scale * low.density;
        }
        const double pulled = (1.0 - spec_.lapse) * (high.pull() - low.pull());
        slope[layout_.sigma(f)] -= pulled;
        if (spec_.relative && f > 0) {
            slope[layout_.sigma(0)] -= pulled;
        }
        if (layout_.shifts(f)) {
            slope[layout_.shift(f)] -= scale * (high.density - low.density);
        }
        for (std::size_t a = 0; a < n; ++a) {
            (*gradient)[a] += given / p * slope[a];
            for (std::size_t b = 0; b < n && slope[a] != 0.0; ++b) {
                (*information)[a * n + b] += total / p * slope[a] * slope[b];
            }
        }
    }
    return sum;
}

namespace {

struct Slopes {
    Parameters gradient{};
    Parameters information{};
};

/// Value and slopes where two parameters stay.
double derivatives(
    const Model& model, const Parameters& at, std::size_t held, std::size_t also, Slopes& there) {
    const double value = model.value(at, &there.gradient, &there.information);
    const std::size_t n = at.size();
    for (const std::size_t one : {held, also}) {
        if (one != kNone) {
            there.gradient[one] = 0.0;
            for (std::size_t i = 0; i < n; ++i) {
                there.information[one * n + i] = there.information[i * n + one] = 0.0;
            }
            there.information[one * n + one] = 1.0;
        }
    }
    return value;
}

}  // namespace

Maximum climb(const Model& model, Parameters start, std::size_t held, std::size_t also) {
    const std::size_t n = start.size();
    Maximum best{start, kLowest, std::move(start)};
    Maximum next = best;
    Slopes slopes;
    Slopes next_slopes;
    best.value = derivatives(model, best.at, held, also, slopes);
    const Parameters& gradient = slopes.gradient;
    const Parameters& information = slopes.information;
    Parameters damped;
    double damping = 0.0;
    for (int step = 0; step < 300 && std::isfinite(best.value); ++step) {
        double trace = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            trace += information[i * n + i];
        }
        damped = information;
        for (std::size_t i = 0; i < n; ++i) {
            damped[i * n + i] += damping * information[i * n + i];
            damped[i * n + i] += 1e-12 * (1.0 + trace);
        }
        const Parameters move = solve_symmetric(damped, gradient);
        const double promised = std::inner_product(move.begin(), move.end(), gradient.begin(), 0.0);
        next.value = kLowest;
        for (std::size_t i = 0; i < n; ++i) {
            next.at[i] = best.at[i] + move[i];
        }
        if (std::ranges::all_of(move, [](double one) { return std::isfinite(one); })) {
            model.keep_within(next.at, held);
            next.value = derivatives(model, next.at, held, also, next_slopes);
        }
        if (next.value >= best.value) {
            const bool settled = promised < 1e-13 || next.value - best.value < 1e-13;
            std::swap(best, next);
            std::swap(slopes, next_slopes);
            damping = damping < 1e-3 ? 0.0 : 0.1 * damping;
            if (settled) {
                break;
            }
        } else if (promised < 1e-13 || damping > 1e10) {
            break;
        } else {
            damping = damping == 0.0 ? 1e-3 : 10.0 * damping;
        }
    }
    return best;
}

Parameters start_at(const Layout& layout, const ThurstoneSpec& spec, double sigma) {
    Parameters at(layout.size(), 0.0);
    const double range = spec.items.back() - spec.items.front();
    for (std::size_t j = 0; j < layout.criteria(); ++j) {
        at[j] = spec.items.front() +
                range * (static_cast<double>(j) + 0.5) / static_cast<double>(layout.criteria());
    }
    for (std::size_t f = 0; f < layout.conditions; ++f) {
        at[layout.sigma(f)] = spec.relative && f > 0 ? 0.0 : std::log(sigma);
    }
    return at;
}

std::vector<Parameters> starts_of(const Layout& layout, const ThurstoneSpec& spec) {
    std::vector<Parameters> all;
    for (const double sigma : {0.4, 1.0, 3.0}) {
        all.push_back(start_at(layout, spec, sigma * least_distance(spec.items)));
    }
    return all;
}

namespace {

/// Whether one parameter moved elsewhere, and all others climbed there first, leads higher.
bool hop(const Model& model, Maximum& top, std::size_t held, std::size_t moved, double place) {
    Parameters at = top.at;
    at[moved] = place;
    return moved != held &&
           take_higher(top, climb(model, climb(model, std::move(at), held, moved).at, held),
                       kNoLoss);
}

}  // namespace

bool take_higher(Maximum& top, Maximum other, double margin) {
    const bool higher = other.value > top.value + margin;
    if (higher) {
        top = std::move(other);
    }
    return higher;
}

Maximum over_hills(const Model& model, const ThurstoneSpec& spec, Maximum top, std::size_t held) {
    const Layout& layout = model.layout();
    const double spacing = least_distance(spec.items);
    bool again = true;
    for (int round = 0; round < (held == kNone ? 3 : 1) && again; ++round) {
        again = false;
        for (std::size_t f = 0; f < layout.conditions; ++f) {
            for (const double sigma : {0.1, 0.2, 0.5, 1.0, 2.0}) {
                const double first = spec.relative && f > 0 ? top.at[layout.sigma(0)] : 0.0;
                again |= hop(model, top, held, layout.sigma(f), std::log(sigma * spacing) - first);
            }
            for (const double by : {-1.0, -0.5, 0.5, 1.0}) {
                if (layout.shifts(f)) {
                    const std::size_t shift = layout.shift(f);
                    again |= hop(model, top, held, shift, top.at[shift] + by * spacing);
                }
            }
        }
    }
    return top;
}

Maximum highest(const Model& model, const ThurstoneSpec& spec) {
    Maximum top;
    for (const Parameters& start : starts_of(model.layout(), spec)) {
        take_higher(top, climb(model, start));
    }
    return over_hills(model, spec, std::move(top));
}

}  // namespace palpate::data::thurstone
