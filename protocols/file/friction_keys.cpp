#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "engine/friction/laws/law.hpp"
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
    {.name = "tangential_stiffness_n_per_m", .slot = own<&LawSpec::stiffness>, .need = by_law_optional, .range = {0, 20000},
     .meaning = "of a law's own spring along the surface, at most stiffness_n_per_m; 0: the same"},
    {.name = "viscous_n_s_per_m", .slot = own<&LawSpec::viscosity>, .need = by_law_optional, .range = {0, 100},
     .meaning = "damper along the surface; the device must damp more"},
    {.name = "bristle_damping_n_s_per_m", .slot = own<&LawSpec::bristle_damping>, .need = by_law_optional, .range = {0, 100},
     .meaning = "damper of the law's own spring; the device must damp more"},
    {.name = "stribeck_speed_mm_per_s", .slot = own<&LawSpec::stribeck_speed>, .need = by_law_optional, .range = {0, 10000, true}, .per_si = 1000,
     .meaning = "from mu_s at rest to mu_d well above this speed"},
    {.name = "smoothing_speed_mm_per_s", .slot = own<&LawSpec::smoothing_speed>, .need = by_law_optional, .range = {0, 10000, true}, .per_si = 1000,
     .meaning = "over which friction turns with the motion"},
    {.name = "stick_speed_mm_per_s", .slot = own<&LawSpec::stick_speed>, .need = by_law_optional, .range = {0, 10000, true}, .per_si = 1000,
     .meaning = "below it a hand counts as resting"},
    {.name = "dahl_exponent", .slot = own<&LawSpec::exponent>, .need = by_law_optional, .range = {0, 3},
     .meaning = "alpha of Dahl's law"},
    {.name = "stick_share", .slot = own<&LawSpec::stick_share>, .need = by_law_optional, .range = {0, 0.99},
     .meaning = "share of the friction below which nothing slips"},
    {.name = "bristles", .slot = own<&LawSpec::bristles>, .need = by_law_optional, .range = {1, engine::kMaxBristles},
     .meaning = "number of bonds"},
    {.name = "snag_spacing_mm", .slot = own<&LawSpec::snag_spacing>, .need = by_law_optional, .range = {0, 1000, true}, .per_si = 1000,
     .meaning = "one snag, at a random place, in each such length of the outline"},
    {.name = "law_seed", .slot = own<&LawSpec::seed>, .need = by_law_optional, .range = {0, kMaxSeed},
     .meaning = "of bristles and snags: what is random about them is the same in every trial"},
};
// clang-format on

/// Whether it is the number of the key, whatever its unit.
bool is_number_of(std::string_view key, std::string_view number) {
    return !number.empty() && key.starts_with(number) &&
           (key.size() == number.size() || key[number.size()] == '_');
}

std::vector<LawKeys> all_law_keys() {
    std::vector<LawKeys> all{{.law = "frictionless", .rubs = false, .sticks = false},
                             {.law = "gos", .relaxes = true},
                             {.law = "coulomb", .sticks = false}};
    for (const engine::LawTraits* const own : engine::all_laws()) {
        all.push_back({.law = own->word, .sticks = own->sticks, .own = own});
    }
    return all;
}

}  // namespace

template <>
constinit const Keys KeysOf<FrictionSpec>::value = kFriction;

bool LawKeys::needs(std::string_view key) const {
    return (rubs && key == "mu_d") || (sticks && key == "mu_s") ||
           (own != nullptr && own->needs_first && is_number_of(key, own->reads.front()));
}

bool LawKeys::reads(const Key& key) const {
    const bool by_law = key.need == Need::by_law || key.need == Need::by_law_optional;
    return !by_law || needs(key.name) || (relaxes && key.name.starts_with("tau_")) ||
           (own != nullptr && std::ranges::any_of(own->reads, [&](std::string_view number) {
                return is_number_of(key.name, number);
            }));
}

std::span<const LawKeys> friction_laws() {
    static const std::vector<LawKeys> kAll = all_law_keys();
    return kAll;
}

const LawKeys* keys_of_law(std::string_view law) {
    const auto all = friction_laws();
    const auto found = std::ranges::find(all, law, &LawKeys::law);
    return found == all.end() ? nullptr : &*found;
}

std::string wrong_law(std::string_view law, WordList more) {
    std::vector<std::string_view> words;
    for (const LawKeys& one : friction_laws()) {
        words.push_back(one.law);
    }
    if (more.empty()) {  // no protocol may have it
        std::erase(words, "lugre_euler");
    }
    words.insert(words.end(), more.begin(), more.end());
    return fmt::format("law is {}, give one of {}{}", shown(std::string(law)),
                       fmt::join(words, ", "), suggestion(law, words, ""));
}

}  // namespace palpate::protocols
