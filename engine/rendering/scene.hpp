#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>

#include "engine/contact/certified_tracker.hpp"
#include "engine/deformation/soft_shape.hpp"
#include "engine/friction/friction_law.hpp"
#include "engine/friction/god_object.hpp"
#include "engine/friction/laws/law.hpp"
#include "engine/geometry/arc_length.hpp"
#include "engine/rendering/approach.hpp"
#include "engine/rendering/mode.hpp"

namespace palpate::engine {

/// What is to be felt, as chosen by an experimenter. SI.
struct SceneSpec {
    double stiffness = 1000.0;  ///< K, N/m, > 0: the spring of the virtual coupling
    double damping = 0.0;   ///< B, N s/m, >= 0: its damper; the device must then give b > K T/2 + B
    double period = 0.001;  ///< T, s, > 0
    Friction friction{};
    Slew slew{};
    /// Of friction from the literature, with mu_s and mu_d of `friction`; kind none: the god-object
    /// spring law.
    LawSpec law{};
    /// c, m/N, of an object of two curves that yields (engine/deformation/soft_shape.hpp): 0, none
    /// does, to kMaxCompliance. Without damper, slew and law from the literature.
    double compliance = 0.0;
};

/// The same spec, if all values are in range.
/// @throws std::invalid_argument for the first that is not: which one, the value, what to give
const SceneSpec& checked(const SceneSpec& spec);

/// mu counts as relaxed once theta is below this: 1e-3 of mu_s - mu_d is 0.2 mN at 1 N.
inline constexpr double kRelaxed = 1e-3;

/// What a tick in contact did: `slipped`, the GO moved; theta, the Stribeck state before the tick.
/// Without friction nothing sticks: a god-object that rests under a resting hand slips at speed 0.
template <bool HasFriction>
[[nodiscard]] Mode mode_of(bool slipped, double theta, const Friction& friction) noexcept {
    return !slipped && friction.mu_s > 0.0                                  ? Mode::stuck
         : HasFriction && theta > kRelaxed && friction.mu_s > friction.mu_d ? Mode::transition
                                                                            : Mode::slip;
}

/// Share of the clearance that may be used up before the next look; the rest is for rounding.
inline constexpr double kClearShare = 1.0 - 1e-12;

/// One tick's answer. Frame: the object's; the force is the one on the user.
struct Contact {
    Mode mode = Mode::free;
    Place place{};                  ///< of the GO
    Vec2 go{};                      ///< m; out of contact that of the last look: see shown()
    Vec2 force{};                   ///< K (GO - HIP) + B d(GO - HIP)/dt, and a law's friction, N
    double normal_force = 0.0;      ///< F . n at the GO, N, >= 0
    double tangential_force = 0.0;  ///< F . t at the GO, N, t = direction of travel
    double mu = 0.0;                ///< coefficient in force during this tick, 0 while free
    bool vertex_slew = false;       ///< the budget of the vertex slew ended the walk of this tick
    /// The GO stopped outside its cone (vertex slew, an open end): the force is cut to the cone.
    bool outside_cone = false;
    bool unproven = false;  ///< the walk was broken off: never seen
    bool refused = false;   ///< HIP was not finite: force zero, contact ended
    bool skipped = false;   ///< out of reach: nothing was computed
    bool began = false;     ///< a contact of its own, also where another ended in this tick

