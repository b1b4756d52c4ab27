#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include "engine/device/calibration.hpp"

namespace palpate::engine {

/// The handle was held at a place that is known, and the encoders were read for a while.
struct MarkReading {
    Vec2 place{};   ///< object frame, m
    Vec2 counts{};  ///< mean of each encoder
    Vec2 span{};    ///< largest count less smallest
};

/// Gathers the readings at one mark.
class MarkCounts {
public:
    /// One more reading of both encoders; of two the third is 0.
    void add(const std::array<std::int32_t, kMaxAxes>& counts) noexcept;
    /// How many were added.
    [[nodiscard]] int readings() const noexcept { return readings_; }
    /// Of each encoder. @pre something was read
    [[nodiscard]] Vec3 mean() const noexcept { return sum_ / static_cast<double>(readings_); }
    /// Largest count less smallest. @pre something was read
    [[nodiscard]] Vec3 span() const noexcept { return max_ - min_; }
    /// @throws std::invalid_argument if nothing was read
    [[nodiscard]] MarkReading at(const Vec2& place) const;

private:
    Vec3 sum_{};
    Vec3 min_{std::numeric_limits<double>::infinity()};
    Vec3 max_{-min_};
    int readings_ = 0;
};

/// What the encoders count from.
struct Homing {
    std::array<Axis, 2> axes{};     ///< as they were, with the zeros (and counts per turn) found
    std::vector<double> residuals;  ///< m, from each mark to where the handle would then be
    double worst = 0.0;             ///< the largest of them
};

/// The readings cannot be; what() is a sentence with number and remedy.
class HomingError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Finds both encoders' zeros from marks, and their counts per turn if asked.
///
/// The angles that belong to a mark are exact (FiveBar::inverse), and the angle of an encoder is
/// linear in its zero and in the turn of one count. Least squares of the handle's distances to the
/// marks, with the Jacobian at each mark: one mark is met exactly, of several the person's aim is
/// averaged. Zeros are given in [-pi, pi].
///
/// @param spec   linkage and frame; its zeros are not used, its counts per turn are the start
/// @param scale  find counts per turn as well: at least three marks that do not lie in line
/// @throws HomingError  without marks, for one out of reach, for a handle that moved by more than
///         0.3 mm while it was read, for marks in line or too close (scale), for counts per turn
///         more than a tenth off, and when a mark is missed by more than 1 mm
[[nodiscard]] Homing find_home(const PantographSpec& spec,
                               std::span<const MarkReading> marks,
                               bool scale);

/// `before` with the axes found. Its home, where there is one, is moved to where the handle truly
/// rests at switch-on: a driver counts from there, so that the zeros alone would change nothing.
/// @throws HomingError if the linkage could not rest there
[[nodiscard]] Calibration calibrated(const Calibration& before, const Homing& homing);

}  // namespace palpate::engine
