#include "protocols/procedure/staircases.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "protocols/procedure/state_bytes.hpp"

namespace palpate::protocols {

Staircases::Staircases(const std::vector<StaircaseSpec>& specs, Pcg32 random) : random_(random) {
    if (specs.empty()) {
        throw std::invalid_argument("there is no staircase: give at least one");
    }
    for (const StaircaseSpec& spec : specs) {
        for (const Staircase& other : tracks_) {
            if (other.spec().name == spec.name) {
                throw std::invalid_argument(
                    fmt::format("two staircases are called {}: give each its own name", spec.name));
            }
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

void Staircases::update(std::span<const double> shown, std::size_t outcome) {
    if (shown.size() != 1 || !std::isfinite(shown[0])) {
        throw std::invalid_argument("the stimulus of a staircase is one finite number: give that");
    }
    if (!(shown[0] > 0.0) && tracks_[track_].spec().scale != StepScale::linear) {
        throw std::invalid_argument(
            fmt::format("the stimulus is {}: on a scale of factors give one above 0", shown[0]));
    }
    if (outcome > 1) {
        throw std::invalid_argument(fmt::format("the response is {}: give 0 or 1", outcome));
    }
    if (finished()) {
        throw std::invalid_argument("every staircase has ended: give no more responses");
    }
    tracks_[track_].update(shown[0], outcome == 1);
    ++trials_;
    draw();
}

bool Staircases::finished() const noexcept {
    return tracks_[track_].finished();  // draw() leaves it on an open one if there is one
}

std::vector<Estimate> Staircases::estimates() const {
    std::vector<Estimate> estimates;
    for (const Staircase& track : tracks_) {
        estimates.push_back(track.estimate());
    }
    return estimates;
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
