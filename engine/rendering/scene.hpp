#pragma once

#include <memory>

#include "engine/friction/god_object.hpp"
#include "engine/friction/stribeck.hpp"
#include "engine/rendering/mode.hpp"

namespace palpate::engine {

/// What is to be felt, as chosen by an experimenter. SI.
struct SceneSpec {
    double stiffness = 1000.0;  ///< K, N/m, > 0
    double period = 0.001;      ///< T, s, > 0
    Friction friction{};
    Slew slew{};
};

/// What lives on from tick to tick. A plain value: copying it copies the contact.
struct ContactState {
    bool touching = false;
    bool started = false;  ///< a first HIP was seen
    Place place{};         ///< where the GO is
    double theta = 1.0;    ///< Stribeck state: 1 static, 0 dynamic
    Vec2 last_hip{};       ///< m
};

/// One tick's answer. Frame: the object's; the force is the one on the user.
struct Contact {
    Mode mode = Mode::free;
    ClosestPoint cp{};              ///< global closest point of HIP
    Place place{};                  ///< of the GO
    Vec2 go{};                      ///< m
    Vec2 force{};                   ///< K (GO - HIP), N
    double normal_force = 0.0;      ///< F . n at the GO, N, >= 0
    double tangential_force = 0.0;  ///< F . t at the GO, N, t = direction of travel
    double mu = 0.0;                ///< coefficient in force during this tick, 0 while free
    bool slewed = false;            ///< the vertex slew held the GO back in this tick
    bool refused = false;           ///< HIP was not finite: force zero, contact ended
};

/// A scene compiled once into the tick it needs: with or without friction, with or without slew.
///
/// The law is GOS ("god-object spring"): F = K (GO - HIP), always; friction decides only where the GO
/// may stay (Stretch in engine/friction/friction_law.hpp). Why it is safe: moving the GO along the
/// surface in the direction of the tangential stretch never raises E = K/2 |GO - HIP|^2, so that
/// F_k . (h_k+1 - h_k) <= E_k - E_k+1 + K/2 |h_k+1 - h_k|^2 for any mu(t) >= 0. Held over a tick, the
/// renderer asks of the device what a frictionless wall asks: b >= K T / 2 (thesis eq. 1.1).
class Scene {
public:
    /// @throws std::invalid_argument for values out of range: which one, the value, what to give
    Scene(std::shared_ptr<const Outline> outline, const SceneSpec& spec);

    /// The contact after HIP moved to `hip`. No allocation, no lock; bit-reproducible.
    [[nodiscard]] Contact tick(ContactState& state, const Vec2& hip) const noexcept {
        return (this->*step_)(state, hip);
    }

    [[nodiscard]] const Outline& outline() const noexcept { return *outline_; }
    [[nodiscard]] const SceneSpec& spec() const noexcept { return spec_; }
    [[nodiscard]] const StribeckDecay& decay() const noexcept { return decay_; }
    /// The same scene with decay constants recorded earlier, for a replay to the bit.
    void restore_decay(const StribeckDecay& recorded) noexcept { decay_ = recorded; }

private:
    template <bool HasFriction, bool HasSlew>
    Contact step(ContactState& state, const Vec2& hip) const noexcept;
    template <bool HasFriction>
    [[nodiscard]] Contact render(const Walk& walk, const Vec2& hip, double mu) const noexcept;

    std::shared_ptr<const Outline> outline_;
    SceneSpec spec_;
    OutlineFeet feet_;
    StribeckDecay decay_;
    Contact (Scene::*step_)(ContactState&, const Vec2&) const noexcept;
};

}  // namespace palpate::engine
