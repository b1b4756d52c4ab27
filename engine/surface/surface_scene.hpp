#pragma once

#include <cstdint>
#include <memory>

#include "engine/friction/friction_law.hpp"
#include "engine/rendering/approach.hpp"
#include "engine/rendering/mode.hpp"
#include "engine/rendering/scene.hpp"
#include "engine/surface/surface_closest.hpp"
#include "engine/surface/surface_slide.hpp"

namespace palpate::engine {

/// What is to be felt on a surface. SI.
struct SurfaceSceneSpec {
    /// As for an outline; edges and corners are vertices. Without compliance and law.
    SceneSpec contact{};

    /// The closest point is looked for in contact, too; else the last one stays: a third of the
    /// cost of a tick.
    bool look_in_contact = true;

    /// While HIP is farther from the surface than it can have moved since the last look, do not
    /// look: such a tick costs one comparison, and the forces are the same.
    bool skip_far = false;
};

/// What lives on from tick to tick. A plain value: copying it copies the contact.
struct SurfaceState {
    bool touching = false;
    SurfacePlace place{};   ///< of the GO while touching
    SurfaceFan fan{};       ///< in which the GO is, with a vertex slew
    double theta = 1.0;     ///< Stribeck state: 1 static, 0 dynamic
    bool started = false;   ///< last_hip is known
    Vec3 last_hip{};        ///< of the tick before, m
    Vec3 last_spring{};     ///< GO - HIP of the tick before as it was felt, m, zero out of contact
    SurfaceTrack track{};   ///< of the closest point, with its counters
    SurfaceClosest seen{};  ///< the last closest point that was looked for
    Approach approach{};    ///< whether a contact may begin
    Vec3 clear_at{};        ///< HIP then, m
    double clear2 = 0.0;    ///< squared distance from clear_at without contact, m^2; 0: unknown
    std::uint64_t skipped = 0;  ///< ticks that did not look
};

/// One tick's answer, world frame; the force is the one on the user.
struct SurfaceContact {
    Mode mode = Mode::free;
    SurfaceClosest cp{};  ///< global closest point of HIP; where it was not looked for the last one
    int surface = 0;      ///< the surface on which the GO is, counted from 0
    double go_u = 0.0;
    double go_v = 0.0;
    Vec3 go{};                      ///< m
    Vec3 normal{0.0, 0.0, 1.0};     ///< unit outward normal at the GO; only while in contact. In a
                                    ///< concave crease that between its sides' nearest to the force
    Vec3 force{};                   ///< K (GO - HIP) + B d(GO - HIP)/dt, N
    double normal_force = 0.0;      ///< force . normal, N, >= 0
    double tangential_force = 0.0;  ///< length of the rest, N, >= 0
    double mu = 0.0;                ///< coefficient in force during this tick, 0 while free
    bool vertex_slew = false;       ///< the budget of the vertex slew ended the walk of this tick
    bool outside_cone = false;      ///< the GO rests at an open border or under the slew
    bool in_crease = false;  ///< the GO rests in a concave crease, whose sides carry together
    bool on_flow = true;     ///< false: the GO's walk left its flow where that has no direction
    bool settled = true;     ///< false: the work limit of a tick ended the GO's walk
    bool skipped = false;    ///< out of reach: cp.distance is a lower bound
    bool refused = false;    ///< HIP was not finite or above 1e9 m: force zero, contact ended
};

/// A surface compiled once into the tick it needs: with or without friction.
///
/// The law is Scene's: F = K (GO - HIP); friction decides only where the GO may stay
/// (slide_on_surface). Moving the GO along the surface never raises K/2 |GO - HIP|^2, so that F_k .
/// (h_k+1 - h_k) <= E_k - E_k+1 + K/2 |h_k+1 - h_k|^2 for any mu(t) >= 0. At an open border the
/// tangential part is cut to mu times the normal force, which is outside of that proof. In a
/// concave crease its sides carry together, by the normal between theirs that lies nearest to the
/// force. With a damper B the device must give b > K
/// T / 2 + B, as for Scene; with a vertex slew a convex edge is the fan of its normals
/// (turn_in_fan), and what it cuts is outside of the proof as well.
class SurfaceScene {
public:
    /// @throws std::invalid_argument for a null surface or values out of range: which one, the
    ///                               value, what to give
    SurfaceScene(std::shared_ptr<const NurbsSurface> surface, const SurfaceSceneSpec& spec);
    SurfaceScene(std::shared_ptr<const NurbsSurface> surface, const SceneSpec& spec)
        : SurfaceScene(std::move(surface), SurfaceSceneSpec{.contact = spec}) {}
    /// Several surfaces, joined along their borders. @throws as SurfaceObject, and as above
    SurfaceScene(std::vector<std::shared_ptr<const NurbsSurface>> surfaces,
                 const SurfaceSceneSpec& spec);

    /// The contact after HIP moved to `hip`, m. No allocation, no lock; bit-reproducible.
    [[nodiscard]] SurfaceContact tick(SurfaceState& state, const Vec3& hip) const noexcept {
        return (this->*step_)(state, hip);
    }

    /// What is felt.
    [[nodiscard]] const SurfaceObject& object() const noexcept { return feet_.object(); }
    /// Surface k of it.
    [[nodiscard]] const NurbsSurface& surface(std::size_t k = 0) const noexcept {
        return object().surface(k);
    }
    /// Its closest points.
    [[nodiscard]] const SurfaceFeet& feet() const noexcept { return feet_; }
    /// The spec with the period of today.
    [[nodiscard]] const SurfaceSceneSpec& spec() const noexcept { return spec_; }
    /// What a replay has to be given.
    [[nodiscard]] const StribeckDecay& decay() const noexcept { return decay_; }
    /// The same scene at another tick period, for paths whose ticks are uneven. @param period  s, >
    /// 0
    void set_period(double period);
    /// The same scene with decay constants recorded earlier, for a replay to the bit.
    void restore_decay(const StribeckDecay& recorded) noexcept { decay_ = recorded; }

private:
    template <bool HasFriction>
    SurfaceContact step(SurfaceState& state, const Vec3& hip) const noexcept;
    template <bool HasFriction>
    SurfaceSlide move(SurfaceState& state,
                      const Vec3& from_hip,
                      const Vec3& hip,
                      double mu,
                      bool looks,
                      bool& slipped) const noexcept;
    [[nodiscard]] SurfaceContact free(SurfaceState& state, const Vec3& hip) const noexcept;
    void damp(SurfaceState& state,
              const SurfaceSlide& slide,
              SurfaceContact& contact) const noexcept;
    [[nodiscard]] SurfaceContact render(const SurfaceSlide& slide,
                                        const Vec3& h,
                                        double mu) const noexcept;

    SurfaceFeet feet_;
    SurfaceSceneSpec spec_;
    StribeckDecay decay_;
    SurfaceContact (SurfaceScene::*step_)(SurfaceState&, const Vec3&) const noexcept;
};

}  // namespace palpate::engine
