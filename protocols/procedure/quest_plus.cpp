#include "protocols/procedure/quest_plus.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <mutex>
#include <ranges>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "protocols/psychometric/exact_math.hpp"
#include "protocols/psychometric/psychometric_function.hpp"

namespace palpate::protocols {
namespace {

/// sum a_i b_i in eight strands, each in order: one fixed result, and work for every unit of a
/// processor.
double dot(std::span<const double> a, std::span<const double> b) noexcept {
    constexpr std::size_t kStrands = 8;
    if (a.size() == 1) {
        return a[0] * b[0];
    }
    std::array<double, kStrands> strand{};
    const std::size_t whole = a.size() - a.size() % kStrands;
    for (std::size_t i = 0; i < whole; i += kStrands) {
        for (std::size_t k = 0; k < kStrands; ++k) {
            strand[k] += a[i + k] * b[i + k];
        }
    }
    for (std::size_t i = whole; i < a.size(); ++i) {
        strand[i - whole] += a[i] * b[i];
    }
    return ((strand[0] + strand[4]) + (strand[2] + strand[6])) +
           ((strand[1] + strand[5]) + (strand[3] + strand[7]));
}

constexpr double kLargeTable = 50.0;  ///< MB: half a second and more
constexpr double kSame = 1e-12;       ///< of entropies in bits, and of weights

std::vector<double> normalised(std::span<const double> weights, const Axis& axis) {
    if (weights.empty()) {
        return std::vector<double>(axis.values.size(),
                                   1.0 / static_cast<double>(axis.values.size()));
    }
    double sum = 0.0;
    for (const double w : weights) {
        refuse_if(!std::isfinite(w) || w < 0.0,
                  "the prior of {} has the weight {}: give finite numbers from 0 up", axis.name, w);
        sum += w;
    }
    refuse_if(weights.size() != axis.values.size() || !(sum > 0.0) || !std::isfinite(sum),
              "the prior of {} has {} weights with the sum {}: give {}, one for each value, not "
              "all of them 0",
              axis.name, weights.size(), sum, axis.values.size());
    std::vector<double> shares(weights.begin(), weights.end());
    for (double& w : shares) {
        w /= sum;
    }
    return shares;
}

}  // namespace

/// Which combination of the wanted parameters each cell has.
struct CellGroups {
    std::vector<std::uint32_t> of;  ///< of every cell, below `count`
    std::size_t count = 0;
    std::size_t run = 1;  ///< cells run * i ... run * i + run - 1 share one, for every i
};

namespace {

/// Groups of the cells that differ in nothing but `nuisance`.
/// @throws std::invalid_argument for a nuisance that is no axis, or if nothing else is left
CellGroups groups_of(const Grid& parameters, std::span<const std::string> nuisance) {
    const auto is_nuisance = [nuisance](const Axis& axis) {
        return std::ranges::find(nuisance, axis.name) != nuisance.end();
    };
    for (const std::string& name : nuisance) {
        const auto axes = parameters.axes();
        refuse_if(std::ranges::find(axes, name, &Axis::name) == axes.end(),
                  "nuisance {} is no parameter of the model: delete it", name);
    }
    CellGroups groups{.of = std::vector<std::uint32_t>(parameters.size()), .count = 1};
    bool any = false;
    for (std::size_t k = 0; k < parameters.dimensions(); ++k) {
        const std::size_t size = parameters.axis(k).values.size();
        if (is_nuisance(parameters.axis(k))) {
            groups.run *= size;
            continue;
        }
        any = true;
        groups.run = 1;  // only nuisance axes behind the last wanted one make runs
        groups.count *= size;
        for (std::size_t cell = 0; cell < parameters.size(); ++cell) {
            groups.of[cell] =
                static_cast<std::uint32_t>(groups.of[cell] * size + parameters.index(cell, k));
        }
    }
    refuse_if(!any, "nuisance names every parameter: leave one out of the list");
    return groups;
}

/// expected_entropies() of the posterior of some parameters alone, the others (nuisance) summed out
/// before the entropy is taken (Prins 2013, "the psi-marginal adaptive method").
std::vector<double> expected_marginal_entropies(const LikelihoodTable& table,
                                                std::span<const double> weights,
                                                const CellGroups& groups) {
    std::vector<double> expected(table.stimuli().size());
    std::vector<double> joint(groups.count);  // P(r, group | x)
    for (std::size_t x = 0; x < expected.size(); ++x) {
        for (std::size_t r = 0; r < table.outcomes(); ++r) {
            std::fill(joint.begin(), joint.end(), 0.0);
            const std::span<const double> chances = table.chances(x, r);
            for (std::size_t c = 0; c < weights.size(); c += groups.run) {
                joint[groups.of[c]] +=
                    dot(weights.subspan(c, groups.run), chances.subspan(c, groups.run));
            }
            double sum = 0.0;
            for (const double p : joint) {
                sum += p;
                expected[x] -= p_log_p(p);
            }
            expected[x] += p_log_p(sum);
        }
    }
    return expected;
}

std::function<void(double)> told_of_tables;

bool made_of(const LikelihoodTable& table, const QuestPlusSpec& spec) {
    return std::ranges::equal(table.stimuli().axes(), spec.stimuli.axes()) &&
           std::ranges::equal(table.parameters().axes(), spec.parameters.axes());
}

/// The newest table is kept: whoever reads a protocol, plans with it and reads it again from a
/// database wants the same one, and a large one takes long.
std::shared_ptr<const LikelihoodTable> table_of(const QuestPlusSpec& spec) {
    static std::mutex mutex;
    static std::shared_ptr<const LikelihoodTable> newest;
    static std::string model;
    const std::scoped_lock lock(mutex);
    if (!newest || model.empty() || model != spec.model.same || !made_of(*newest, spec)) {
        newest.reset();  // two of them may be too much
        const double size = LikelihoodTable::megabytes(spec.model, spec.stimuli, spec.parameters);
        if (told_of_tables && size > kLargeTable && size * 1e6 <= kMaxBytes) {
            told_of_tables(size);
        }
        newest = std::make_shared<const LikelihoodTable>(spec.model, spec.stimuli, spec.parameters);
        model = spec.model.same;
    }
    return newest;
}

}  // namespace

void announce_large_tables(std::function<void(double megabytes)> told) {
    told_of_tables = std::move(told);
}

std::vector<double> expected_entropies(const LikelihoodTable& table,
                                       std::span<const double> weights) {
    const double now = entropy_of(weights);
    std::vector<double> expected(table.stimuli().size());
    for (std::size_t x = 0; x < expected.size(); ++x) {
        double predicted = 0.0;  // H(R|x)
        double rest = 1.0;
        for (std::size_t r = 0; r + 1 < table.outcomes(); ++r) {
            const double chance = dot(weights, table.chances(x, r));
            predicted -= p_log_p(chance);
            rest -= chance;
        }
        predicted -= p_log_p(rest);
        expected[x] = now - (predicted - dot(weights, table.outcome_entropy(x)));
    }
    return expected;
}

std::size_t first_of_least(std::span<const double> entropies) noexcept {
    const double least = *std::ranges::min_element(entropies);
    const double max = least + kSame * std::max(1.0, std::fabs(least));
    const auto first =
        std::ranges::find_if(entropies, [max](double entropy) { return entropy <= max; });
    return static_cast<std::size_t>(first - entropies.begin());
}

QuestPlus::QuestPlus(const QuestPlusSpec& spec)
    : table_(table_of(spec)),
      shape_(spec.model.shape),
      posterior_(spec.parameters, spec.prior),
      max_trials_(spec.trials),
      entropy_bits_(spec.entropy_bits) {
    if (!spec.nuisance.empty()) {
        groups_ = std::make_shared<const CellGroups>(groups_of(spec.parameters, spec.nuisance));
    }
    refuse_if(spec.trials == 0, "there are 0 trials: give at least 1");
}

std::vector<double> QuestPlus::expected() const {
    return groups_ == nullptr
             ? expected_entropies(*table_, posterior_.weights())
             : expected_marginal_entropies(*table_, posterior_.weights(), *groups_);
}

std::vector<double> QuestPlus::next() const {
    return table_->stimuli().point(first_of_least(expected()));
}

void QuestPlus::update(std::span<const double> shown, std::size_t outcome) {
    refuse_if(outcome >= outcomes(), "the response is {}: give 0 to {}", outcome, outcomes() - 1);
    posterior_.update(table_->chances(table_->stimuli().cell_at(shown), outcome));
    ++trials_;
}

bool QuestPlus::finished() const noexcept {
    return trials_ >= max_trials_ || (entropy_bits_ > 0.0 && entropy() < entropy_bits_);
}

std::vector<std::string> QuestPlus::stimulus_names() const {
    const auto names = std::views::transform(table_->stimuli().axes(), &Axis::name);
    return {names.begin(), names.end()};
}

std::vector<Estimate> QuestPlus::estimates() const {
    const Grid& grid = table_->parameters();
    const std::vector<double> means = posterior_.mean(grid);
    const std::vector<double> modes = posterior_.mode(grid);
    std::vector<Estimate> free;
    for (std::size_t k = 0; k < grid.dimensions(); ++k) {
        if (grid.axis(k).values.size() > 1 || grid.size() == 1) {
            const std::vector<double> shares = posterior_.marginal(grid, k);
            std::vector<Weighed> values;
            for (std::size_t i = 0; i < shares.size(); ++i) {
                values.emplace_back(grid.axis(k).values[i], shares[i]);
            }
            free.push_back(belief(grid.axis(k).name, values));
            free.back().mean = means[k];
            free.back().mode = modes[k];
        }
    }
    return free;
}

std::optional<Estimate> QuestPlus::jnd() const {
    const Grid& grid = table_->parameters();
    if (!shape_ || grid.axis(0).values.size() * grid.axis(1).values.size() == 1) {
        return std::nullopt;
    }
    const std::vector<double>& slopes = grid.axis(1).values;
    std::vector<Weighed> values(grid.axis(0).values.size() * slopes.size());
    for (std::size_t cell = 0; cell < values.size(); ++cell) {
        const double threshold = grid.axis(0).values[cell / slopes.size()];
        const double slope = slope_of(shape_->slope_as, slopes[cell % slopes.size()]);
        values[cell].first = 0.5 * (core_inverse(shape_->family, 0.75, threshold, slope) -
                                    core_inverse(shape_->family, 0.25, threshold, slope));
    }
    for (std::size_t cell = 0; cell < grid.size(); ++cell) {
        values[grid.index(cell, 0) * slopes.size() + grid.index(cell, 1)].second +=
            posterior_.weights()[cell];
    }
    std::ranges::sort(values);
    return belief("JND", values);
}

std::string QuestPlus::state_hash() const {
    StateBytes bytes("palpate-quest-plus-v1");
    bytes.add(std::uint64_t{trials_});
    bytes.add(posterior_.weights());
    return bytes.hash();
}

Posterior::Posterior(const Grid& grid, std::span<const std::vector<double>> axis_weights)
    : weights_(grid.size(), 1.0) {
    refuse_if(axis_weights.size() > grid.dimensions(),
              "there are priors for {} parameters: give {}", axis_weights.size(),
              grid.dimensions());
    for (std::size_t k = 0; k < grid.dimensions(); ++k) {
        const std::vector<double> shares =
            normalised(k < axis_weights.size() ? std::span<const double>(axis_weights[k])
                                               : std::span<const double>{},
                       grid.axis(k));
        for (std::size_t cell = 0; cell < weights_.size(); ++cell) {
            weights_[cell] *= shares[grid.index(cell, k)];
        }
    }
}

void Posterior::update(std::span<const double> likelihood) {
    double sum = 0.0;
    for (std::size_t cell = 0; cell < weights_.size(); ++cell) {
        sum += weights_[cell] * likelihood[cell];
    }
    refuse_if(!(sum > 0.0),
              "the response is impossible under every parameter of the grid: give lapse or guess "
              "rates above 0, or check the response");
    for (std::size_t cell = 0; cell < weights_.size(); ++cell) {
        weights_[cell] = weights_[cell] * likelihood[cell] / sum;
    }
}

double Posterior::entropy() const noexcept {
    return entropy_of(weights_);
}

std::vector<double> Posterior::marginal(const Grid& grid, std::size_t k) const {
    std::vector<double> shares(grid.axis(k).values.size());
    for (std::size_t cell = 0; cell < weights_.size(); ++cell) {
        shares[grid.index(cell, k)] += weights_[cell];
    }
    return shares;
}

std::vector<double> Posterior::mean(const Grid& grid) const {
    std::vector<double> means(grid.dimensions());
    for (std::size_t k = 0; k < means.size(); ++k) {
        const std::vector<double> shares = marginal(grid, k);
        const std::vector<double>& values = grid.axis(k).values;
        // From the first value on, so that a parameter of a single value keeps it to the bit.
        for (std::size_t i = 1; i < values.size(); ++i) {
            means[k] += shares[i] * (values[i] - values[0]);
        }
        means[k] += values[0];
    }
    return means;
}

std::vector<double> Posterior::mode(const Grid& grid) const {
    const double max = *std::ranges::max_element(weights_);
    const auto first =
        std::ranges::find_if(weights_, [max](double w) { return w >= max * (1.0 - kSame); });
    return grid.point(static_cast<std::size_t>(first - weights_.begin()));
}

Estimate belief(std::string name, std::span<const Weighed> values) {
    constexpr double kTail = 0.025;
    Estimate made{.name = std::move(name), .mean = 0.0, .mode = std::nullopt};
    double below = 0.0;
    for (const auto& [value, share] : values) {
        *made.mean += share * value;
        below += share;
        if (!made.low && below >= kTail) {
            made.low = value;
        }
        if (!made.high && below >= 1.0 - kTail) {
            made.high = value;
        }
    }
    double square = 0.0;
    for (const auto& [value, share] : values) {
        square += share * (value - *made.mean) * (value - *made.mean);
    }
    made.sd = std::sqrt(square);
    made.high = made.high.value_or(values.back().first);
    // The same end by another way differs in its last bits.
    const double same = 1e-9 * (values.back().first - values.front().first);
    made.cut = *made.low <= values.front().first + same || *made.high >= values.back().first - same;
    return made;
}

}  // namespace palpate::protocols
