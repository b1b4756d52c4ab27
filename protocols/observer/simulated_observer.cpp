#include "protocols/observer/simulated_observer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "engine/math/elementary.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/psychometric/exact_math.hpp"

namespace palpate::protocols {

/// Felt friction above which one says that there is some: strokes on a frictionless object feel 0.
constexpr double kFrictionSeen = 0.05;
constexpr double kLog10OfE = 0.43429448190325182;

/// s; nobody is faster.
constexpr double kQuickest = 0.25;

SimulatedObserver::SimulatedObserver(const Protocol& protocol,
                                     StreamKey key,
                                     const std::vector<std::size_t>& picture_order,
                                     std::function<bool()> hand_is_done,
                                     const std::optional<Person>& person)
    : outline_(protocol.outline),
      person_(person.value_or(Person{.spec = protocol.observer})),
      key_(std::move(key)),
      asked_(protocol.procedure ? protocol.procedure->varies : Varies::curvature),
      criterion_(asked_ == Varies::mu ? kFrictionSeen : 0.0),
      quickest_(std::max(kQuickest, protocol.timing.guard)),
      hand_is_done_(std::move(hand_is_done)),
      cues_{CurvatureCues(protocol.outline)} {
    for (const std::size_t object : picture_order) {
        curvatures_.push_back(protocol.objects.at(object).curvature);
    }
    if (!differ_in_curvature_alone(protocol)) {
        shapes_.emplace(protocol, picture_order);
        const double chord = protocol.surface
                               ? protocol.surface->size
                               : glm::length(protocol.outline.vertex - protocol.outline.a);
        blur_ = person_.spec.noise * chord * chord / 8.0;
    }
    know_range(protocol);
}

/// Between what the percepts of a rating lie.
void SimulatedObserver::know_range(const Protocol& protocol) {
    switch (asked_) {
        case Varies::curvature:
            for (const ObjectSpec& object : protocol.objects) {
                lowest_ = std::min(lowest_, object.curvature);
                highest_ = std::max(highest_, object.curvature);
            }
            return;
        case Varies::mu:
            for (const FrictionSpec& friction : protocol.frictions) {
                highest_ = std::max(highest_, friction.mu_d);
            }
            return;
        case Varies::compliance:
            highest_ = 1.0;
            unfelt_.emplace(protocol);
    }
}

Signal SimulatedObserver::ready(const TrialView& trial) {
    time_s_ += std::exchange(explored_s_, 0.0);
    if (trial.interval == 1) {
        cues_.clear();
        soft_.clear();
    }
    cues_.emplace_back(outline_);
    if (unfelt_) {
        soft_.push_back(*unfelt_);
    }
    if (shapes_) {
        shapes_->forget();
    }
    percept_.reset();
    return Signal::go_on;
}

ExplorationStep SimulatedObserver::explore(const TrialView& trial, double elapsed_s) {
    const bool done = elapsed_s >= trial.explore_min_s && hand_is_done_();
    explored_s_ = elapsed_s;
    return {.signal = done ? Signal::done : Signal::go_on, .at_s = elapsed_s};
}

void SimulatedObserver::feel(std::span<const engine::TickRecord> ticks) {
    if (shapes_) {
        shapes_->add(ticks);
    } else if (unfelt_) {
        soft_.back().add(ticks);
    } else {
        cues_.back().add(ticks);
    }
}

Choice SimulatedObserver::choose(const TrialView& trial, const Question& question) {
    done_ = trial.done;
    const std::string again = trial.unanswered == 0 ? "" : fmt::format(" {}", trial.unanswered);
    Pcg32 random = stream(key_, std::string(purpose::observer) + again, trial.done + 1);
    const bool lapse = uniform_draw(random) < person_.spec.lapse;
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
    choice.reaction_s = doubted(choice.reaction_s, !named);
    if (question.confidence) {
        choice.confidence = named ? confidence() : 1;
        choice.confidence_reaction_s = std::max(quickest_, reaction_time(random));
    }
    const bool late =
        question.timeout_s > 0.0 &&
        std::max(choice.reaction_s, choice.confidence_reaction_s) >= question.timeout_s;
    time_s_ += std::exchange(explored_s_, 0.0) +
               (late ? question.timeout_s : choice.reaction_s + choice.confidence_reaction_s);
    if (late) {
        return {.signal = Signal::too_late};
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
    percept_ = percept_of(0, noise);
    if (!percept_) {
        return std::nullopt;
    }
    switch (question.kind) {
        case ResponseKind::identification:
            distance_ = to_criterion(*percept_);
            return nearest_place(*percept_);
        case ResponseKind::two_interval: {
            const auto second = percept_of(cues_.size() - 1, normal_draw(random));
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
    const double far = std::fabs(distance_);
    return 1 + (far >= 0.5 * noise_ ? 1 : 0) + (far >= noise_ ? 1 : 0) +
           (far >= 2.0 * noise_ ? 1 : 0);
}

double SimulatedObserver::reaction_time(Pcg32& random) const noexcept {
    if (const auto& own = person_.reaction) {
        return own->median * exponential(own->spread * normal_draw(random));
    }
    const double decision = 0.8 + 0.15 * normal_draw(random);
    return decision + 0.7 * exponential_draw(random);
}

/// What a reaction time becomes by how far the percept is from what divides the answers.
double SimulatedObserver::doubted(double reaction_s, bool guess) const noexcept {
    if (const auto& own = person_.reaction) {
        const double far = guess        ? 0.0
                         : noise_ > 0.0 ? std::fabs(distance_) / noise_
                                        : std::numeric_limits<double>::infinity();
        reaction_s *= 1.0 + (own->doubt - 1.0) * exponential(-far);
    }
    return std::max(quickest_, reaction_s);
}

Signal SimulatedObserver::gap(double seconds) {
    time_s_ += std::exchange(explored_s_, 0.0) + seconds;
    return Signal::go_on;
}

std::optional<double> SimulatedObserver::percept_of(std::size_t interval, double noise) noexcept {
    if (asked_ == Varies::compliance) {
        const auto softness = soft_[interval].softness();
        noise_ = person_.spec.noise_softness * learned(person_, done_);
        return softness
                 ? std::optional(kLog10OfE * engine::natural_log(1e3 * *softness) + noise_ * noise)
                 : std::nullopt;
    }
    const Cues felt = cues_[interval].cues();
    const std::optional<double> mean = percept_mean(person_, felt);
    if (!mean) {
        return std::nullopt;
    }
    if (asked_ == Varies::mu) {
        noise_ = person_.spec.noise_mu * learned(person_, done_);
        return felt.friction + noise_ * noise;
    }
    noise_ = percept_noise(person_, felt.friction, done_);
    return *mean + noise_ * noise;
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
    noise_ = person_.spec.noise * learned(person_, done_);
    const double blur = blur_ * learned(person_, done_);
    for (double& misfit : misfits) {
        misfit += blur * normal_draw(random);
    }
    const auto best = std::ranges::min_element(misfits);
    double second = std::numeric_limits<double>::infinity();
    for (auto other = misfits.begin(); other != misfits.end(); ++other) {
        second = other == best ? second : std::min(second, *other);
    }
    distance_ = blur > 0.0 ? noise_ * (second - *best) / blur : second - *best;
    return static_cast<std::size_t>(std::distance(misfits.begin(), best));
}

std::size_t SimulatedObserver::nearest_place(double curvature) const noexcept {
    const auto nearest = std::ranges::min_element(curvatures_, [&](double a, double b) {
        return std::fabs(a - curvature) < std::fabs(b - curvature);
    });
    return static_cast<std::size_t>(nearest - curvatures_.begin());
}

}  // namespace palpate::protocols
