#include "data/choice/thurstone.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "data/statistics/simplex.hpp"

namespace palpate::data {
namespace {

constexpr double kLowest = -std::numeric_limits<double>::infinity();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Below this share of the least distance of two items nothing but lapses is left: sigma is unbounded.
constexpr double kSharp = 0.1;

/// Beyond this many times the items' range an answer tells nothing of the item.
constexpr double kBlunt = 1000.0;
/// A shift beyond this many times the items' range is without end.
constexpr double kFarShift = 20.0;
/// Half the 95 % point of chi-square of 1 df; and what is no loss.
constexpr double kLoss95 = 1.920729410347062;
constexpr double kNoLoss = 1e-3;

/// Two maxima closer than this are one.
constexpr double kSame = 1e-6;

double above(double z) {
    return 0.5 * std::erfc(z * std::numbers::sqrt2 / 2.0);
}

double density(double z) {
    return std::isinf(z) ? 0.0 : std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
}

/// Phi(high) - Phi(low) without loss in either tail.
double between(double low, double high) {
    return low > 0.0 ? above(low) - above(high) : above(-high) - above(-low);
}

double least_distance(const std::vector<double>& items) {
    double least = kInfinite;
    for (std::size_t i = 0; i + 1 < items.size(); ++i) {
        least = std::min(least, items[i + 1] - items[i]);
    }
    return least;
}

/// Ends of ln sigma, or of ln of a ratio of two.
Interval sigma_limits(const ThurstoneSpec& spec, bool ratio) {
    const double range = spec.items.back() - spec.items.front();
    const double sharp = std::log(kSharp * least_distance(spec.items));
    const double blunt = std::log(kBlunt * range);
    return ratio ? Interval{sharp - blunt, blunt - sharp} : Interval{sharp, blunt};
}

/// Which parameters there are: criteria between responses that were given, ln sigma, shifts.
struct Layout {
    std::vector<std::size_t> used{};  ///< responses
    std::size_t conditions = 1;
    bool one_sigma = false;
    bool no_shift = false;

    [[nodiscard]] std::size_t criteria() const { return used.size() - 1; }
    [[nodiscard]] std::size_t sigma(std::size_t condition) const {
        return criteria() + (one_sigma ? 0 : condition);
    }
    [[nodiscard]] std::size_t first_shift() const {
        return criteria() + (one_sigma ? 1 : conditions);
    }
    [[nodiscard]] std::size_t size() const {
        return first_shift() + (no_shift ? 0 : conditions - 1);
    }
};

class Model {
public:
    Model(const std::vector<CallCounts>& counts, const ThurstoneSpec& spec)
        : counts_(counts), spec_(spec) {
        const std::size_t responses = counts.front().front().size();
        for (std::size_t j = 0; j < responses; ++j) {
            const bool given = std::ranges::any_of(counts, [j](const CallCounts& one) {
                return std::ranges::any_of(one, [j](const auto& row) { return row[j] > 0; });
            });
            if (given) {
                layout_.used.push_back(j);
            }
        }
        layout_.conditions = counts.size();
        layout_.one_sigma = spec.one_sigma;
        layout_.no_shift = spec.no_shift;
        for (const CallCounts& one : counts) {
            double& answers = answers_.emplace_back(0.0);
            for (const auto& row : one) {
                for (const std::int64_t n : row) {
                    answers += static_cast<double>(n);
                }
            }
        }
    }

    /// Sigmas stay within a factor of 10,000 of what is as good as 0 and as infinite, but for one that is
    /// held.
    void keep_within(Eigen::VectorXd& at, Eigen::Index held = -1) const {
        const Interval limits = sigma_limits(spec_, false);
        const double wide = std::log(1e4);
        for (std::size_t f = 0; f < (layout_.one_sigma ? 1 : layout_.conditions); ++f) {
            if (index(layout_.sigma(f)) == held) {
                continue;
            }
            double& one = at[index(layout_.sigma(f))];
            const double first = spec_.relative && f > 0 ? at[index(layout_.sigma(0))] : 0.0;
            one = std::clamp(one, limits.low - wide - first, limits.high + wide - first);
        }
    }

    /// Of a condition.
    [[nodiscard]] double answers(std::size_t f) const { return answers_[f]; }

