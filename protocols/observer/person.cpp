#include "protocols/observer/person.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/math/elementary.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/psychometric/exact_math.hpp"

namespace palpate::protocols {
namespace {

/// What the keys of an observer file allow: nobody's hand is drawn beyond.
constexpr double kSlowest = 0.25;
constexpr double kFastest = 3.0;
constexpr double kLightest = 0.6;
constexpr double kFirmest = 2.0;

double moved_in_logit(double share, double by) {
    if (share <= 0.0 || share >= 1.0) {
        return share;
    }
    const double odds = share / (1.0 - share) * exponential(by);
    return odds / (1.0 + odds);
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Statistics alone are made of it: its last bits may differ from one C library to another.
double below(double z) noexcept {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// Between which percepts, 1/m, an object is the nearest of those pictured.
std::pair<double, double> bounds_of(const Protocol& protocol,
                                    const std::vector<std::size_t>& pictured,
                                    std::size_t object) {
    const double own = protocol.objects[object].curvature;
    std::pair<double, double> bounds{-kInfinity, kInfinity};
    for (const std::size_t other : pictured) {
        const double middle = 0.5 * (own + protocol.objects[other].curvature);
        bounds.first = middle < own ? std::max(bounds.first, middle) : bounds.first;
        bounds.second = middle > own ? std::min(bounds.second, middle) : bounds.second;
    }
    return bounds;
}

}  // namespace

Person drawn_person(const ObserverModel& model, StreamKey key) {
    key.session = 0;
    Pcg32 random = stream(std::move(key), purpose::person);
    const PeopleSpec& sd = model.people;
    Person person{.spec = model.typical,
                  .noise_per_mu = model.friction.noise_per_mu,
                  .learning = model.learning,
                  .reaction = model.reaction,
                  .hand = model.hand};
    person.spec.noise *= exponential(sd.noise * normal_draw(random));
    person.bias = sd.bias * normal_draw(random);
    person.spec.lapse = moved_in_logit(person.spec.lapse, sd.lapse * normal_draw(random));
    person.spec.force_weight =
        std::clamp(person.spec.force_weight + sd.force_weight * normal_draw(random), 0.0, 1.0);
    person.spec.bias_per_mu += sd.bias_per_mu * normal_draw(random);
    person.noise_per_mu *= exponential(sd.noise_per_mu * normal_draw(random));
    person.reaction->median *= exponential(sd.reaction * normal_draw(random));
    person.hand.speed = std::clamp(person.hand.speed * exponential(sd.speed * normal_draw(random)),
                                   kSlowest, kFastest);
    person.hand.press = std::clamp(person.hand.press * exponential(sd.press * normal_draw(random)),
                                   kLightest, kFirmest);
    return person;
}

std::optional<double> percept_mean(const Person& person, const Cues& felt) noexcept {
    if (!felt.force && !felt.position) {
        return std::nullopt;
    }
    const ObserverSpec& spec = person.spec;
    const double force = felt.force.value_or(felt.position.value_or(0.0));
    const double position = felt.position.value_or(force);
    return spec.force_weight * force + (1.0 - spec.force_weight) * position +
           spec.bias_per_mu * felt.friction + person.bias;
}

double learned(const Person& person, std::size_t done) noexcept {
    const LearningSpec& learning = person.learning;
    return learning.first == 1.0
             ? 1.0
             : 1.0 + (learning.first - 1.0) *
                         exponential(-static_cast<double>(done) / learning.trials);
}

double percept_noise(const Person& person, double friction, std::size_t done) noexcept {
    const double by_friction = person.noise_per_mu == 1.0 || friction == 0.0
                                 ? 1.0
                                 : exponential(friction * engine::natural_log(person.noise_per_mu));
    return person.spec.noise * learned(person, done) * by_friction;
}

double uniform_draw(Pcg32& random) noexcept {
    const std::uint64_t upper = random.next();
    const std::uint64_t word = (upper << 32U) | random.next();
    return static_cast<double>(word >> 11U) * 0x1p-53;
}

double normal_draw(Pcg32& random) noexcept {
    for (;;) {
        const double x = 2.0 * uniform_draw(random) - 1.0;
        const double y = 2.0 * uniform_draw(random) - 1.0;
        const double s = x * x + y * y;
        if (s > 0.0 && s < 1.0) {
            return x * std::sqrt(-2.0 * engine::natural_log(s) / s);
        }
    }
}

double exponential_draw(Pcg32& random) noexcept {
    return -engine::natural_log(1.0 - uniform_draw(random));  // (0, 1]: never the logarithm of 0
}

FrictionPair primary_pair(const Protocol& protocol) {
    const auto& all = protocol.frictions;
    const auto place = [&](auto found) {
        return static_cast<std::size_t>(found - all.begin());
    };
    return {.without = place(std::ranges::min_element(all, {}, &FrictionSpec::mu_s)),
            .with = place(std::ranges::max_element(all, {}, &FrictionSpec::mu_s))};
}

void require_judged(const Protocol& protocol) {
    refuse_if(protocol.procedure || protocol.response.kind != ResponseKind::identification ||
                  !differ_in_curvature_alone(protocol),
              "{}: power is known of studies that ask which of several objects was felt, where "
              "these differ in curvature alone and no rule chooses",
              protocol.id);
}

JudgedPeople::JudgedPeople(const Protocol& protocol,
                           const ObserverModel& model,
                           std::vector<FeltTrial> hands,
                           const FrictionPair& pair,
                           std::optional<LogitEffect> effect)
    : model_(model), effect_(effect) {
    require_judged(protocol);
    const std::vector<std::size_t> pictured = objects_of(protocol, true);
    for (const std::size_t object : pictured) {
        const auto [low, high] = bounds_of(protocol, pictured, object);
        const Condition condition{.hands = {}, .low = low, .high = high};
        without_.push_back(condition);
        with_.push_back(condition);
    }
    for (const FeltTrial& felt : hands) {
        const auto at = std::ranges::find(pictured, felt.object);
        if (at != pictured.end() && (felt.friction == pair.without || felt.friction == pair.with)) {
            Conditions& all = felt.friction == pair.without ? without_ : with_;
            all[static_cast<std::size_t>(at - pictured.begin())].hands.push_back(felt.cues);
        }
    }
    for (const Conditions* all : {&without_, &with_}) {
        if (std::ranges::any_of(*all, [](const Condition& one) { return one.hands.empty(); })) {
            throw std::invalid_argument(
                fmt::format("{}: no hand felt one of its objects: give more hands", protocol.id));
        }
    }
    guess_ = 1.0 / static_cast<double>(pictured.size());
    const DesignSpec& design = protocol.design;
    const std::size_t conditions = pictured.size() * protocol.frictions.size();
    practice_ = conditions * design.practice_repetitions +
                (design.order == OrderRule::first_order ? 1 : 0);  // the one that leads in
    main_ = conditions * design.repetitions + design.catch_trials;
    judged_ = 2 * pictured.size() * design.repetitions;
    const Person typical{.spec = model.typical, .learning = model.learning};
    learned_ = 0.0;
    for (std::size_t i = 0; i < judged_; ++i) {
        learned_ += learned(typical, before(i)) / static_cast<double>(judged_);
    }
}

/// Of right answers over all hands, with what is learned over a session taken at its mean.
double JudgedPeople::share(const Person& person, const Conditions& conditions) const {
    Person rested = person;
    rested.learning = {};
    double sum = 0.0;
    for (const Condition& condition : conditions) {
        double right = 0.0;
        for (const Cues& felt : condition.hands) {
            const std::optional<double> mean = percept_mean(person, felt);
            if (!mean) {
                right += guess_;
                continue;
            }
            const double noise = learned_ * percept_noise(rested, felt.friction, 0);
            const auto reached = [&](double criterion) {
                return noise > 0.0 ? below((criterion - *mean) / noise)
                                   : (criterion > *mean ? 1.0 : 0.0);
            };
            right += (condition.high < kInfinity ? reached(condition.high) : 1.0) -
                     (condition.low > -kInfinity ? reached(condition.low) : 0.0);
        }
        sum += right / static_cast<double>(condition.hands.size());
    }
    const double judged = sum / static_cast<double>(conditions.size());
    return person.spec.lapse * guess_ + (1.0 - person.spec.lapse) * judged;
}

/// @param share  without friction
double JudgedPeople::share_under_effect(double share, double normal) const {
    if (effect_->in_shares) {
        const double max = std::min(share, 1.0 - share);
        return share + std::clamp(effect_->sd * share * (1.0 - share) * normal, -max, max);
    }
    const double factor = std::exp(effect_->mean + effect_->sd * normal);
    return share * factor / (1.0 - share + share * factor);
}

/// One answer. @param done  trials of the session before it
bool JudgedPeople::is_right(const Person& who,
                            const Condition& condition,
                            const Cues& felt,
                            std::size_t done,
                            Pcg32& random) const {
    const std::optional<double> mean = percept_mean(who, felt);
    if (!mean || uniform_draw(random) < who.spec.lapse) {
        return uniform_draw(random) < guess_;
    }
    const double noise = percept_noise(who, felt.friction, done);
    const double percept = *mean + noise * normal_draw(random);
    return percept > condition.low && percept < condition.high;
}

JudgedPerson JudgedPeople::person(std::uint64_t seed, std::size_t study, std::size_t number) const {
    const StreamKey key{.protocol_hash = "power",
                        .participant = fmt::format("{}:{}", study, number),
                        .purpose = {},
                        .seed = seed};
    const Person who = drawn_person(model_, key);
    Pcg32 random = stream(key, purpose::observer);
    JudgedPerson made{.trials = judged_ / 2};
    made.share_without = share(who, without_);
    const double felt_share = share(who, with_);
    made.share_with =
        effect_ ? share_under_effect(made.share_without, normal_draw(random)) : felt_share;
    const double lost = felt_share > made.share_with ? 1.0 - made.share_with / felt_share : 0.0;
    const double won =
        felt_share < made.share_with ? (made.share_with - felt_share) / (1.0 - felt_share) : 0.0;

    std::vector<std::size_t> order(judged_);  // which condition comes when
    std::iota(order.begin(), order.end(), std::size_t{0});
    shuffle(std::span(order), random);
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool with = order[i] >= made.trials;
        const Condition& condition =
            (with ? with_ : without_)[order[i] % made.trials * without_.size() / made.trials];
        const Cues& felt =
            condition.hands[random.bounded(static_cast<std::uint32_t>(condition.hands.size()))];
        bool right = is_right(who, condition, felt, before(i), random);
        if (with && effect_) {
            right = right ? uniform_draw(random) >= lost : uniform_draw(random) < won;
        }
        (with ? made.right_with : made.right_without) += right ? 1 : 0;
    }
    return made;
}

}  // namespace palpate::protocols
