#pragma once

#include <algorithm>
#include <cstdint>

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// What a held, sampled contact gave the user, episode by episode, J.
///
/// Over an episode of contact, work = sum F_k . (h_k+1 - h_k) is done on the user by forces held
/// for a tick. Sampling alone may give away leak = K/2 sum |h_k+1 - h_k|^2, which a device with b
/// >= K T / 2 takes up; the step that entered the contact counts too (for a scene that begins
/// inside, the energy of its first stretch, |F|^2 / 2K). The law of friction adds nothing:
///
///     balance = work - leak <= 0                       from E = K/2 |GO - HIP|^2, which it never
///     raises
///
/// to rounding, whatever the path and mu(t). An object that yields keeps energy between episodes
/// and gives back in one what another left there: their balances add up, from its rest at the first
/// of them on, and the sum at the end of each is at most 0. What is above 0 was made by something
/// else: the vertex slew's cap, a damper with B < 0, a defect.
template <int D>
class EnergyLedger {
public:
    /// @param stiffness  K, N/m, > 0
    /// @param yields     the object keeps energy between episodes, which add up
    explicit EnergyLedger(double stiffness, bool yields = false)
        : half_(0.5 * stiffness), yields_(yields) {}

    /// The next tick: HIP, the force held from it on, and whether there is contact.
    void add(const Vec<D>& hip, const Vec<D>& force, bool touching) noexcept {
        const Vec<D> step = started_ ? hip - hip_ : Vec<D>{};
        const double leak = half_ * glm::dot(step, step);
        if (touching_) {
            balance_ += glm::dot(force_, step) - leak;
        } else if (touching) {
            ++episodes_;
            balance_ += started_ ? -leak : -glm::dot(force, force) / (4.0 * half_);
        }
        if (touching_ && !touching) {
            note();
        }
        started_ = true;
        touching_ = touching;
        hip_ = hip;
        force_ = force;
    }

    /// Episodes of contact begun so far: times that HIP came into contact.
    [[nodiscard]] std::int64_t episodes() const noexcept { return episodes_; }
    /// Largest balance of an episode (if the object yields: of all up to one), the running one
    /// included, J; 0 before the first.
    [[nodiscard]] double worst() const noexcept {
        if (!touching_) {
            return worst_;
        }
        return episodes_ == 1 ? balance_ : std::max(worst_, balance_);
    }

private:
    void note() noexcept {
        worst_ = episodes_ == 1 ? balance_ : std::max(worst_, balance_);
        balance_ = yields_ ? balance_ : 0.0;
    }

    double half_;
    bool yields_;
    bool started_ = false;
    bool touching_ = false;
    Vec<D> hip_{};
    Vec<D> force_{};
    double balance_ = 0.0;
    double worst_ = 0.0;
    std::int64_t episodes_ = 0;
};

}  // namespace palpate::engine