    [[nodiscard]] const Layout& layout() const { return layout_; }

    /// Log-likelihood, and if asked for its gradient and the expected information.
    double value(const Eigen::VectorXd& at,
                 Eigen::VectorXd* gradient = nullptr,
                 Eigen::MatrixXd* information = nullptr) const {
        const auto n = static_cast<Eigen::Index>(layout_.size());
        if (gradient != nullptr) {
            gradient->setZero(n);
            information->setZero(n, n);
        }
        for (std::size_t j = 0; j + 1 < layout_.criteria(); ++j) {
            if (!(at[index(j)] < at[index(j + 1)])) {
                return kLowest;
            }
        }
        double sum = 0.0;
        for (std::size_t f = 0; f < counts_.size(); ++f) {
            for (std::size_t i = 0; i < spec_.items.size(); ++i) {
                sum += row_value(at, f, i, gradient, information);
            }
        }
        return std::isfinite(sum) ? sum : kLowest;
    }

    /// P(response of place j) of an item.
    [[nodiscard]] double share(const Eigen::VectorXd& at,
                               std::size_t f,
                               std::size_t i,
                               std::size_t j) const {
        const auto m = static_cast<double>(counts_.front().front().size());
        return (1.0 - spec_.lapse) * between(edge(at, f, i, j), edge(at, f, i, j + 1)) +
               spec_.lapse / m;
    }

    [[nodiscard]] double sigma(const Eigen::VectorXd& at, std::size_t f) const {
        const bool ratio = spec_.relative && f > 0;
        return std::exp(at[index(layout_.sigma(f))] + (ratio ? at[index(layout_.sigma(0))] : 0.0));
    }

private:
    static Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }

    [[nodiscard]] double shift(const Eigen::VectorXd& at, std::size_t f) const {
        return f == 0 || layout_.no_shift ? 0.0 : at[index(layout_.first_shift() + f - 1)];
    }
    /// z of the lower end of place j; j = responses in use: of the last one's upper end.
    [[nodiscard]] double edge(const Eigen::VectorXd& at,
                              std::size_t f,
                              std::size_t i,
                              std::size_t j) const {
        return j == 0 ? -kInfinite
             : j > layout_.criteria()
                 ? kInfinite
                 : (at[index(j - 1)] - spec_.items[i] - shift(at, f)) / sigma(at, f);
    }

    double row_value(const Eigen::VectorXd& at,
                     std::size_t f,
                     std::size_t i,
                     Eigen::VectorXd* gradient,
                     Eigen::MatrixXd* information) const {
        const std::vector<std::int64_t>& row = counts_[f][i];
        double total = 0.0;
        for (const std::int64_t one : row) {
            total += static_cast<double>(one);
        }
        const double scale = (1.0 - spec_.lapse) / sigma(at, f);
        double sum = 0.0;
        for (std::size_t j = 0; j < layout_.used.size() && total > 0.0; ++j) {
            const auto given = static_cast<double>(row[layout_.used[j]]);
            const double p = share(at, f, i, j);
            sum += given > 0.0 ? given * std::log(p) : 0.0;
            if (gradient == nullptr || !(p > 0.0)) {
                continue;
            }
            const double low = edge(at, f, i, j);
            const double high = edge(at, f, i, j + 1);
            Eigen::VectorXd slope = Eigen::VectorXd::Zero(index(layout_.size()));
            if (j < layout_.criteria()) {
                slope[index(j)] += scale * density(high);
            }
            if (j > 0) {
                slope[index(j - 1)] -= scale * density(low);
            }
            const auto pull = [](double z) {
                return std::isinf(z) ? 0.0 : z * density(z);
            };
            const double pulled = (1.0 - spec_.lapse) * (pull(high) - pull(low));
            slope[index(layout_.sigma(f))] -= pulled;
            if (spec_.relative && f > 0) {
                slope[index(layout_.sigma(0))] -= pulled;
            }
            if (f > 0 && !layout_.no_shift) {
                slope[index(layout_.first_shift() + f - 1)] -=
                    scale * (density(high) - density(low));
            }
            *gradient += (given / p) * slope;
            *information += (total / p) * slope * slope.transpose();
        }
        return sum;
    }