    /// An open end holds the GO outside of its cone.
    [[nodiscard]] bool held() const noexcept {
        return mode != Mode::free && outside_cone && !vertex_slew && !unproven;
    }
};

/// The spring of a god-object in its cone. Every member is named, for else all are set to zero
/// first.
[[nodiscard]] inline Contact pressed_by(const Walk& walk,
                                        const Vec2& hip,
                                        const Place& place,
                                        double k) noexcept {
    return {.mode = Mode::stuck,
            .place = place,
            .go = walk.point,
            .force = k * (walk.point - hip),
            .normal_force = k * walk.nu,
            .tangential_force = -k * walk.tau,
            .mu = 0.0,
            .vertex_slew = walk.out_of_budget,
            .outside_cone = walk.outside_cone,
            .unproven = walk.unproven,
            .refused = false,
            .skipped = false,
            .began = false};
}

/// The GO could not reach its cone in this tick: what the surface can carry where it is.
template <bool HasFriction>
void cut_to_cone(const Walk& walk, double k, Contact& contact) noexcept {
    const double load = std::max(walk.nu, 0.0);
    const double limit = cone_radius<HasFriction>(contact.mu, load);
    contact.normal_force = k * load;
    contact.tangential_force = k * std::clamp(-walk.tau, -limit, limit);
    contact.force = contact.normal_force * walk.normal + contact.tangential_force * walk.tangent;
}

/// A tick as it is written and drawn: out of contact the god-object is the closest point. A tick
/// out of reach does not look for it, so that what it answers is that of the last look.
/// @param closest  of the same HIP: Scene::closest()
[[nodiscard]] inline Contact shown(Contact contact, const ClosestPoint& closest) noexcept {
    if (contact.mode == Mode::free) {
        contact.place = closest.place;
        contact.go = closest.point;
    }
    return contact;
}

/// What a law of friction remembers of the contact.
struct FrictionMemory {
    LawState law{};
    Vec2 hip{};         ///< of the tick before, m
    Vec2 tangent{};     ///< along which friction has been held since; 0 in the first tick
    double blur = 0.0;  ///< of the tangent, rad: what the rounding of GO - HIP leaves open
};

/// What lives on from tick to tick. A plain value: copying it copies the contact.
struct ContactState {
    bool touching = false;
    bool started = false;  ///< a first HIP was seen
    GodObject go{};
    double theta = 1.0;         ///< Stribeck state: 1 static, 0 dynamic
    Vec2 last_hip{};            ///< m
    Vec2 last_spring{};         ///< GO - HIP of the tick before, m, zero out of contact
    Vec2 clear_from{};          ///< HIP of the last look, m
    double clear2 = 0.0;        ///< squared distance it may move before it could touch, m^2
    Contact away{};             ///< the answer of every tick out of reach, made at the last look
    TrackState track{};         ///< of the looks
    Approach approach{};        ///< whether a contact may begin
    std::uint64_t skipped = 0;  ///< ticks so far that were out of reach: a comparison
    FrictionMemory rubbing{};   ///< of scenes with a law of friction from the literature
    SoftState soft{};           ///< of scenes whose object yields
};

/// A scene compiled once into the tick it needs: with or without friction, slew and damper. In
/// contact the force needs the god-object alone; the closest point is looked for out of contact
/// only, and by closest(). Out of reach (the clearance of the last look minus the way since is > 0)
/// a tick is a comparison. A contact begins where HIP comes through the surface, never behind an
/// open end (Approach).
///
/// The law is GOS ("god-object spring"): F = K (GO - HIP), always; friction decides only where the
/// GO may stay (Stretch in engine/friction/friction_law.hpp). Why it is safe: moving the GO along
/// the surface in the direction of the tangential stretch never raises E = K/2 |GO - HIP|^2, so
/// that F_k . (h_k+1 - h_k) <= E_k - E_k+1 + K/2 |h_k+1 - h_k|^2 for any mu(t) >= 0. Held over a
/// tick, the renderer asks of the device what a frictionless wall asks: b >= K T / 2 (thesis eq.
/// 1.1).
///
/// A law of friction from the literature (engine/friction/laws) is felt on the frictionless
/// god-object: F = F_N n + F_T t there, F_T by the law from the load F_N and the travel of HIP
/// along the tangent t along which friction was held. So the held force works on just the travel
/// that the law knows of, and what the law gives on a line it gives on any curve. Unlike with GOS
/// the god-object is then the local closest point, and a stuck contact follows it around corners.
///
/// An object that yields moves under the spring of its contact, and the god-object stays on its
/// material (engine/rendering/soft_scene.cpp). The outline, and the closest point of closest(), are
/// those at rest.
class Scene {
public:
    /// @throws std::invalid_argument for values out of range: which one, the value, what to give
    Scene(std::shared_ptr<const Outline> outline, const SceneSpec& spec);

    /// The contact after HIP moved to `hip`. No allocation, no lock; bit-reproducible.
    [[nodiscard]] Contact tick(ContactState& state, const Vec2& hip) const noexcept {
        if (!state.touching) {
            const Vec2 moved = hip - state.clear_from;
            if (glm::dot(moved, moved) < state.clear2) {
                state.last_hip = hip;
                ++state.skipped;
                return state.away;
            }
        }
        return (this->*step_)(state, hip);
    }

