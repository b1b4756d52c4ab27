#pragma once

#include <span>
#include <string_view>

#include "engine/friction/friction_law.hpp"
#include "engine/friction/laws/law_task.hpp"

namespace palpate::engine {

/// Of all laws of this folder.
[[nodiscard]] std::span<const LawTraits* const> all_laws() noexcept;
/// The law of a file's word; null for a word that is none of theirs.
[[nodiscard]] const LawTraits* law_named(std::string_view word) noexcept;

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
    [[nodiscard]] bool wants_place() const noexcept {
        return task_.spec.traits != nullptr && task_.spec.traits->by_place;
    }
    [[nodiscard]] const LawTask& task() const noexcept { return task_; }

private:
    static FrictionForce none(const LawTask& /*task*/,
                              LawState& /*state*/,
                              const Rub& /*rub*/) noexcept {
        return {};
    }

    LawTask task_{};
    decltype(LawTraits::step) step_ = &FrictionLaw::none;
};

}  // namespace palpate::engine
