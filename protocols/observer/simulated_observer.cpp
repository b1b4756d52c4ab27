#include "protocols/observer/simulated_observer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "protocols/design/object_outline.hpp"
#include "protocols/observer/draws.hpp"

namespace palpate::protocols {
namespace {

/// Felt friction above which one says that there is some: strokes on a frictionless object feel 0.
constexpr double kFrictionSeen = 0.05;

double reaction_time(Pcg32& random) noexcept {
    const double decision = 0.8 + 0.15 * normal_draw(random);
    return std::max(0.25, decision + 0.7 * exponential_draw(random));
}

}  // namespace

SimulatedObserver::SimulatedObserver(const Protocol& protocol,
                                     StreamKey key,
                                     const std::vector<std::size_t>& picture_order,
                                     std::function<bool()> hand_is_done)
    : outline_(protocol.outline),
      spec_(protocol.observer),
      key_(std::move(key)),
      asked_mu_(protocol.procedure && protocol.procedure->varies == Varies::mu),
      criterion_(asked_mu_ ? kFrictionSeen : 0.0),
      hand_is_done_(std::move(hand_is_done)),
      cues_{CurvatureCues(protocol.outline)} {
    key_.purpose = "observer";
    for (const std::size_t object : picture_order) {
        curvatures_.push_back(protocol.objects.at(object).curvature);
    }
    if (!differ_in_curvature_alone(protocol)) {
        shapes_.emplace(protocol, picture_order);
        const double chord = glm::length(protocol.outline.vertex - protocol.outline.a);
        blur_ = spec_.noise * chord * chord / 8.0;
    }
    for (const ObjectSpec& object : protocol.objects) {
        lowest_ = asked_mu_ ? 0.0 : std::min(lowest_, object.curvature);
        highest_ = asked_mu_ ? highest_ : std::max(highest_, object.curvature);
    }
    for (const FrictionSpec& friction : protocol.frictions) {
        highest_ = asked_mu_ ? std::max(highest_, friction.mu_d) : highest_;
    }
}

Signal SimulatedObserver::welcome(const SessionView& /*session*/) {
    return Signal::go_on;
}

Signal SimulatedObserver::ready(const TrialView& trial) {
    if (trial.interval == 1) {
        cues_.clear();
    }
    cues_.emplace_back(outline_);
    if (shapes_) {
        shapes_->forget();
    }
    percept_.reset();
    return Signal::go_on;
}

Exploring SimulatedObserver::explore(const TrialView& trial, double elapsed_s) {
    const bool done = elapsed_s >= trial.explore_min_s && hand_is_done_();
    return {.signal = done ? Signal::done : Signal::go_on, .at_s = elapsed_s};
}

void SimulatedObserver::feel(std::span<const engine::TickRecord> ticks) {
    if (shapes_) {
        shapes_->add(ticks);
    } else {
        cues_.back().add(ticks);
    }
}

Choice SimulatedObserver::choose(const TrialView& trial, const Question& question) {
    key_.block = trial.done + 1;
    Pcg32 random = stream(key_);
    const bool lapse = uniform_draw(random) < spec_.lapse;
    const double noise = normal_draw(random);
    const auto any =
        random.bounded(static_cast<std::uint32_t>(std::max<std::size_t>(question.answers, 1)));

    Choice choice{.place = any, .reaction_s = reaction_time(random)};
    const bool by_shape = shapes_ && question.kind == ResponseKind::identification;
    const std::optional<std::size_t> named = !by_shape       ? answer(question, noise, random)
                                           : shapes_->felt() ? std::optional(best_fit(random))
                                                             : std::nullopt;
    if (named && !lapse) {
        choice.place = *named;
    }
    if (question.confidence) {
        choice.confidence = named ? confidence() : 1;
        choice.confidence_reaction_s = reaction_time(random);
    }
    if (question.confirm) {  // at once: it never changes its mind
        const auto at_once = [](double s) {
            return Confirmation{.first_choice_s = s, .confirmed_s = s};
        };
        choice.confirmation = at_once(choice.reaction_s);
        if (choice.confidence) {
            choice.confidence_confirmation = at_once(choice.confidence_reaction_s);
        }
    }
    return choice;
}

/// What the percepts say; nothing without any. @param noise  N(0, 1) of the first percept
std::optional<std::size_t> SimulatedObserver::answer(const Question& question,
                                                     double noise,
                                                     Pcg32& random) {
    percept_ = percept_of(cues_.front(), noise);
    if (!percept_) {
        return std::nullopt;
    }
    switch (question.kind) {
        case ResponseKind::identification:
            distance_ = to_criterion(*percept_);
            return nearest_place(*percept_);
        case ResponseKind::two_interval: {
            const auto second = percept_of(cues_.back(), normal_draw(random));
            if (!second) {
                return std::nullopt;
            }
            distance_ = *second - *percept_;
            return distance_ > 0.0 ? 1 : 0;
        }
        case ResponseKind::yes_no:
            distance_ = *percept_ - criterion_;
            return distance_ > 0.0 ? 1 : 0;
        case ResponseKind::rating:
            break;
    }
    const auto levels = static_cast<double>(question.answers);
    const double share = highest_ > lowest_ ? (*percept_ - lowest_) / (highest_ - lowest_) : 0.0;
    const double level = std::clamp(std::floor(share * levels), 0.0, levels - 1.0);
    distance_ = (0.5 - std::fabs(share * levels - level - 0.5)) * (highest_ - lowest_) / levels;
    return static_cast<std::size_t>(level);
}

int SimulatedObserver::confidence() const noexcept {
    const double noise = asked_mu_ ? spec_.noise_mu : spec_.noise;
    const double far = std::fabs(distance_);
    return 1 + (far >= 0.5 * noise ? 1 : 0) + (far >= noise ? 1 : 0) + (far >= 2.0 * noise ? 1 : 0);
}

Signal SimulatedObserver::gap(double /*seconds*/) {
    return Signal::go_on;
}

Signal SimulatedObserver::rest(double /*seconds*/, const TrialView& /*next*/) {
    return Signal::go_on;
}

void SimulatedObserver::finish(const SessionView& /*session*/) {}

std::optional<double> SimulatedObserver::percept_of(const CurvatureCues& cues,
                                                    double noise) const noexcept {
    const Cues felt = cues.cues();
    if (asked_mu_) {
        return felt.force || felt.position ? std::optional(felt.friction + spec_.noise_mu * noise)
                                           : std::nullopt;
    }
    if (!felt.force && !felt.position) {
        return std::nullopt;
    }
    const double force = felt.force.value_or(felt.position.value_or(0.0));
    const double position = felt.position.value_or(force);
    return spec_.force_weight * force + (1.0 - spec_.force_weight) * position +
           spec_.bias_per_mu * felt.friction + spec_.noise * noise;
}

/// How far a curvature is from where the next picture would be named, 1/m.
double SimulatedObserver::to_criterion(double curvature) const noexcept {
    double nearest = std::numeric_limits<double>::infinity();
    double second = nearest;
    for (const double pictured : curvatures_) {
        const double far = std::fabs(pictured - curvature);
        second = std::min(second, std::max(nearest, far));
        nearest = std::min(nearest, far);
    }
    return 0.5 * (second - nearest);
}

std::size_t SimulatedObserver::best_fit(Pcg32& random) {
    std::vector<double> misfits = shapes_->misfits();
    for (double& misfit : misfits) {
        misfit += blur_ * normal_draw(random);
    }
    const auto best = std::min_element(misfits.begin(), misfits.end());
    double second = std::numeric_limits<double>::infinity();
    for (auto other = misfits.begin(); other != misfits.end(); ++other) {
        second = other == best ? second : std::min(second, *other);
    }
    distance_ = blur_ > 0.0 ? spec_.noise * (second - *best) / blur_ : second - *best;
    return static_cast<std::size_t>(std::distance(misfits.begin(), best));
}

std::size_t SimulatedObserver::nearest_place(double curvature) const noexcept {
    const auto nearest = std::min_element(
        curvatures_.begin(), curvatures_.end(),
        [&](double a, double b) { return std::fabs(a - curvature) < std::fabs(b - curvature); });
    return static_cast<std::size_t>(nearest - curvatures_.begin());
}

}  // namespace palpate::protocols
