#pragma once

#include "engine/surface/surface_object.hpp"
#include "tests/figures/thesis/curve_tracker.hpp"

namespace palpate::figures {

using engine::SurfaceObject;
using engine::SurfacePlace;
using engine::Vec3;

/// Where a tracked point is: within a patch, on a border of one, or in a corner. The features of
/// the thesis' connectivity graph.
enum class SurfaceFeature : std::uint8_t { face, edge, corner };

/// What lives on from tick to tick. A plain value.
struct SurfaceTrackerState {
    SurfaceFeature feature = SurfaceFeature::face;
    std::size_t surface = 0;  ///< which of the object's
    double u = 0.0;
    double v = 0.0;
    bool edge_in_u = true;       ///< edge: u stands still there, and v runs along
    Vec3 last_hip{};             ///< m
    bool moving = false;         ///< last_hip holds a HIP
    std::uint64_t switches = 0;  ///< of the feature or the surface, so far
};

/// The tracked point.
struct TrackedSpot {
    Vec3 point{};                ///< m, world frame
    Vec3 normal{0.0, 0.0, 1.0};  ///< unit, outward
    double distance = 0.0;       ///< |h - point|, m
    double psi =
        0.0;  ///< length of the part of h - point along the surface, m: the error left over
};

/// Follows the closest point of HIP over surfaces that are joined, as the thesis does (2.1.2 and
/// 2.1.4):
///
///     u' = -K (S - h) . S_u,   v' = -K (S - h) . S_v                 feedback
///     ... + G^-1 (S_u . hip', S_v . hip'),  G the metric             feed_forward
///     (u, v) <- (u, v) - Phi^-1 ((S - h) . S_u, (S - h) . S_v)       newton
///
/// with a controller of (u, v), and a finite-state machine of features for the borders: a face is
/// left for an edge when its controller drives it out there, an edge for the face on whose side HIP
/// lies (past the plane that is square to the surface at the edge: the border of their Voronoi
/// regions), an edge for a corner at its end, and a corner for the edge or face along which HIP
/// lies. Neighbours are those of the object; it goes from one feature to the next in a step, and
/// knows nothing of nearer ones elsewhere.
///
/// K is in 1/(m^2 s) as in CurveTracker; a step is stable below K T = 2 over the larger eigenvalue
/// of the second derivatives of |S - h|^2 / 2. Where u and v run at different speeds, the slower
/// one lags.
class SurfaceTracker {
public:
    /// @param spec  feedback, feed_forward or newton; sub_steps and iterations as for a curve
    /// @throws std::invalid_argument for no object, another kind or a number out of range
    SurfaceTracker(std::shared_ptr<const SurfaceObject> object, const TrackerSpec& spec);

    /// A state at the nearest of 17 x 17 samples a surface. No allocation.
    [[nodiscard]] SurfaceTrackerState start(const Vec3& hip) const noexcept;

    /// One tick: HIP is now at `hip`, `dt` s after the last one. Input that is not finite changes
    /// nothing.
    TrackedSpot step(SurfaceTrackerState& state, const Vec3& hip, double dt) const noexcept;

    [[nodiscard]] const SurfaceObject& object() const noexcept { return *object_; }
    [[nodiscard]] const TrackerSpec& spec() const noexcept { return spec_; }

private:
    struct Slopes;
    void control(SurfaceTrackerState& s,
                 const Vec3& h,
                 const Vec3& speed,
                 double dt) const noexcept;
    void change_feature(SurfaceTrackerState& s, const Vec3& h) const noexcept;
    void leave_face(SurfaceTrackerState& s, const Vec3& h) const noexcept;
    void leave_edge(SurfaceTrackerState& s, const Vec3& h) const noexcept;
    void leave_corner(SurfaceTrackerState& s, const Vec3& h) const noexcept;
    [[nodiscard]] SurfacePlace place_of(const SurfaceTrackerState& s) const noexcept;
    void move_to(SurfaceTrackerState& s, const SurfacePlace& p) const noexcept;

    std::shared_ptr<const SurfaceObject> object_;
    TrackerSpec spec_;
};

/// Gain K, 1/(m^2 s), of loop gain `kappa` = K T max(largest eigenvalue of the metric) over 17 x 17
/// samples a surface; 2 is the limit on a plane.
/// @throws std::invalid_argument unless kappa and period are finite and > 0 and the object has an
/// area
[[nodiscard]] double feedback_gain(const SurfaceObject& object, double kappa, double period);

}  // namespace palpate::figures
