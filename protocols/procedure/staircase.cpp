#include "protocols/procedure/staircase.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <ranges>
#include <utility>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/math/elementary.hpp"
#include "protocols/procedure/grid.hpp"
#include "protocols/psychometric/exact_math.hpp"

namespace palpate::protocols {
namespace {

void check_steps(std::string_view name, const std::vector<double>& steps) {
    refuse_if(steps.empty(), "{} is empty: give at least one step above 0", name);
    for (const double step : steps) {
        refuse_if(!(std::isfinite(step) && step > 0.0), "{} holds {}: give finite numbers above 0",
                  name, step);
    }
}

void check(const StaircaseSpec& s) {
    check_steps("step_up", s.steps_up);
    check_steps("step_down", s.steps_down);
    refuse_if(s.up == 0 || s.down == 0, "up is {} and down {}: give 1 or more answers in a row",
              s.up, s.down);
    refuse_if(!(s.lowest < s.highest), "lowest is {} and highest {}: give lowest < highest",
              s.lowest, s.highest);
    refuse_if(!(s.start >= s.lowest && s.start <= s.highest),
              "start is {}: give a level from lowest ({}) to highest ({})", s.start, s.lowest,
              s.highest);
    refuse_if(s.scale != StepScale::linear && !(s.start > 0.0),
              "start is {}: on a scale of factors give a level above 0", s.start);
    refuse_if(s.trials == 0 && s.reversals == 0,
              "the staircase would never end: give trials, or, outside of a protocol, reversals");
}

double moved(StepScale scale, double level, double step) {
    switch (scale) {
        case StepScale::linear:
            return level + step;
        case StepScale::db:
            return level * power_of_ten(step / 20.0);
        case StepScale::log10:
            return level * power_of_ten(step);
    }
    return level;
}

/// moved() by so much leads from one level to the other.
double steps_between(StepScale scale, double from, double to) {
    const double tenfolds = engine::natural_log(to / from) / std::numbers::ln10;
    return scale == StepScale::linear ? to - from
         : scale == StepScale::db     ? 20.0 * tenfolds
                                      : tenfolds;
}

/// A level is a bound if it is that close to it, relative.
constexpr double kAtBound = 1e-9;

}  // namespace

double target(const StaircaseSpec& spec) noexcept {
    if (spec.up != 1 || spec.steps_up.empty() || spec.steps_down.empty()) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    const double up = spec.steps_up.back();
    const double share = up / (up + spec.steps_down.back());
    return exponential(engine::natural_log(share) / static_cast<double>(spec.down));
}

Staircase::Staircase(StaircaseSpec spec) : spec_(std::move(spec)) {
    check(spec_);
    begin_at(spec_.start);
}

void Staircase::begin_at(double level) {
    base_ = level;
    moved_ = 0.0;
    place();
}

void Staircase::place() {
    const double step =
        std::max(std::ranges::max(spec_.steps_up), std::ranges::max(spec_.steps_down));
    const double by = twelve_digits(moved_, std::max(std::fabs(moved_), step));
    const double there = moved(spec_.scale, base_, by);
    const bool linear = spec_.scale == StepScale::linear;
    const double size = linear ? std::max(std::fabs(base_), std::fabs(by)) : there;
    level_ =
        std::clamp(size > 0.0 ? twelve_digits(there, size) : there, spec_.lowest, spec_.highest);
    for (const double bound : {spec_.lowest, spec_.highest}) {
        level_ = std::fabs(level_ - bound) <= kAtBound * std::fabs(bound) ? bound : level_;
    }
    if (std::fabs(there - level_) > kAtBound * std::fabs(level_)) {  // on from the bound
        moved_ = steps_between(spec_.scale, base_, level_);
    }
}

void Staircase::update(double shown, bool right) {
    in_a_row_ = in_a_row_ > 0 && right == last_right_ ? in_a_row_ + 1 : 1;
    last_right_ = right;
    const bool single = spec_.fast_start && reversals_.empty();
    const std::size_t needed = single ? 1 : (right ? spec_.down : spec_.up);
    if (shown != level_) {
        begin_at(shown);
    }
    if (in_a_row_ >= needed) {
        in_a_row_ = 0;
        move(right ? -1 : 1, shown);
    }
    ++trials_;
}

void Staircase::move(int direction, double from) {
    if (direction_ != 0 && direction != direction_) {
        reversals_.push_back(from);
    }
    direction_ = direction;
    const std::vector<double>& steps = direction > 0 ? spec_.steps_up : spec_.steps_down;
    const double step = steps[std::min(reversals_.size(), steps.size() - 1)];
    moved_ += direction > 0 ? step : -step;
    place();
}

bool Staircase::finished() const noexcept {
    return (spec_.trials > 0 && trials_ >= spec_.trials) ||
           (spec_.reversals > 0 && reversals_.size() >= spec_.reversals);
}

Estimate Staircase::estimate() const {
    Estimate made{.name = spec_.name, .mean = std::nullopt, .mode = std::nullopt};
    if (reversals_.empty()) {
        return made;
    }
    made.reversals =
        spec_.average == 0 ? reversals_.size() : std::min(spec_.average, reversals_.size());
    const std::span last = std::span(reversals_).last(made.reversals);
    const auto count = static_cast<double>(made.reversals);
    double sum = 0.0;
    for (const double level : last) {
        sum += level;
    }
    made.mean = sum / count;
    if (made.reversals > 1) {
        double square = 0.0;
        for (const double level : last) {
            square += (level - *made.mean) * (level - *made.mean);
        }
        made.sd = std::sqrt(square / (count - 1.0));
    }
    return made;
}

Staircases::Staircases(const std::vector<StaircaseSpec>& specs, Pcg32 random) : random_(random) {
    refuse_if(specs.empty(), "there is no staircase: give at least one");
    for (const StaircaseSpec& spec : specs) {
        for (const Staircase& other : tracks_) {
            refuse_if(other.spec().name == spec.name,
                      "two staircases are called {}: give each its own name", spec.name);
        }
        tracks_.emplace_back(spec);
    }
    draw();
}

void Staircases::draw() {
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
        if (!tracks_[i].finished()) {
            open.push_back(i);
        }
    }
    if (open.size() == 1) {
        track_ = open[0];
    } else if (!open.empty()) {
        track_ = open[random_.bounded(static_cast<std::uint32_t>(open.size()))];
    }
}