    const std::vector<CallCounts>& counts_;
    const ThurstoneSpec& spec_;
    Layout layout_{};
    std::vector<double> answers_{};
};

struct Maximum {
    Eigen::VectorXd at;
    double value = kLowest;
};

/// @param held  a parameter that stays; -1: none
Maximum climb(const Model& model, Eigen::VectorXd start, Eigen::Index held = -1) {
    Eigen::VectorXd gradient;
    Eigen::MatrixXd information;
    const auto derivatives = [&](const Eigen::VectorXd& at) {
        const double value = model.value(at, &gradient, &information);
        if (held >= 0) {
            gradient[held] = 0.0;
            information.row(held).setZero();
            information.col(held).setZero();
            information(held, held) = 1.0;
        }
        return value;
    };
    Maximum best{std::move(start), kLowest};
    best.value = derivatives(best.at);
    double damping = 0.0;
    for (int step = 0; step < 300 && std::isfinite(best.value); ++step) {
        Eigen::MatrixXd damped = information;
        damped.diagonal() += damping * information.diagonal();
        damped.diagonal().array() += 1e-12 * (1.0 + information.trace());
        const Eigen::VectorXd move = damped.ldlt().solve(gradient);
        const double promised = move.dot(gradient);
        Maximum next{best.at + move, kLowest};
        if (move.allFinite()) {
            model.keep_within(next.at, held);
            next.value = model.value(next.at);
        }
        if (next.value >= best.value) {
            const bool settled = promised < 1e-13 || next.value - best.value < 1e-13;
            best = std::move(next);
            static_cast<void>(derivatives(best.at));
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

/// Criteria spread evenly over the items, and this sigma.
Eigen::VectorXd start_at(const Layout& layout, const ThurstoneSpec& spec, double sigma) {
    Eigen::VectorXd at = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(layout.size()));
    const double range = spec.items.back() - spec.items.front();
    for (std::size_t j = 0; j < layout.criteria(); ++j) {
        at[static_cast<Eigen::Index>(j)] =
            spec.items.front() +
            range * (static_cast<double>(j) + 0.5) / static_cast<double>(layout.criteria());
    }
    for (std::size_t f = 0; f < layout.conditions; ++f) {
        at[static_cast<Eigen::Index>(layout.sigma(f))] =
            spec.relative && f > 0 ? 0.0 : std::log(sigma);
    }
    return at;
}

std::vector<Eigen::VectorXd> starts_of(const Layout& layout, const ThurstoneSpec& spec) {
    std::vector<Eigen::VectorXd> all;
    for (const double sigma : {0.4, 1.0, 3.0}) {
        all.push_back(start_at(layout, spec, sigma * least_distance(spec.items)));
    }
    return all;
}

void check(const std::vector<CallCounts>& counts, const ThurstoneSpec& spec) {
    if (!(spec.lapse >= 0.0 && spec.lapse <= 0.25)) {
        throw std::invalid_argument(
            fmt::format("the lapse rate is {}: give a share from 0 to 0.25", spec.lapse));
    }
    for (std::size_t i = 0; i + 1 < spec.items.size(); ++i) {
        if (!(spec.items[i] < spec.items[i + 1])) {
            throw std::invalid_argument(
                fmt::format("items have the values {} and {}: give each its own, in order",
                            spec.items[i], spec.items[i + 1]));
        }
    }
    if (spec.items.size() < 2 || counts.empty()) {
        throw std::invalid_argument("there are fewer than two items to tell apart");
    }
}

/// What holding one parameter elsewhere costs, walked from the maximum outward.
class Profile {
public:
    Profile(const Model& model,
            const Maximum& top,
            const std::vector<Eigen::VectorXd>& starts,
            std::size_t parameter)
        : model_(model),
          top_(top),
          starts_(starts),
          parameter_(static_cast<Eigen::Index>(parameter)) {}

    struct Edge {
        std::optional<double> at{};  ///< where the loss is that of 95 %; nothing: it never is
        double loss = 0.0;           ///< where the walk ended
    };

    /// From the maximum to `end`, or to where the loss is too large.
    Edge edge(double step, double end) {
        near_ = top_.at;
        const double start = top_.at[parameter_];
        double left = start;
        double loss_left = 0.0;
        const double sign = step < 0.0 ? -1.0 : 1.0;
        if (sign * (end - start) <= 0.0) {
            return {};
        }
        for (double way = std::fabs(step);; way *= 1.7) {
            const double right = sign * std::min(sign * (start + sign * way), sign * end);
            const double loss = loss_at(right);
            if (loss >= kLoss95) {
                return {between_edges(left, loss_left, right, loss), loss};
            }
            if (right == end) {
                return {std::nullopt, loss};
            }
            left = right;
            loss_left = loss;
        }
    }

private:
    double loss_at(double place) {
        near_[parameter_] = place;
        Maximum found = climb(model_, near_, parameter_);
        if (top_.value - found.value >= kLoss95) {  // a walk may end on a lower hill
            for (Eigen::VectorXd start : starts_) {
                start[parameter_] = place;
                Maximum other = climb(model_, std::move(start), parameter_);
                if (other.value > found.value) {
                    found = std::move(other);
                }
            }
        }
        near_ = std::move(found.at);
        return std::max(top_.value - found.value, 0.0);
    }

    /// The root of the loss is nearly a straight line: false position on it, halving at times.
    double between_edges(double left, double loss_left, double right, double loss_right) {
        const double wanted = std::sqrt(kLoss95);
        double low = std::sqrt(loss_left);
        double high = std::sqrt(loss_right);
        for (int i = 0; i < 40; ++i) {
            const double t =
                i % 4 == 3 ? 0.5 : std::clamp((wanted - low) / (high - low), 0.02, 0.98);
            const double middle = left + t * (right - left);
            const double here = std::sqrt(loss_at(middle));
            if (std::fabs(here - wanted) < 1e-6) {
                return middle;
            }
            (here < wanted ? left : right) = middle;
            (here < wanted ? low : high) = here;
        }
        return 0.5 * (left + right);
    }

    const Model& model_;
    const Maximum& top_;
    const std::vector<Eigen::VectorXd>& starts_;
    Eigen::Index parameter_;
    Eigen::VectorXd near_{};
};

void add_intervals(ThurstoneFit& fit,
                   const Model& model,
                   const Maximum& top,
                   const ThurstoneSpec& spec) {
    const Layout& layout = model.layout();
    const double range = spec.items.back() - spec.items.front();
    std::vector<Eigen::VectorXd> starts = starts_of(layout, spec);
    starts.push_back(top.at);
    for (std::size_t f = 0; f < layout.conditions; ++f) {
        ThurstonePart& part = fit.parts[f];
        const Interval limits = sigma_limits(spec, spec.relative && f > 0);
        Profile sigma(model, top, starts, layout.sigma(f));
        const Profile::Edge low = sigma.edge(-0.4, limits.low);
        const Profile::Edge high = sigma.edge(0.4, limits.high);
        const double at = top.at[static_cast<Eigen::Index>(layout.sigma(f))];
        const bool sharp = !low.at && (low.loss < kNoLoss || at < limits.low);
        const bool blunt = !high.at && (high.loss < kNoLoss || at > limits.high);
        part.end = model.answers(f) == 0.0 || (sharp && blunt) ? SigmaEnd::untold
                 : sharp                                       ? SigmaEnd::sharp
                 : blunt                                       ? SigmaEnd::blunt
                                                               : SigmaEnd::both;
        part.sigma_interval =
            Interval{low.at ? std::exp(*low.at) : 0.0, high.at ? std::exp(*high.at) : kInfinite};
        if (f > 0 && !layout.no_shift) {
            Profile shift(model, top, starts, layout.first_shift() + f - 1);
            const double step = 0.1 * range;
            const Profile::Edge down = shift.edge(-step, -kFarShift * range);
            const Profile::Edge up = shift.edge(step, kFarShift * range);
            part.shift_interval = Interval{down.at.value_or(-kInfinite), up.at.value_or(kInfinite)};
        }
    }
}

/// Of shares that are free, and how many of them are.
void add_deviance(ThurstoneFit& fit, const std::vector<CallCounts>& counts, const Layout& layout) {
    double saturated = 0.0;
    for (const CallCounts& one : counts) {
        for (const auto& row : one) {
            double total = 0.0;
            for (const std::int64_t n : row) {
                total += static_cast<double>(n);
            }
            for (const std::int64_t n : row) {
                const auto k = static_cast<double>(n);
                saturated += n > 0 ? k * std::log(k / total) : 0.0;
            }
            fit.df += total > 0.0 ? static_cast<std::int64_t>(row.size()) - 1 : 0;
        }
    }
    fit.df -= static_cast<std::int64_t>(layout.size());
    fit.deviance = 2.0 * (saturated - fit.log_likelihood);
}

}  // namespace

ThurstoneFit fit_thurstone(const std::vector<CallCounts>& counts, const ThurstoneSpec& spec) {
    check(counts, spec);
    const Model model(counts, spec);
    const Layout& layout = model.layout();
    if (layout.used.size() < 2) {
        throw std::invalid_argument("every answer is the same response: nothing is told apart");
    }
    const double spacing = least_distance(spec.items);
    Maximum top;
    for (const Eigen::VectorXd& start : starts_of(layout, spec)) {
        Maximum found = climb(model, start);
        if (found.value > top.value) {
            top = std::move(found);
        }
    }
    ThurstoneFit fit{.log_likelihood = top.value, .second = std::nan("")};
    if (spec.checked) {
        std::vector<double> start(top.at.data(), top.at.data() + top.at.size());
        const Eigen::VectorXd rough = start_at(layout, spec, spacing);
        std::copy(rough.data(), rough.data() + rough.size(), start.begin());
        std::vector<double> edge(start.size(), 0.3 * spacing);
        for (std::size_t f = 0; f < layout.conditions; ++f) {
            edge[layout.sigma(f)] = 0.3;
        }
        const auto place_of = [&](std::span<const double> at) {
            Eigen::VectorXd place =
                Eigen::Map<const Eigen::VectorXd>(at.data(), static_cast<Eigen::Index>(at.size()));
            model.keep_within(place);
            return place;
        };
        const Summit second = simplex_maximum(
            [&](std::span<const double> at) { return model.value(place_of(at)); }, start, edge);
        fit.second = second.value;
        fit.agree = std::fabs(fit.second - top.value) < kSame;
        if (second.value > top.value) {
            Maximum again = climb(model, place_of(second.at));
            top = again.value > second.value ? std::move(again)
                                             : Maximum{place_of(second.at), second.value};
            fit.log_likelihood = top.value;
        }
    }
    std::size_t given = 0;  // of the responses up to j
    for (std::size_t j = 0; j + 1 < counts.front().front().size(); ++j) {
        if (given < layout.used.size() && layout.used[given] == j) {
            ++given;
        }
        fit.criteria.push_back(given == 0 ? -kInfinite
                               : given == layout.used.size()
                                   ? kInfinite
                                   : top.at[static_cast<Eigen::Index>(given - 1)]);
    }
    for (std::size_t f = 0; f < layout.conditions; ++f) {
        ThurstonePart part;
        part.sigma = model.sigma(top.at, f);
        part.shift = f == 0 || layout.no_shift
                       ? 0.0
                       : top.at[static_cast<Eigen::Index>(layout.first_shift() + f - 1)];
        fit.parts.push_back(part);
    }
    if (spec.intervals) {
        add_intervals(fit, model, top, spec);
    }
    add_deviance(fit, counts, layout);
    return fit;
}

std::vector<std::vector<double>> thurstone_shares(const ThurstoneFit& fit,
                                                  const ThurstoneSpec& spec,
                                                  std::size_t condition) {
    const ThurstonePart& part = fit.parts.at(condition);
    const std::size_t m = fit.criteria.size() + 1;
    std::vector<std::vector<double>> shares;
    for (const double item : spec.items) {
        const auto z = [&](double criterion) {
            return (criterion - item - part.shift) / part.sigma;
        };
        std::vector<double>& row = shares.emplace_back();
        for (std::size_t j = 0; j < m; ++j) {
            const double low = j == 0 ? -kInfinite : z(fit.criteria[j - 1]);
            const double high = j + 1 == m ? kInfinite : z(fit.criteria[j]);
            row.push_back((1.0 - spec.lapse) * between(low, high) +
                          spec.lapse / static_cast<double>(m));
        }
    }
    return shares;
}

}  // namespace palpate::data
