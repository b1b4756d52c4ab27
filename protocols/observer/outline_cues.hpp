#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/contact/closest_point.hpp"
#include "engine/realtime/tick_record.hpp"
#include "engine/surface/surface_closest.hpp"
#include "protocols/protocol/protocol.hpp"

namespace palpate::protocols {

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
