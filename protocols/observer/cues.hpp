#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/contact/closest_point.hpp"
#include "engine/realtime/tick_record.hpp"
#include "engine/surface/surface_closest.hpp"
#include "protocols/protocol/protocol.hpp"

namespace palpate::protocols {

/// A press below this is not felt as a direction, N.
inline constexpr double kFeltForce = 0.05;

/// What a hand can tell of the curvature of a two-curve object, from the ticks alone.
struct Cues {
    std::optional<double> force;     ///< 1/m, from how the force turns along a stroke
    std::optional<double> position;  ///< 1/m, from how the hand's path bends along a stroke
    double friction = 0.0;           ///< mean |F_t| / F_n of the strokes, 0 without any
};

/// Adds up the strokes of one trial; keeps sums, no ticks.
///
/// It knows the chords A-V and V-B, as people know them from the pictures, and never the curvature.
/// A tick counts when the object is pressed with 0.05 N or more, the contact slides, the hand has
/// kept its direction for 3 mm, and it is within the middle 80 % of a chord. x is the hand's place
/// along the chord and y its height above it, in half chords.
///
///     force cue       a, the angle of the force from the chord's normal: da/dx = curvature
///     position cue    y = c0 + c1 x + c2 x^2: curvature = -2 c2
///
/// Both are least squares with an intercept (and tilt c1) for each chord and direction of motion.
/// In the force cue this is what removes friction: it turns the force by atan(mu) against the
/// motion, one way up and the other way down. In the position cue it removes how deep and how askew
/// the hand presses.
///
/// Both use the hand (HIP), not the surface: where the surface is below a pressed hand, nobody
/// knows. So the force cue is stretched by 1 / (1 - curvature * depth), 3 % at 3 mm on 10 1/m, and
/// the position cue shrinks by K / (K + hand stiffness), since a hand yields less than the surface
/// would ask: .77 for 1000 N/m and a hand of 300 N/m. Arc and chord differ by below 1 % for
/// |curvature| <= 10 1/m.
class CurvatureCues {
public:
    /// @param outline  two curves on a base line, whose chords are read; their curvature is not
    explicit CurvatureCues(const OutlineSpec& outline);

    /// The next ticks of the exploration, in their order. Without contact, below kFeltForce and off
    /// the middle of a chord nothing is learnt.
    void add(std::span<const engine::TickRecord> ticks) noexcept;
    /// Both estimates from all that was added, 1/m.
    [[nodiscard]] Cues cues() const noexcept;

private:
    /// Power sums of the ticks of one chord and one direction of motion.
    struct Strokes {
        double n = 0.0, x = 0.0, x2 = 0.0, x3 = 0.0, x4 = 0.0;
        double a = 0.0, xa = 0.0;
        double y = 0.0, xy = 0.0, x2y = 0.0;
    };
    struct Chord {
        engine::Vec2 middle{};
        engine::Vec2 along{1.0, 0.0};
        engine::Vec2 outward{0.0, 1.0};
        double half = 1.0;  ///< m
    };
    static constexpr std::size_t kNone = 2;

    void add(const engine::TickRecord& tick) noexcept;
    [[nodiscard]] std::size_t chord_at(const engine::Vec2& hip) const noexcept;
    [[nodiscard]] bool sliding(const engine::TickRecord& tick, std::size_t chord) noexcept;

    std::array<Chord, 2> chords_;
    std::array<std::array<Strokes, 2>, 2> strokes_{};  ///< [chord][towards its end]
    double friction_sum_ = 0.0;
    double friction_count_ = 0.0;

    std::size_t chord_ = kNone;  ///< of the last tick, kNone before contact and off the chords
    engine::Vec3 last_hip_{};
    engine::Vec3 last_go_{};
    double velocity_ = 0.0;  ///< smoothed, m per tick along the chord
    double kept_ = 0.0;      ///< m since the last change of direction or chord
};

/// How soft the object of a rule feels, from the ticks of one interval alone.
///
/// The hand knows the object's shape at rest, and so how far below it it is, d; and the force F
/// that presses it back. Softness is how far one sinks in by a newton, by least squares through no
/// force at no depth:
///
///     softness = sum |F| d / sum |F|^2, m/N
///
/// of every kEach-th tick in which HIP is below the shape at rest and the force 0.05 N or more. On
/// a contact of stiffness K that is 1 / K and what the surface gives way by, less beside the ends
/// than at the vertex. Ticks do not say how soft the object was meant to be, and the columns of the
/// god-object are not read.
class SoftnessCues {
public:
    static constexpr int kEach = 5;

    /// @pre the protocol has a rule
    explicit SoftnessCues(const Protocol& protocol);

    /// The next ticks, in their order: of every kEach-th one force and depth, where HIP is inside.
    void add(std::span<const engine::TickRecord> ticks) noexcept;
    /// m/N; nothing if nothing was pressed.
    [[nodiscard]] std::optional<double> softness() const noexcept;

private:
    std::shared_ptr<const engine::Outline> rest_;  ///< kept alive for feet_
    engine::OutlineFeet feet_;
    double product_ = 0.0;  ///< of |F| and d, N m
    double squares_ = 0.0;  ///< of |F|, N^2
    int tick_ = 0;
};

/// How well each picture fits what a hand felt, from the ticks alone: for objects that differ in
/// more than curvature.
///
/// A hand that is pressed back by a force F on an object of stiffness K knows to be |F| / K below
/// the surface, where the force comes from. That is where the surface was felt:
///
///     s = HIP + F / K
///
/// Friction turns the force by atan(mu), and so moves s along the surface by mu |F_n| / K, 1 mm at
/// 2 N, 0.5 and 1000 N/m. Every kEach-th tick with 0.05 N or more counts. The misfit of a picture
/// is the root of the mean square of the distances from s to its outline, in space to its surface.
/// Ticks say neither which object it was nor where its closest points were: those columns are not
/// read.
class OutlineCues {
public:
    static constexpr int kEach = 5;  ///< 200 points a second: a hand goes 0.5 mm meanwhile

    /// @param pictures  place -> index into Protocol::objects
    OutlineCues(const Protocol& protocol, const std::vector<std::size_t>& pictures);

    /// The next ticks, in their order: every kEach-th one above kFeltForce is a point of the
    /// surface.
    void add(std::span<const engine::TickRecord> ticks) noexcept;
    void forget() noexcept;  ///< what was felt so far

    /// At least one point was felt since the start or forget().
    [[nodiscard]] bool felt() const noexcept { return points_ > 0.0; }
    /// By place, m; all 0 if nothing was felt.
    [[nodiscard]] std::vector<double> misfits() const;

private:
    std::vector<std::shared_ptr<const engine::Outline>> outlines_;  ///< kept alive for feet_
    std::vector<engine::OutlineFeet> feet_;
    std::vector<engine::SurfaceFeet> surfaces_;  ///< instead, of a study of surfaces
    std::vector<engine::SurfaceTrack> tracks_;   ///< of each surface
    std::vector<double> squares_;                ///< m^2, summed
    double softness_ = 0.0;                      ///< m/N
    double points_ = 0.0;
    int tick_ = 0;
};

}  // namespace palpate::protocols
