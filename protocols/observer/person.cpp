#include "protocols/observer/person.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/math/elementary.hpp"
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

}  // namespace

Person drawn_person(const ObserverModel& model, StreamKey key) {
    key.session = 0;
    key.block = 0;
    key.purpose = purpose::person;
    Pcg32 random = stream(key);
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

}  // namespace palpate::protocols
