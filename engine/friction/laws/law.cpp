#include "engine/friction/laws/law.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/base/text.hpp"
#include "engine/friction/laws/bristle_laws.hpp"
#include "engine/friction/laws/rate_laws.hpp"
#include "engine/friction/laws/snags.hpp"

namespace palpate::engine {
namespace {

constexpr const LawTraits* kAll[]{
    &kCoulombSign, &kViscous,         &kStiction, &kStribeck,   &kKarnopp,          &kDahl,
    &kBristle,     &kResetIntegrator, &kLuGre,    &kLuGreEuler, &kHaywardArmstrong, &kFrictionCone,
    &kSnags,
};

LawTask checked(const LawSpec& spec, const Friction& friction, double stiffness, double period) {
    const auto finite_from_zero = [](double v) {
        return std::isfinite(v) && v >= 0.0;
    };
    const auto positive = [](double v) {
        return std::isfinite(v) && v > 0.0;
    };
    require(finite_from_zero(friction.mu_d), "mu_d", friction.mu_d, "give 0 or more");
    require(std::isfinite(friction.mu_s) && friction.mu_s >= friction.mu_d, "mu_s", friction.mu_s,
            "give a finite value not below mu_d");
    require(positive(period), "tick period", period, "give seconds above 0");
    const double own = spec.stiffness == 0.0 ? stiffness : spec.stiffness;
    require(positive(own), "tangential stiffness", own, "give N/m above 0, or 0 for the object's");
    require(finite_from_zero(spec.viscosity), "viscosity", spec.viscosity, "give N s/m");
    require(finite_from_zero(spec.bristle_damping), "bristle damping", spec.bristle_damping,
            "give N s/m");
    require(positive(spec.stribeck_speed), "Stribeck speed", spec.stribeck_speed,
            "give m/s above 0");
    require(positive(spec.smoothing_speed), "smoothing speed", spec.smoothing_speed,
            "give m/s above 0");
    require(positive(spec.stick_speed), "stick speed", spec.stick_speed, "give m/s above 0");
    require(finite_from_zero(spec.exponent) && spec.exponent <= 3.0, "exponent", spec.exponent,
            "give 0 to 3");
    require(finite_from_zero(spec.stick_share) && spec.stick_share <= 0.99, "stick share",
            spec.stick_share, "give 0 to 0.99");
    require(spec.bristles >= 1 && spec.bristles <= kMaxBristles, "bristles", spec.bristles,
            "give 1 to 64");
    require(positive(spec.snag_spacing), "snag spacing", spec.snag_spacing, "give m above 0");
    const int max = spec.traits == nullptr ? 0 : spec.traits->max_mu_s;
    require(max == 0 || max * friction.mu_d >= friction.mu_s, "mu_d", friction.mu_d,
            ("give this law at least mu_s / " + std::to_string(max)).c_str());
    return {.spec = spec,
            .mu_s = friction.mu_s,
            .mu_d = friction.mu_d,
            .stiffness = own,
            .period = period};
}

}  // namespace

std::span<const LawTraits* const> all_laws() noexcept {
    return kAll;
}

const LawTraits* law_named(std::string_view word) noexcept {
    const auto* found = std::ranges::find(kAll, word, &LawTraits::word);
    return found == std::end(kAll) ? nullptr : *found;
}

double euler_limit(double stiffness, double load, double mu_d, double period) noexcept {
    return 2.0 * mu_d * load / (stiffness * period);
}

FrictionLaw::FrictionLaw(const LawSpec& spec,
                         const Friction& friction,
                         double stiffness,
                         double period)
    : task_(checked(spec, friction, stiffness, period)),
      step_(spec.traits == nullptr ? &FrictionLaw::none : spec.traits->step) {}

}  // namespace palpate::engine
