#include "protocols/procedure/quest.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/math/elementary.hpp"
#include "protocols/psychometric/exact_math.hpp"
#include "protocols/psychometric/psychometric_function.hpp"

namespace palpate::protocols {
namespace {

constexpr double kMaxQuestCells = 200'000;

void need(bool good, std::string_view name, double value, std::string_view wanted) {
    refuse_if(!good, "{} is {}: give {}", name, value, wanted);
}

void check(const QuestSpec& s) {
    const auto positive = [](double v) {
        return std::isfinite(v) && v > 0.0;
    };
    need(std::isfinite(s.guess), "guess", s.guess, "a finite number");
    need(positive(s.sd), "sd", s.sd, "a number above 0");
    need(positive(s.beta), "beta", s.beta, "a number above 0");
    need(s.delta >= 0.0 && s.delta < 1.0, "delta", s.delta, "a share from 0 to below 1");
    need(s.gamma >= 0.0 && s.gamma < 1.0, "gamma", s.gamma, "a share from 0 to below 1");
    need(positive(s.grain), "grain", s.grain, "a number above 0");
    need(positive(s.range) && s.range >= s.grain, "range", s.range, "a number of a grain or more");
    need(s.range / s.grain <= kMaxQuestCells, "range", s.range,
         "at most 200000 grains, or a larger grain");
    need(s.lowest < s.highest, "lowest", s.lowest, "a number below highest");
    need(s.trials > 0, "trials", 0.0, "at least 1");
}

PsychometricFunction function_of(const QuestSpec& spec) {
    return {.family = Family::weibull_log10,
            .form = LapseForm::guessing,
            .threshold = 0.0,
            .slope = spec.beta,
            .guess = spec.gamma,
            .lapse = spec.delta};
}

/// Pelli 1987: the order at which the two answers tell equally much, from the chances far below and
/// far above threshold.
double best_order(double low, double high) {
    constexpr double kTiny = 1e-14;
    const auto term = [](double p) {
        return p * engine::natural_log(p + kTiny) +
               (1.0 - p + kTiny) * engine::natural_log(1.0 - p + kTiny);
    };
    const double best = 1.0 / (1.0 + exponential((term(high) - term(low)) / (low - high)));
    return (best - low) / (high - low);
}

}  // namespace

Quest::Quest(const QuestSpec& spec) : spec_(spec) {
    check(spec_);
    const PsychometricFunction f = function_of(spec_);
    need(spec_.p_threshold > bottom(f) && spec_.p_threshold < top(f), "p_threshold",
         spec_.p_threshold, fmt::format("a chance above {} and below {}", bottom(f), top(f)));
    offset_ = stimulus_at(f, spec_.p_threshold);
    half_ = std::lround(std::ceil(spec_.range / spec_.grain / 2.0 - 1e-9));
    std::vector<double> right;
    for (std::ptrdiff_t i = -2 * half_; i <= 2 * half_; ++i) {
        right.push_back(probability(f, static_cast<double>(i) * spec_.grain + offset_));
    }
    order_ = best_order(right.front(), right.back());
    right_ = std::make_shared<const std::vector<double>>(std::move(right));
    double sum = 0.0;
    for (std::ptrdiff_t i = -half_; i <= half_; ++i) {
        const double z = static_cast<double>(i) * spec_.grain / spec_.sd;
        weights_.push_back(exponential(-0.5 * z * z));
        sum += weights_.back();
    }
    for (double& w : weights_) {
        w /= sum;
    }
}

double Quest::at(std::size_t i) const noexcept {
    return spec_.guess + static_cast<double>(static_cast<std::ptrdiff_t>(i) - half_) * spec_.grain;
}

std::vector<double> Quest::next() const {
    const double x = spec_.rule == QuestRule::mean ? mean()
                   : spec_.rule == QuestRule::mode ? mode()
                                                   : quantile(order_);
    return {std::clamp(x, spec_.lowest, spec_.highest)};
}

void Quest::update(std::span<const double> shown, std::size_t outcome) {
    refuse_if(shown.size() != 1 || !std::isfinite(shown[0]),
              "the stimulus of QUEST is one finite number: give that");
    refuse_if(outcome > 1, "the response is {}: give 0 or 1", outcome);
    // In grains from the guess; far away is the same as at the table's ends.
    const double far = 4.0 * static_cast<double>(half_);
    const auto place = static_cast<std::ptrdiff_t>(
        std::clamp(std::round((shown[0] - spec_.guess) / spec_.grain), -far, far));
    std::vector<double> updated(weights_.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
        const std::ptrdiff_t apart =
            std::clamp(place - (static_cast<std::ptrdiff_t>(i) - half_), -2 * half_, 2 * half_);
        const double p = (*right_)[static_cast<std::size_t>(apart + 2 * half_)];
        updated[i] = weights_[i] * (outcome == 1 ? p : 1.0 - p);
        sum += updated[i];
    }
    refuse_if(
        !(sum > 0.0),
        "the response is impossible under every threshold of the table: give a delta above 0");
    for (double& w : updated) {
        w /= sum;
    }
    weights_ = std::move(updated);
    ++trials_;
}

double Quest::mean() const noexcept {
    double mean = 0.0;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
        mean += weights_[i] * (at(i) - spec_.guess);
    }
    return spec_.guess + mean;
}

double Quest::mode() const noexcept {
    return at(static_cast<std::size_t>(std::ranges::max_element(weights_) - weights_.begin()));
}

double Quest::quantile(double order) const noexcept {
    double below = 0.0;
    double whole = 0.0;
    for (const double w : weights_) {
        whole += w;
    }
    const double wanted = order * whole;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
        const double sum = below + weights_[i];
        if (sum >= wanted && sum > below) {
            const double part = (wanted - below) / (sum - below);
            return i == 0 ? at(0) : at(i - 1) + part * spec_.grain;
        }
        below = sum;
    }
    return at(weights_.size() - 1);
}

std::vector<Estimate> Quest::estimates() const {
    std::vector<Weighed> values;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
        values.emplace_back(at(i), weights_[i]);
    }
    Estimate threshold = belief("threshold", values);
    threshold.mean = mean();
    threshold.mode = mode();
    return {std::move(threshold)};
}

double Quest::entropy() const noexcept {
    return entropy_of(weights_);
}

std::string Quest::state_hash() const {
    StateBytes bytes("palpate-quest-v1");
    bytes.add(std::uint64_t{trials_});
    bytes.add(weights_);
    return bytes.hash();
}

}  // namespace palpate::protocols
