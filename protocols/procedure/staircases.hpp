#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "engine/base/pcg32.hpp"
#include "protocols/procedure/estimate.hpp"
#include "protocols/procedure/staircase.hpp"

namespace palpate::protocols {

/// One staircase, or several interleaved: before each trial one of those that are not finished is
/// drawn, each equally likely, so that the participant cannot follow a track. A single one draws
/// nothing.
class Staircases {
public:
    /// @throws std::invalid_argument without a staircase, for equal names, or as Staircase
    Staircases(const std::vector<StaircaseSpec>& specs, Pcg32 random);

    [[nodiscard]] std::vector<double> next() const { return {tracks_[track_].level()}; }
    /// @throws std::invalid_argument for a stimulus that is not one finite number, for another
    ///         outcome than 0 (wrong) and 1 (right), or when all are finished
    void update(std::span<const double> shown, std::size_t outcome);

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
