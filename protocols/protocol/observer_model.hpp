#pragma once

#include "protocols/protocol/protocol.hpp"

/// Simulated participants as an observer file describes them. A value; who is drawn from it:
/// observer/person.hpp.
namespace palpate::protocols {

/// What friction does to the percept beyond ObserverSpec::bias_per_mu. Both go with the friction
/// that was felt.
struct FrictionEffectSpec {
    double noise_per_mu = 1.0;  ///< of the noise at a felt friction of 1, > 0; at f: to the f-th

    friend bool operator==(const FrictionEffectSpec&, const FrictionEffectSpec&) = default;
};

/// How much people differ: standard deviations over them, normal and independent.
struct PeopleSpec {
    double noise = 0.0;         ///< of the logarithm of the noise
    double bias = 0.0;          ///< of a curvature that is added to every percept, 1/m
    double lapse = 0.0;         ///< of the logit of the share of lapses
    double force_weight = 0.0;  ///< cut to 0..1
    double bias_per_mu = 0.0;   ///< 1/m
    double noise_per_mu = 0.0;  ///< of the logarithm of FrictionEffectSpec::noise_per_mu
    double reaction = 0.0;      ///< of the logarithm of the median reaction time
    double speed = 0.0;         ///< of the logarithm of the hand's speed
    double press = 0.0;         ///< of the logarithm of how deep the hand means to press

    friend bool operator==(const PeopleSpec&, const PeopleSpec&) = default;
};

/// Practice within a session: after n trials the noise is noise * (1 + (first - 1) exp(-n /
/// trials)).
struct LearningSpec {
    double first = 1.0;    ///< factor of the noise in the first trial, > 0
    double trials = 20.0;  ///< after so many 1/e of it is left, > 0

    friend bool operator==(const LearningSpec&, const LearningSpec&) = default;
};

/// Reaction times: median * exp(spread N(0, 1)) * (1 + (doubt - 1) exp(-distance of the percept
/// from what divides the answers / noise)), at least 0.25 s.
struct ReactionSpec {
    double median = 1.5;  ///< s, far from a division
    double spread = 0.4;  ///< of the logarithm, from trial to trial
    double doubt = 1.5;   ///< factor on a division, >= 1; also of a guess

    friend bool operator==(const ReactionSpec&, const ReactionSpec&) = default;
};

/// The hand, beside what is drawn trial by trial (DrawnHand).
struct HandSpec {
    double speed = 1.0;  ///< factor of 65 to 95 mm/s
    double press = 1.0;  ///< factor of 8.5 to 10 mm that the hand means to be inside of the chords

    friend bool operator==(const HandSpec&, const HandSpec&) = default;
};

/// A population of simulated participants, and how each of them answers.
struct ObserverModel {
    ObserverSpec typical{};
    FrictionEffectSpec friction{};
    PeopleSpec people{};
    LearningSpec learning{};
    ReactionSpec reaction{};
    HandSpec hand{};

    friend bool operator==(const ObserverModel&, const ObserverModel&) = default;
};

}  // namespace palpate::protocols
