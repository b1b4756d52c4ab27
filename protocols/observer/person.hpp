#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/base/pcg32.hpp"
#include "protocols/design/streams.hpp"
#include "protocols/observer/cues.hpp"
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

// Simulated people who judge, again and again, what hands once felt: hands are the slow part of a
// simulation.

/// What a hand felt of one object of one friction.
struct FeltTrial {
    std::size_t object = 0;    ///< index into Protocol::objects
    std::size_t friction = 0;  ///< index into Protocol::frictions
    Cues cues{};
};

/// Two frictions whose answers are compared.
struct FrictionPair {
    std::size_t without = 0;  ///< index into Protocol::frictions
    std::size_t with = 0;
};
/// The primary comparison: the largest static coefficient against the least, of equals the first.
/// The same place twice where there is one alone.
[[nodiscard]] FrictionPair primary_pair(const Protocol& protocol);

/// What friction does to how often a person is right.
struct LogitEffect {
    double mean = 0.0;  ///< of the log odds of a right answer, with less without
    double sd = 0.0;    ///< over people, normal
    /// People differ by sd p (1 - p) N(0, 1) in the share p of right answers itself, cut to the
    /// lesser of p and 1 - p on both sides: with a mean of 0 the mean difference of shares is then
    /// 0 too, which an effect that is symmetric in log odds does not give.
    bool in_shares = false;
};

/// Right answers of one person, and how many are to be expected of everybody like them.
struct JudgedPerson {
    std::size_t trials = 0;  ///< under each friction
    std::size_t right_without = 0;
    std::size_t right_with = 0;
    double share_without = 0.0;  ///< chance of a right answer, over all hands
    double share_with = 0.0;
};

/// Before hands are simulated. @throws std::invalid_argument if answers are no names of objects, if
/// these differ in
///         more than curvature, or if a rule chooses
void require_judged(const Protocol& protocol);

/// People of an observer file who feel every pictured object equally often under both frictions,
/// and name one. Each trial is a hand, drawn from those that felt this object under this friction,
/// and a percept of its own; the order of the trials is drawn anew for each person.
class JudgedPeople {
public:
    /// @param hands   of every pictured object under both frictions
    /// @param effect  none: friction does what the observer file says. Else each person loses some
    ///                right answers under friction, or some wrong ones, so that over all hands the
    ///                log odds differ by mean + sd N(0, 1)
    /// @throws as require_judged(); std::invalid_argument if no hand felt one of the objects
    JudgedPeople(const Protocol& protocol,
                 const ObserverModel& model,
                 std::vector<FeltTrial> hands,
                 const FrictionPair& pair,
                 std::optional<LogitEffect> effect);

    /// The person of a number in a study of a number: always the same one, whoever else was asked
    /// for.
    [[nodiscard]] JudgedPerson person(std::uint64_t seed,
                                      std::size_t study,
                                      std::size_t number) const;

private:
    /// Hands of one object under one friction, and between which percepts it is named.
    struct Condition {
        std::vector<Cues> hands{};
        double low = 0.0;  ///< 1/m
        double high = 0.0;
    };
    using Conditions = std::vector<Condition>;  ///< by object

    [[nodiscard]] bool is_right(const Person& who,
                                const Condition& condition,
                                const Cues& felt,
                                std::size_t done,
                                Pcg32& random) const;
    [[nodiscard]] double share(const Person& person, const Conditions& conditions) const;
    [[nodiscard]] double share_under_effect(double share, double normal) const;
    /// Trials of a session before the i-th that is judged, those among them spread evenly.
    [[nodiscard]] std::size_t before(std::size_t i) const noexcept {
        return practice_ + i * main_ / judged_;
    }

    ObserverModel model_;
    Conditions without_, with_;
    std::optional<LogitEffect> effect_;
    std::size_t practice_ = 0;  ///< trials of a session before those that count
    std::size_t main_ = 0;      ///< those that count, of all frictions
    std::size_t judged_ = 0;    ///< of these, those of the two frictions
    double guess_ = 0.0;        ///< chance to be right by a lapse
    double learned_ = 1.0;      ///< mean of learned() over those that are judged
};

}  // namespace palpate::protocols