void Staircases::update(std::span<const double> shown,
                        std::size_t outcome,
                        std::string_view track) {
    refuse_if(shown.size() != 1 || !std::isfinite(shown[0]),
              "the stimulus of a staircase is one finite number: give that");
    const auto by = track.empty() ? tracks_.begin() + static_cast<std::ptrdiff_t>(track_)
                                  : std::ranges::find(tracks_, track, [](const Staircase& one) {
                                        return std::string_view(one.spec().name);
                                    });
    refuse_if(by == tracks_.end(), "there is no staircase {}: give the name of one", track);
    refuse_if(!(shown[0] > 0.0) && by->spec().scale != StepScale::linear,
              "the stimulus is {}: on a scale of factors give one above 0", shown[0]);
    refuse_if(outcome > 1, "the response is {}: give 0 or 1", outcome);
    refuse_if(finished(), "every staircase has ended: give no more responses");
    by->update(shown[0], outcome == 1);
    ++trials_;
    draw();
}

bool Staircases::finished() const noexcept {
    return tracks_[track_].finished();  // draw() leaves it on an open one if there is one
}

std::vector<Estimate> Staircases::estimates() const {
    const auto estimates = std::views::transform(tracks_, &Staircase::estimate);
    return {estimates.begin(), estimates.end()};
}

std::string Staircases::state_hash() const {
    StateBytes bytes("palpate-staircases-v1");
    bytes.add(std::uint64_t{trials_});
    bytes.add(std::uint64_t{track_});
    Pcg32 coming = random_;  // its next two words stand for the generator's place in its stream
    bytes.add(std::uint64_t{coming.next()});
    bytes.add(std::uint64_t{coming.next()});
    for (const Staircase& track : tracks_) {
        bytes.add(track.level());
        bytes.add(std::uint64_t{track.trials()});
        bytes.add(static_cast<std::uint64_t>(track.direction() + 1));
        bytes.add(std::uint64_t{track.in_a_row()});
        bytes.add(track.reversals());
    }
    return bytes.hash();
}

}  // namespace palpate::protocols
