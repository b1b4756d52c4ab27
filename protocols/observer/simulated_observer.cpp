#include "protocols/observer/simulated_observer.hpp"

#include <algorithm>
#include <cmath>

#include "protocols/design/object_outline.hpp"
#include "protocols/observer/draws.hpp"

namespace palpate::protocols {
namespace {

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
      hand_is_done_(std::move(hand_is_done)),
      cues_(protocol.outline) {
    key_.purpose = "observer";
    for (const std::size_t object : picture_order) {
        curvatures_.push_back(protocol.objects.at(object).curvature);
    }
    if (!differ_in_curvature_alone(protocol)) {
        shapes_.emplace(protocol, picture_order);
        const double chord = glm::length(protocol.outline.vertex - protocol.outline.a);
        blur_ = spec_.noise * chord * chord / 8.0;
    }
}

Signal SimulatedObserver::welcome(const SessionView& /*session*/) {
    return Signal::go_on;
}

Signal SimulatedObserver::ready(const TrialView& /*trial*/) {
    cues_ = CurvatureCues(outline_);
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
        cues_.add(ticks);
    }
}

Choice SimulatedObserver::choose(const TrialView& trial, const Question& question) {
    key_.block = trial.number;
    Pcg32 random = stream(key_);
    const bool lapse = uniform_draw(random) < spec_.lapse;
    const double noise = spec_.noise * normal_draw(random);
    const auto any =
        random.bounded(static_cast<std::uint32_t>(std::max<std::size_t>(question.answers, 1)));

    percept_ = evidence();
    Choice choice{.place = any, .reaction_s = reaction_time(random)};
    if (shapes_ && shapes_->felt() && !lapse) {
        choice.place = best_fit(random);
        return choice;
    }
    if (percept_) {
        *percept_ += noise;
        if (!lapse) {
            choice.place = nearest_place(*percept_);
        }
    }
    return choice;
}

Signal SimulatedObserver::gap(double /*seconds*/) {
    return Signal::go_on;
}

Signal SimulatedObserver::rest(double /*seconds*/, const TrialView& /*next*/) {
    return Signal::go_on;
}

void SimulatedObserver::finish(const SessionView& /*session*/) {}

std::optional<double> SimulatedObserver::evidence() const noexcept {
    const Cues felt = cues_.cues();
    if (!felt.force && !felt.position) {
        return std::nullopt;
    }
    const double force = felt.force.value_or(felt.position.value_or(0.0));
    const double position = felt.position.value_or(force);
    return spec_.force_weight * force + (1.0 - spec_.force_weight) * position +
           spec_.bias_per_mu * felt.friction;
}

std::size_t SimulatedObserver::best_fit(Pcg32& random) const {
    std::vector<double> misfits = shapes_->misfits();
    for (double& misfit : misfits) {
        misfit += blur_ * normal_draw(random);
    }
    return static_cast<std::size_t>(
        std::distance(misfits.begin(), std::min_element(misfits.begin(), misfits.end())));
}

std::size_t SimulatedObserver::nearest_place(double curvature) const noexcept {
    const auto nearest = std::min_element(
        curvatures_.begin(), curvatures_.end(),
        [&](double a, double b) { return std::fabs(a - curvature) < std::fabs(b - curvature); });
    return static_cast<std::size_t>(nearest - curvatures_.begin());
}

}  // namespace palpate::protocols
