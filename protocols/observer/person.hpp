#pragma once

#include <cstddef>
#include <optional>

#include "engine/base/pcg32.hpp"
#include "protocols/design/streams.hpp"
#include "protocols/observer/curvature_cues.hpp"
#include "protocols/protocol/observer_model.hpp"

namespace palpate::protocols {

/// Uniform in [0, 1): 53 bits of two words, the first the upper one.
[[nodiscard]] double uniform_draw(Pcg32& random) noexcept;

/// Standard normal, by the polar method (G. Marsaglia and T. A. Bray, 1964); its second value is
/// not kept, so that a draw leaves no state behind.
[[nodiscard]] double normal_draw(Pcg32& random) noexcept;

/// Exponential with mean 1.
[[nodiscard]] double exponential_draw(Pcg32& random) noexcept;

/// One simulated participant.
struct Person {
    ObserverSpec spec{};
    double bias = 0.0;          ///< 1/m, added to every percept
    double noise_per_mu = 1.0;  ///< see FrictionEffectSpec
    LearningSpec learning{};
    std::optional<ReactionSpec> reaction{};  ///< none: as SimulatedObserver has them
    HandSpec hand{};

    friend bool operator==(const Person&, const Person&) = default;
};

/// The participant of an observer file that belongs to a participant's code, from the stream
/// `person`, whose key leaves the session out: the same in all sessions.
/// @param key  of a session; session, block and purpose are set here
[[nodiscard]] Person drawn_person(const ObserverModel& model, StreamKey key);

/// What a person makes of cues before any noise, 1/m: w force + (1 - w) position + bias_per_mu *
/// friction + bias. With one cue missing the other has all the weight; nothing without any.
[[nodiscard]] std::optional<double> percept_mean(const Person& person, const Cues& felt) noexcept;

/// What practice leaves of the noise, as a factor. @param done  trials of the session before
[[nodiscard]] double learned(const Person& person, std::size_t done) noexcept;

/// Standard deviation of the percept of a curvature, 1/m. @param friction  Cues::friction
[[nodiscard]] double percept_noise(const Person& person,
                                   double friction,
                                   std::size_t done) noexcept;

}  // namespace palpate::protocols