    /// The global closest point of HIP, which no force in contact needs: for records and drawings.
    /// @param track  of these questions alone
    [[nodiscard]] ClosestPoint closest(TrackState& track, const Vec2& hip) const noexcept {
        return tracker_.track(track, hip);
    }

    /// GO - HIP as the energy observer counts it: of an object that yields as long as a spring K
    /// alone would be that stores what spring and curves do. 0 out of contact with what is at rest.
    [[nodiscard]] Vec2 spring(const ContactState& state,
                              const Contact& contact,
                              const Vec2& hip) const noexcept {
        const Vec2 stretch = contact.mode == Mode::free ? Vec2{} : contact.go - hip;
        return soft_ == nullptr ? stretch : soft_spring(state, stretch);
    }
    /// The object that yields; null: it is rigid.
    [[nodiscard]] const SoftShape* soft() const noexcept { return soft_.get(); }

    /// What is felt.
    [[nodiscard]] const Outline& outline() const noexcept { return *outline_; }
    /// The spec with the period of today.
    [[nodiscard]] const SceneSpec& spec() const noexcept { return spec_; }
    /// What a replay has to be given: see restore_decay().
    [[nodiscard]] const StribeckDecay& decay() const noexcept { return decay_; }
    /// The same scene at another tick period, for paths whose ticks are uneven. @param period  s, >
    /// 0
    void set_period(double period);
    /// The same scene with decay constants recorded earlier, for a replay to the bit.
    void restore_decay(const StribeckDecay& recorded) noexcept { decay_ = recorded; }

private:
    using Step = Contact (Scene::*)(ContactState&, const Vec2&) const noexcept;

    template <bool HasFriction, bool HasSlew, bool HasDamper>
    Contact step(ContactState& state, const Vec2& hip) const noexcept;
    template <bool HasFriction, bool HasSlew, bool HasDamper>
    Contact arc_step(ContactState& state, const Vec2& hip) const noexcept;
    template <bool HasFriction, bool HasSlew, bool HasDamper>
    Contact long_step(ContactState& state, const Vec2& hip) const noexcept;
    template <bool HasSlew>
    [[nodiscard]] double budget(const ContactState& state, const Vec2& hip) const noexcept;
    template <bool HasFriction, bool HasDamper>
    [[nodiscard]] Contact look(ContactState& state, const Vec2& from) const noexcept;
    template <bool HasFriction, bool HasDamper>
    [[nodiscard]] Contact felt(ContactState& state,
                               const Walk& walk,
                               const Vec2& hip,
                               double mu) const noexcept;
    template <bool HasFriction>
    void damp(ContactState& state, const Walk& walk, Contact& contact) const noexcept;
    void add_law();
    Contact rubbed(ContactState& state, const Vec2& hip) const noexcept;
    void add_softness();
    Contact yielding(ContactState& state, const Vec2& hip) const noexcept;
    bool meets(ContactState& state, const Vec2& from, Contact& contact) const noexcept;
    [[nodiscard]] bool enters(ContactState& state,
                              const ClosestPoint& cp,
                              const Vec2& from) const noexcept;
    [[nodiscard]] Contact waning(ContactState& state) const noexcept;
    [[nodiscard]] Contact pressed(ContactState& state,
                                  const Walk& walk,
                                  const Vec2& hip) const noexcept;
    [[nodiscard]] Vec2 soft_spring(const ContactState& state, const Vec2& stretch) const noexcept;
    [[nodiscard]] double along(const Place& place) const noexcept;
    [[nodiscard]] Contact free(ContactState& state, const ClosestPoint& cp) const noexcept;
    [[nodiscard]] Step step_for(const SceneSpec& spec) const noexcept;

    std::shared_ptr<const Outline> outline_;
    SceneSpec spec_;
    CertifiedTracker tracker_;
    ConeForms forms_;
    StribeckDecay decay_;
    Step step_;
    Step smooth_ = nullptr;  ///< the frictionless tick below a law's
    FrictionLaw law_;
    ArcLength lengths_;  ///< of the outline; for a law of its own
    double size_ = 0.0;  ///< no coordinate of the outline is larger, m; as lengths_
    std::shared_ptr<const SoftShape> soft_;
};

}  // namespace palpate::engine
