#include <algorithm>
#include <array>

#include "protocols/file/keys.hpp"

namespace palpate::protocols {
namespace {

using enum Need;

/// A number of a law of its own.
template <auto Member>
Slot own(void* record) {
    return slot_of(record_at<FrictionSpec>(record).own.*Member);
}

using engine::LawSpec;

// clang-format off
constexpr Key kFriction[]{
    {.name = "name", .slot = at<&FrictionSpec::name>, .need = required,
     .meaning = "names the friction in the database"},
    {.name = "law", .slot = at<&FrictionSpec::law>, .need = required,
     .meaning = "frictionless, gos (stick and slip), or [another law](#laws-of-friction); each reads keys of its own"},
    {.name = "mu_s", .slot = at<&FrictionSpec::mu_s>, .need = by_law, .range = {0, 10, true},
     .meaning = "static coefficient"},
    {.name = "mu_d", .slot = at<&FrictionSpec::mu_d>, .need = by_law, .range = {0, 10},
     .meaning = "dynamic coefficient, at most mu_s"},
    {.name = "tau_slip_ms", .slot = at<&FrictionSpec::tau_slip>, .need = by_law_optional, .range = {0, 10000}, .per_si = 1000,
     .meaning = "time constant from mu_s to mu_d while slipping; 0: at once"},
    {.name = "tau_heal_ms", .slot = at<&FrictionSpec::tau_heal>, .need = by_law_optional, .range = {0, 10000}, .per_si = 1000,
     .meaning = "time constant back to mu_s while stuck; 0: at once"},
    {.name = "tangential_stiffness_n_per_m", .slot = own<&LawSpec::stiffness>, .need = by_law_optional, .range = {0, 20000}, .late = true,
     .meaning = "of a law's own spring along the surface, at most stiffness_n_per_m; 0: the same"},
    {.name = "viscous_n_s_per_m", .slot = own<&LawSpec::viscosity>, .need = by_law_optional, .range = {0, 100}, .late = true,
     .meaning = "damper along the surface; the device must damp more"},
    {.name = "bristle_damping_n_s_per_m", .slot = own<&LawSpec::bristle_damping>, .need = by_law_optional, .range = {0, 100}, .late = true,
     .meaning = "damper of the law's own spring; the device must damp more"},
    {.name = "stribeck_speed_mm_per_s", .slot = own<&LawSpec::stribeck_speed>, .need = by_law_optional, .range = {0, 10000, true}, .per_si = 1000, .late = true,
     .meaning = "from mu_s at rest to mu_d well above this speed"},
    {.name = "smoothing_speed_mm_per_s", .slot = own<&LawSpec::smoothing_speed>, .need = by_law_optional, .range = {0, 10000, true}, .per_si = 1000, .late = true,
     .meaning = "over which friction turns with the motion"},
    {.name = "stick_speed_mm_per_s", .slot = own<&LawSpec::stick_speed>, .need = by_law_optional, .range = {0, 10000, true}, .per_si = 1000, .late = true,
     .meaning = "below it a hand counts as resting"},
    {.name = "dahl_exponent", .slot = own<&LawSpec::exponent>, .need = by_law_optional, .range = {0, 3}, .late = true,
     .meaning = "alpha of Dahl's law"},
    {.name = "stick_share", .slot = own<&LawSpec::stick_share>, .need = by_law_optional, .range = {0, 0.99}, .late = true,
     .meaning = "share of the friction below which nothing slips"},
    {.name = "bristles", .slot = own<&LawSpec::bristles>, .need = by_law_optional, .range = {1, engine::kMaxBristles}, .late = true,
     .meaning = "number of bonds"},
    {.name = "snag_spacing_mm", .slot = own<&LawSpec::snag_spacing>, .need = by_law_optional, .range = {0, 1000, true}, .per_si = 1000, .late = true,
     .meaning = "one snag, at a random place, in each such length of the outline"},
    {.name = "law_seed", .slot = own<&LawSpec::seed>, .need = by_law_optional, .range = {0, kMaxSeed}, .late = true,
     .meaning = "of bristles and snags: what is random about them is the same in every trial"},
};
// clang-format on

constexpr std::array<std::string_view, 2> kBoth{"mu_s", "mu_d"};
constexpr std::array<std::string_view, 1> kDynamic{"mu_d"};
constexpr std::array<std::string_view, 2> kViscous{"mu_d", "viscous_n_s_per_m"};
constexpr std::array<std::string_view, 2> kTimes{"tau_slip_ms", "tau_heal_ms"};
constexpr std::array<std::string_view, 1> kSpring{"tangential_stiffness_n_per_m"};
constexpr std::array<std::string_view, 2> kMap{"stribeck_speed_mm_per_s",
                                               "smoothing_speed_mm_per_s"};
constexpr std::array<std::string_view, 2> kKarnopp{"tangential_stiffness_n_per_m",
                                                   "stick_speed_mm_per_s"};
constexpr std::array<std::string_view, 2> kDahl{"tangential_stiffness_n_per_m", "dahl_exponent"};
constexpr std::array<std::string_view, 3> kBristles{"tangential_stiffness_n_per_m", "bristles",
                                                    "law_seed"};
constexpr std::array<std::string_view, 2> kReset{"tangential_stiffness_n_per_m",
                                                 "bristle_damping_n_s_per_m"};
constexpr std::array<std::string_view, 4> kLuGre{"tangential_stiffness_n_per_m",
                                                 "bristle_damping_n_s_per_m", "viscous_n_s_per_m",
                                                 "stribeck_speed_mm_per_s"};
constexpr std::array<std::string_view, 2> kAdhesion{"tangential_stiffness_n_per_m", "stick_share"};
constexpr std::array<std::string_view, 3> kSnags{"tangential_stiffness_n_per_m", "snag_spacing_mm",
                                                 "law_seed"};

constexpr LawKeys kLawKeys[]{
    {"frictionless", {}, {}},
    {"gos", kBoth, kTimes},
    {"coulomb", kDynamic, {}},
    {"coulomb_sign", kDynamic, {}},
    {"viscous", kViscous, {}},
    {"stiction", kBoth, kSpring},
    {"stribeck", kBoth, kMap},
    {"karnopp", kBoth, kKarnopp},
    {"dahl", kDynamic, kDahl},
    {"bristle", kBoth, kBristles},
    {"reset_integrator", kBoth, kReset},
    {"lugre", kBoth, kLuGre},
    {"lugre_euler", kBoth, kLuGre},
    {"hayward_armstrong", kDynamic, kAdhesion},
    {"friction_cone", kBoth, kSpring},
    {"snags", kBoth, kSnags},
};

bool has(WordList words, std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

template <>
constinit const Keys KeysOf<FrictionSpec>::value = kFriction;

bool LawKeys::needs(std::string_view key) const {
    return has(required, key);
}

bool LawKeys::reads(const Key& key) const {
    const bool by_law = key.need == Need::by_law || key.need == Need::by_law_optional;
    return !by_law || needs(key.name) || has(optional, key.name);
}

std::span<const LawKeys> friction_laws() noexcept {
    return kLawKeys;
}

const LawKeys* keys_of_law(std::string_view law) noexcept {
    const auto* found = std::find_if(std::begin(kLawKeys), std::end(kLawKeys),
                                     [&](const LawKeys& one) { return one.law == law; });
    return found == std::end(kLawKeys) ? nullptr : found;
}

}  // namespace palpate::protocols
