#pragma once

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// Coefficients of one stick-slip friction set with Stribeck transition.
struct Friction {
    double mu_s = 0.0;  ///< static coefficient, >= mu_d
    double mu_d = 0.0;  ///< dynamic coefficient, >= 0
    /// s, >= 0; time constant of the fall to mu_d while slipping, 0: at once
    double tau_slip = 0.0;
    /// s, >= 0; time constant of the recovery to mu_s while stuck, 0: at once
    double tau_heal = 0.0;

    /// There is no friction.
    [[nodiscard]] bool none() const noexcept { return mu_s == 0.0; }
};

/// The stretch r = HIP - GO seen from the god-object's own frame, in D dimensions.
///
/// The god-object spring law ("GOS"): the force is always K (GO - HIP), and friction only decides
/// where the GO may stay. It stays while the stretch lies in the friction cone of its own normal,
/// |tangential| <= mu * load. 2-D and 3-D differ in nothing but D.
template <int D>
struct Stretch {
    Vec<D> tangential{};  ///< r without its normal part, m
    double length = 0.0;  ///< |tangential|, m
    double load = 0.0;    ///< -r . n, m: penetration along the normal, > 0 inside
};

/// `r` = HIP - GO seen from the frame of a god-object. @param normal  unit, outward
template <int D>
[[nodiscard]] Stretch<D> stretch(const Vec<D>& r, const Vec<D>& normal) noexcept {
    Stretch<D> s;
    s.load = -glm::dot(r, normal);
    s.tangential = r + s.load * normal;
    s.length = glm::length(s.tangential);
    return s;
}

/// Tangential stretch the contact may keep at coefficient mu: the radius of the cone, m.
/// Without friction the cone is a line, and mu is not even read.
template <bool HasFriction>
[[nodiscard]] constexpr double cone_radius([[maybe_unused]] double mu,
                                           [[maybe_unused]] double load) noexcept {
    if constexpr (HasFriction) {
        return load > 0.0 ? mu * load : 0.0;
    } else {
        return 0.0;
    }
}

/// mu between its static (theta = 1) and dynamic (theta = 0) value.
[[nodiscard]] constexpr double coefficient(const Friction& friction, double theta) noexcept {
    return friction.mu_d + (friction.mu_s - friction.mu_d) * theta;
}

/// How much of the Stribeck state theta survives one tick. Needs exp, so it is computed once a
/// scene (stribeck_decay, called when a scene is compiled) and kept with the session: exp differs
/// between machines.
struct StribeckDecay {
    double slip = 0.0;  ///< exp(-T / tau_slip), 0 when tau_slip = 0
    double heal = 0.0;  ///< exp(-T / tau_heal), 0 when tau_heal = 0
};

/// @param period T, s, > 0
[[nodiscard]] StribeckDecay stribeck_decay(const Friction& friction, double period) noexcept;

/// theta after one tick: relaxes to 0 while slipping and to 1 while stuck. Exact for any T.
[[nodiscard]] constexpr double next_theta(double theta,
                                          bool slipped,
                                          const StribeckDecay& decay) noexcept {
    return slipped ? theta * decay.slip : 1.0 + (theta - 1.0) * decay.heal;
}

}  // namespace palpate::engine
