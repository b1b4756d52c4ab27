#pragma once

#include <span>
#include <string_view>

#include "engine/friction/friction_law.hpp"
#include "engine/friction/laws/law_task.hpp"

namespace palpate::engine {

/// What is known of a law before it is felt.
struct LawTraits {
    LawKind kind = LawKind::none;
    std::string_view word;   ///< in files
    std::string_view paper;  ///< who published it
    bool sticks = false;     ///< reads mu_s beside mu_d
    /// Held for a tick it gives no more than its springs' leak of K/2 |dh|^2: the same proof as
    /// that of the god-object spring law, for it only ever lets its spring's anchor go towards HIP.
    /// On an object that is hollow by kappa the leak is that of K + |kappa| d K.
    bool passive = false;
    bool in_cone = false;   ///< |F_T| <= mu_s F_N on every tick
    bool creeps = false;    ///< drifts under an oscillating load that would not break it away
    bool chatters = false;  ///< its force jumps with the encoder's steps at low speed
};

/// Of all laws of this folder, in the order of LawKind, without `none`.
[[nodiscard]] std::span<const LawTraits> law_traits() noexcept;
/// @pre kind is not `none`
[[nodiscard]] const LawTraits& traits_of(LawKind kind) noexcept;
/// The law of a file's word; `none` for a word that is none of theirs.
[[nodiscard]] LawKind law_kind(std::string_view word) noexcept;

/// Speed from which on one explicit Euler step of LuGre's state overshoots further than it was off,
/// m/s: sigma_0 |v| T / g > 2, g = mu_d F_N at speed.
[[nodiscard]] double euler_limit(double stiffness,
                                 double load,
                                 double mu_d,
                                 double period) noexcept;

/// The law of one scene, compiled: one function, chosen once. A plain value.
class FrictionLaw {
public:
    FrictionLaw() = default;  ///< no law: step() gives no force
    /// @param stiffness  of the object, N/m, > 0     @param period  T, s, > 0
    /// @throws std::invalid_argument for a number out of range: which one, the value, what to give
    FrictionLaw(const LawSpec& spec, const Friction& friction, double stiffness, double period);

    /// One tick on. No allocation, no lock; finite for finite numbers, the same bits everywhere.
    [[nodiscard]] FrictionForce step(LawState& state, const Rub& rub) const noexcept {
        return step_(task_, state, rub);
    }
    /// The law wants to know where on the outline the contact is.
    [[nodiscard]] bool wants_place() const noexcept { return task_.spec.kind == LawKind::snags; }
    [[nodiscard]] const LawTask& task() const noexcept { return task_; }

private:
    using Step = FrictionForce (*)(const LawTask&, LawState&, const Rub&) noexcept;
    static FrictionForce none(const LawTask& /*task*/,
                              LawState& /*state*/,
                              const Rub& /*rub*/) noexcept {
        return {};
    }
    static Step step_of(LawKind kind) noexcept;

    LawTask task_{};
    Step step_ = &FrictionLaw::none;
};

}  // namespace palpate::engine
