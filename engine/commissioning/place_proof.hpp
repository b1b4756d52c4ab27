#pragma once

#include "engine/commissioning/commissioning.hpp"
#include "engine/commissioning/short_form.hpp"

/// Is a free handle where its encoders say? Between trials, without a force.
namespace palpate::engine {

/// An encoder at rest may flicker by one count.
inline constexpr double kStillCounts = 1.0;
/// s of a look, and looks at a handle that rests elsewhere until its home is not believed any more.
inline constexpr double kLook = 0.25;
inline constexpr int kAstray = 5;

/// A handle at a place where it should be, as its encoders say.
struct Sight {
    Rest rest{};
    std::optional<Vec3> place{};  ///< m; none: no pose of the machine, or nothing was read
    double off = 0.0;             ///< m from where it should be

    /// No encoder went over more than kStillCounts while it rested.
    [[nodiscard]] bool still() const;
    /// A pose of the machine, within kAtPlace of where it should be.
    [[nodiscard]] bool there() const { return place && off <= kAtPlace; }
    /// "(10, 60) mm", or "nowhere". @param axes  of the machine
    [[nodiscard]] std::string text(std::size_t axes) const;
};
[[nodiscard]] Sight look_for(PulseRunner& runner, const Calibration& calibration, const Vec3& aim);

/// The handle rests at home. Encoders that slipped since show here; counts of a device that does
/// not begin at home are its own, and believed.
[[nodiscard]] ShortForm prove_home(PulseRunner& runner, const Calibration& calibration);

/// The handle rests at the second mark, after a pose was taken for home that nobody saw to. One
/// that rests at neither for some looks is where the person was asked to bring it: home was
/// elsewhere, and is asked for again.
class MarkProof {
public:
    /// @param mark  m
    MarkProof(const Calibration& calibration, const Vec3& mark)
        : calibration_(calibration), mark_(mark) {}
    /// One look.
    [[nodiscard]] ShortForm look(PulseRunner& runner, Device& device);

private:
    Calibration calibration_;
    Vec3 mark_;
    int astray_ = 0;
};

}  // namespace palpate::engine
