#include "engine/friction/laws/law.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/text.hpp"
#include "engine/friction/laws/bristle.hpp"
#include "engine/friction/laws/coulomb_sign.hpp"
#include "engine/friction/laws/dahl.hpp"
#include "engine/friction/laws/friction_cone.hpp"
#include "engine/friction/laws/hayward_armstrong.hpp"
#include "engine/friction/laws/karnopp.hpp"
#include "engine/friction/laws/lugre.hpp"
#include "engine/friction/laws/reset_integrator.hpp"
#include "engine/friction/laws/snags.hpp"
#include "engine/friction/laws/stiction.hpp"
#include "engine/friction/laws/stribeck_map.hpp"
#include "engine/friction/laws/viscous.hpp"

namespace palpate::engine {
namespace {

// clang-format off
constexpr LawTraits kTraits[]{
    {.kind = LawKind::coulomb_sign,      .word = "coulomb_sign",      .paper = "Coulomb 1785",               .in_cone = true, .creeps = true, .chatters = true},
    {.kind = LawKind::viscous,           .word = "viscous",           .paper = "Coulomb with a viscous term", .creeps = true, .chatters = true},
    {.kind = LawKind::stiction,          .word = "stiction",          .paper = "Morin 1833",                 .sticks = true, .in_cone = true, .chatters = true},
    {.kind = LawKind::stribeck,          .word = "stribeck",          .paper = "Stribeck 1902",              .sticks = true, .in_cone = true, .creeps = true, .chatters = true},
    {.kind = LawKind::karnopp,           .word = "karnopp",           .paper = "Karnopp 1985",               .sticks = true, .in_cone = true, .chatters = true},
    {.kind = LawKind::dahl,              .word = "dahl",              .paper = "Dahl 1968",                  .passive = true, .in_cone = true, .creeps = true},
    {.kind = LawKind::bristle,           .word = "bristle",           .paper = "Haessig & Friedland 1991",   .sticks = true, .passive = true, .in_cone = true},
    {.kind = LawKind::reset_integrator,  .word = "reset_integrator",  .paper = "Haessig & Friedland 1991",   .sticks = true, .in_cone = true},
    {.kind = LawKind::lugre,             .word = "lugre",             .paper = "Canudas de Wit et al. 1995", .sticks = true, .passive = true, .in_cone = true, .creeps = true},
    {.kind = LawKind::lugre_euler,       .word = "lugre_euler",       .paper = "Canudas de Wit et al. 1995", .sticks = true, .creeps = true},
    {.kind = LawKind::hayward_armstrong, .word = "hayward_armstrong", .paper = "Hayward & Armstrong 2000",   .passive = true, .in_cone = true},
    {.kind = LawKind::friction_cone,     .word = "friction_cone",     .paper = "Harwin & Melder 2002",       .sticks = true, .passive = true, .in_cone = true},
    {.kind = LawKind::snags,             .word = "snags",             .paper = "Mark et al. 1996",           .sticks = true, .in_cone = true, .chatters = true},
};
// clang-format on

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
    require(spec.kind != LawKind::bristle || 3.0 * friction.mu_d >= friction.mu_s, "mu_d",
            friction.mu_d, "give the law of bristles at least mu_s / 3");
    return {.spec = spec,
            .mu_s = friction.mu_s,
            .mu_d = friction.mu_d,
            .stiffness = own,
            .period = period};
}

}  // namespace

std::span<const LawTraits> law_traits() noexcept {
    return kTraits;
}

const LawTraits& traits_of(LawKind kind) noexcept {
    return kTraits[static_cast<std::size_t>(kind) - 1];
}

LawKind law_kind(std::string_view word) noexcept {
    const auto* found = std::find_if(std::begin(kTraits), std::end(kTraits),
                                     [&](const LawTraits& law) { return law.word == word; });
    return found == std::end(kTraits) ? LawKind::none : found->kind;
}

double euler_limit(double stiffness, double load, double mu_d, double period) noexcept {
    return 2.0 * mu_d * load / (stiffness * period);
}

FrictionLaw::FrictionLaw(const LawSpec& spec,
                         const Friction& friction,
                         double stiffness,
                         double period)
    : task_(checked(spec, friction, stiffness, period)), step_(step_of(spec.kind)) {}

FrictionLaw::Step FrictionLaw::step_of(LawKind kind) noexcept {
    switch (kind) {
        case LawKind::none:
            break;
        case LawKind::coulomb_sign:
            return coulomb_sign;
        case LawKind::viscous:
            return viscous;
        case LawKind::stiction:
            return stiction;
        case LawKind::stribeck:
            return stribeck_map;
        case LawKind::karnopp:
            return karnopp;
        case LawKind::dahl:
            return dahl;
        case LawKind::bristle:
            return bristle;
        case LawKind::reset_integrator:
            return reset_integrator;
        case LawKind::lugre:
            return lugre;
        case LawKind::lugre_euler:
            return lugre_euler;
        case LawKind::hayward_armstrong:
            return hayward_armstrong;
        case LawKind::friction_cone:
            return friction_cone;
        case LawKind::snags:
            return snags;
    }
    return &FrictionLaw::none;
}

}  // namespace palpate::engine
