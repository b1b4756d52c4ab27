#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/pcg32.hpp"
#include "protocols/procedure/procedure_state.hpp"

namespace palpate::protocols {

/// How a step moves the level.
enum class StepScale : std::uint8_t {
    linear,  ///< level + step
    db,      ///< level * 10^(step / 20)
    log10    ///< level * 10^step
};
inline constexpr std::array<std::string_view, 3> kStepScales{"linear", "db", "log10"};

/// One staircase: `up` wrong answers (0) in a row raise the level, `down` right answers (1) in a
/// row lower it (H. Levitt, "Transformed up-down methods in psychoacoustics", JASA 49, 467-477,
/// 1971). With unequal steps it is weighted (C. Kaernbach, "Simple adaptive testing with the
/// weighted up-down method", Perception & Psychophysics 49, 227-229, 1991).
struct StaircaseSpec {
    std::string name = "staircase";
    double start = 0.0;
    std::size_t up = 1;
    std::size_t down = 2;
    std::vector<double> steps_up{
        1.0};  ///< before the first reversal, after it, ...; the last one stays
    std::vector<double> steps_down{1.0};  ///< the same downwards; all steps > 0
    StepScale scale = StepScale::linear;
    /// Until the first reversal every single right answer lowers the level (and wrong answer raises
    /// it).
    bool fast_start = false;
    double lowest = -1e10;  ///< the level is kept from lowest to highest
    double highest = 1e10;
    std::size_t trials = 0;     ///< it ends after so many trials; 0: not by trials
    std::size_t reversals = 0;  ///< it ends after so many reversals; 0: not by reversals
    /// The estimate is the mean of the last so many reversals; 0: of all.
    std::size_t average = 0;
};

/// Chance of a right answer at which a staircase with up = 1 stands still: the drift of a rule that
/// takes S_down at p^down and S_up otherwise is zero,
///
///     p = (S_up / (S_up + S_down))^(1 / down)
///
/// Equal steps: .5, .7071, .7937, .8409 for down = 1, 2, 3, 4 (Levitt 1971, table I). down = 1:
/// S_down / S_up = (1 - p) / p (Kaernbach 1991). Of the last steps, for up = 1; else NaN.
[[nodiscard]] double target(const StaircaseSpec& spec) noexcept;

/// The ratio S_down / S_up of a weighted 1-up-1-down staircase that aims at p: (1 - p) / p.
[[nodiscard]] constexpr double weighted_step_ratio(double p) noexcept {
    return (1.0 - p) / p;
}

/// A staircase on its way. A reversal is a trial whose answer turns the direction of the rule,
/// counted even where a bound stops the level; its value is the stimulus of that trial, and the
/// next move already has the next step size. A level has twelve digits: what additions leave behind
/// them would make two levels of one that is reached on two ways.
class Staircase {
public:
    /// @throws std::invalid_argument for a spec that makes no sense, with the member and the remedy
    explicit Staircase(StaircaseSpec spec);

    /// The stimulus to show next.
    [[nodiscard]] double level() const noexcept { return level_; }
    /// @param shown   what was shown; the rule goes on from there
    /// @param right   1: right, 0: wrong
    void update(double shown, bool right);
    [[nodiscard]] bool finished() const noexcept;

    /// As it was given; trials so far; and the stimuli of the reversals so far.
    [[nodiscard]] const StaircaseSpec& spec() const noexcept { return spec_; }
    [[nodiscard]] std::size_t trials() const noexcept { return trials_; }
    [[nodiscard]] const std::vector<double>& reversals() const noexcept { return reversals_; }
    /// Mean of the last reversals, none before the first; with their standard deviation (n - 1
    /// below, none of one) and number.
    [[nodiscard]] Estimate estimate() const;
    [[nodiscard]] int direction() const noexcept { return direction_; }
    [[nodiscard]] std::size_t in_a_row() const noexcept { return in_a_row_; }

private:
    void move(int direction, double from);
    void begin_at(double level);
    void place();

    StaircaseSpec spec_;
    double base_ = 0.0;   ///< where it began
    double moved_ = 0.0;  ///< steps from there, up less down
    double level_ = 0.0;
    int direction_ = 0;  ///< of the last move; 0: none yet
    bool last_right_ = false;
    std::size_t in_a_row_ = 0;  ///< equal answers since the last move
    std::size_t trials_ = 0;
    std::vector<double> reversals_;
};

/// One staircase, or several interleaved: before each trial one of those that are not finished is
/// drawn, each equally likely, so that the participant cannot follow a track. A single one draws
/// nothing.
class Staircases {
public:
    /// @throws std::invalid_argument without a staircase, for equal names, or as Staircase
    Staircases(const std::vector<StaircaseSpec>& specs, Pcg32 random);

    /// The level of the staircase that was drawn for the next trial.
    [[nodiscard]] std::vector<double> next() const { return {tracks_[track_].level()}; }
    /// @param track  the name of the staircase that showed it; empty: the one that was drawn
    /// @throws std::invalid_argument for a stimulus that is not one finite number, for another
    ///         outcome than 0 (wrong) and 1 (right), for another name, or when all are finished
    void update(std::span<const double> shown, std::size_t outcome, std::string_view track = {});

    /// As Procedure's: each staircase has finished; an estimate a staircase.
    [[nodiscard]] bool finished() const noexcept;
    [[nodiscard]] std::size_t trials() const noexcept { return trials_; }
    [[nodiscard]] std::size_t outcomes() const noexcept { return 2; }
    [[nodiscard]] std::vector<std::string> stimulus_names() const { return {"stimulus"}; }
    [[nodiscard]] std::vector<Estimate> estimates() const;
    [[nodiscard]] std::string state_hash() const;

    /// Which staircase the next trial belongs to.
    [[nodiscard]] std::size_t track() const noexcept { return track_; }
    [[nodiscard]] std::span<const Staircase> tracks() const noexcept { return tracks_; }

private:
    void draw();

    std::vector<Staircase> tracks_;
    Pcg32 random_;
    std::size_t track_ = 0;
    std::size_t trials_ = 0;
};

}  // namespace palpate::protocols
