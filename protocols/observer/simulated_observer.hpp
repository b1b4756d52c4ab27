#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "protocols/design/plan_summary.hpp"
#include "protocols/design/streams.hpp"
#include "protocols/observer/cues.hpp"
#include "protocols/observer/person.hpp"
#include "protocols/protocol/protocol.hpp"
#include "protocols/trial/observer.hpp"

namespace palpate::protocols {

/// An observer made of numbers: it answers from the ticks that it felt, never from the trial's
/// label.
///
///     percept = w * force cue + (1 - w) * position cue + bias * felt friction + noise * N(0, 1)
///
/// with the weights of [observer] in the protocol. The answer is the pictured object of the nearest
/// curvature (criteria midway between neighbours), or any picture with the probability `lapse`.
/// With one cue missing the other has all the weight; an observer who felt nothing guesses.
///
/// That is for objects that differ in curvature alone. Where one of them is a free form, or is
/// placed elsewhere, the observer compares what it felt with every picture (OutlineCues) and takes
/// the one of the least misfit, each with an error of its own:
///
///     misfit + noise c^2 / 8 * N(0, 1)        c = |V - A| of [outline]
///
/// as an error of curvature is one of sagitta on such a chord: 1 mm by default. Cues are not
/// weighted then, and friction has no bias.
///
/// A Person of an observer file has a bias of its own, noise that learning takes away and felt
/// friction multiplies (percept_noise; misfits and noise_mu are only learned), and reaction times
/// (ReactionSpec). Without one reaction times are ex-Gaussian (R. D. Luce, Response Times, 1986):
/// 0.8 s + 0.15 s N(0, 1) + an exponential of mean 0.7 s, at least 0.25 s. Nothing is waited for.
///
/// Two intervals: each is a percept with a noise of its own, and the larger one is named. Where a
/// rule varies mu, the percept is the felt friction, mean |F_t| / F_n of the strokes, with the
/// noise noise_mu; where it varies the compliance, the decadic logarithm of the felt softness in
/// mm/N (SoftnessCues), with noise_softness. Yes is said above 0 1/m, above a friction of 0.05, or
/// above 1 mm/N; a rating spreads its levels evenly over the curvatures of the objects (frictions:
/// 0 to the largest mu_d; softness: 1 to 10 mm/N). Confidence follows the distance of the percept
/// from what divides the answers, in noises: 1 below 0.5, 2 below 1, 3 below 2, else 4; a guess: 1.
///
/// Every trial draws from a stream of its own, keyed by its number: a resumed session, or a trial
/// that was aborted and is run again, answers as the unbroken one.
class SimulatedObserver : public Observer {
public:
    /// @param key            of the session; block and purpose are set here, trial by trial
    /// @param picture_order  place on the screen -> index into protocol.objects, as in the plan
    /// @param hand_is_done   the hand that explores for this observer has finished
    /// @param person         none: as [observer] of the protocol says
    SimulatedObserver(const Protocol& protocol,
                      StreamKey key,
                      const std::vector<std::size_t>& picture_order,
                      std::function<bool()> hand_is_done,
                      const std::optional<Person>& person = {});

    [[nodiscard]] Signal welcome(const SessionView& /*session*/) override { return Signal::go_on; }
    [[nodiscard]] Signal ready(const TrialView& trial) override;
    [[nodiscard]] ExplorationStep explore(const TrialView& trial, double elapsed_s) override;
    void feel(std::span<const engine::TickRecord> ticks) override;
    [[nodiscard]] Choice choose(const TrialView& trial, const Question& question) override;
    [[nodiscard]] Signal feedback(const TrialView& /*trial*/, bool /*correct*/) override {
        return gap(kFeedbackSeconds);
    }
    [[nodiscard]] Signal gap(double seconds) override;
    [[nodiscard]] Signal rest(double seconds, const TrialView& /*next*/) override {
        return gap(seconds);
    }
    void finish(const SessionView& /*session*/) override {}

    /// Of the last answer, 1/m (or as the question has it); none if nothing was felt, or if shapes
    /// were compared.
    [[nodiscard]] std::optional<double> percept() const noexcept { return percept_; }
    /// What is felt of the curvature in the running interval, or was in the last one.
    [[nodiscard]] Cues felt() const { return cues_.back().cues(); }
    /// How long all so far would have taken a person: explorations, answers, what
    /// the screen says of them, gaps and breaks; s.
    [[nodiscard]] double time_s() const noexcept { return time_s_; }

private:
    void know_range(const Protocol& protocol);
    [[nodiscard]] std::optional<double> percept_of(std::size_t interval, double noise) noexcept;
    [[nodiscard]] std::optional<std::size_t> answer(const Question& question,
                                                    double noise,
                                                    Pcg32& random);
    [[nodiscard]] int confidence() const noexcept;
    [[nodiscard]] double reaction_time(Pcg32& random) const noexcept;
    [[nodiscard]] double doubted(double reaction_s, bool guess) const noexcept;
    [[nodiscard]] double to_criterion(double curvature) const noexcept;
    [[nodiscard]] std::size_t nearest_place(double curvature) const noexcept;
    [[nodiscard]] std::size_t best_fit(Pcg32& random);

    OutlineSpec outline_;
    Person person_;
    StreamKey key_;
    std::vector<double> curvatures_;  ///< of the pictures from the left, 1/m
    Varies asked_;                    ///< what the question is about
    double criterion_;                ///< yes is said above it
    double lowest_ = 0.0;             ///< percept of a rating's first level ...
    double highest_ = 0.0;            ///< ... and of its last
    double quickest_;                 ///< no answer comes earlier, s
    std::function<bool()> hand_is_done_;
    std::vector<CurvatureCues> cues_;     ///< of the intervals felt so far
    std::vector<SoftnessCues> soft_;      ///< the same; if the question is about softness
    std::optional<SoftnessCues> unfelt_;  ///< what an interval begins with
    std::optional<OutlineCues> shapes_;   ///< if the objects differ in more than curvature
    double blur_ = 0.0;                   ///< m, noise of a misfit
    std::optional<double> percept_;
    double distance_ = 0.0;  ///< of the last percept from what divides the answers ...
    double noise_ = 0.0;     ///< ... and its noise, in the same unit
    std::size_t done_ = 0;   ///< trials of the session before this one
    double explored_s_ = 0.0;
    double time_s_ = 0.0;
};

}  // namespace palpate::protocols
