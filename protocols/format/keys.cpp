#include "protocols/format/keys.hpp"

#include <array>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

namespace palpate::protocols {
namespace {

/// N/ms: at 10 kHz this lets the largest force come in one tick; a higher limit would limit nothing.
constexpr double kMostSlew = 500;
/// m/s: a hand throws a ball like this. Faster, and the next reading counts as a jump anyway.
constexpr double kMostSpeed = 10;
/// J: 1 kg fallen from 1 m, no longer something to call passive.
constexpr double kMostEnergy = 10;
/// Ticks that are looked back on: more of them cannot be late.
constexpr double kLateWindow = 100;

constexpr double kMostSeed = 9223372036854775807.0;  // TOML integers have 63 bits and a sign

using enum Need;

// clang-format off
constexpr std::array kStudy{
    Key<Protocol>{.name = "id", .member = &Protocol::id, .need = required,
                  .meaning = "names the study in the database"},
    Key<Protocol>{.name = "title", .member = &Protocol::title, .need = required, .text = Text::free,
                  .meaning = "shown to the participant"},
    Key<Protocol>{.name = "seed", .member = &Protocol::seed, .need = required, .highest = kMostSeed,
                  .meaning = "the one seed: every order and every simulated number follows from it"},
    Key<Protocol>{.name = "participants", .member = &Protocol::participants, .lowest = 1, .highest = 10000,
                  .meaning = "planned number of participants"},
    Key<Protocol>{.name = "consent_required", .member = &Protocol::consent_required, .late = true,
                  .meaning = "no real session without a noted consent; left out of the hash while false"},
    Key<Protocol>{.name = "handedness", .member = &Protocol::handedness, .late = true,
                  .meaning = "of the participants asked for"},
    Key<Protocol>{.name = "language", .member = &Protocol::language, .late = true,
                  .meaning = "of the participant's screen"},
};

constexpr std::array kApparatus{
    Key<ApparatusSpec>{.name = "rate_hz", .member = &ApparatusSpec::rate_hz, .lowest = 1000, .highest = 10000,
                       .meaning = "rate of the force loop"},
    Key<ApparatusSpec>{.name = "stiffness_n_per_m", .member = &ApparatusSpec::stiffness, .highest = 20000, .above = true,
                       .meaning = "how hard the object is"},
    Key<ApparatusSpec>{.name = "damping_n_s_per_m", .member = &ApparatusSpec::damping, .highest = 100, .late = true,
                       .meaning = "damper of the contact beside its spring; the device must damp more"},
    Key<ApparatusSpec>{.name = "force_limit_n", .member = &ApparatusSpec::force_limit, .highest = 50, .above = true,
                       .meaning = "largest force; more is scaled down, its direction kept"},
    Key<ApparatusSpec>{.name = "force_ramp_s", .member = &ApparatusSpec::force_ramp, .highest = 5,
                       .meaning = "time for the force to come in and go out"},
    Key<ApparatusSpec>{.name = "vertex_slew_mm_per_s", .member = &ApparatusSpec::vertex_slew, .highest = 10000, .per_si = 1000,
                       .meaning = "how fast the contact may turn around a vertex; 0: at once"},
    Key<ApparatusSpec>{.name = "vertex_radius_mm", .member = &ApparatusSpec::vertex_radius, .highest = 100, .above = true, .per_si = 1000,
                       .meaning = "radius that a vertex counts as for that speed"},
    Key<ApparatusSpec>{.name = "start_mm", .member = &ApparatusSpec::start, .lowest = -1000, .highest = 1000, .per_si = 1000,
                       .meaning = "[x, y] where every trial starts, outside all objects"},
};

constexpr std::array kOutline{
    Key<OutlineSpec>{.name = "a_mm", .member = &OutlineSpec::a, .lowest = -1000, .highest = 1000, .per_si = 1000,
                     .meaning = "[x, y] of A, left end of the base line"},
    Key<OutlineSpec>{.name = "vertex_mm", .member = &OutlineSpec::vertex, .lowest = -1000, .highest = 1000, .per_si = 1000,
                     .meaning = "[x, y] of the vertex V, where the curves A-V and V-B meet"},
    Key<OutlineSpec>{.name = "b_mm", .member = &OutlineSpec::b, .lowest = -1000, .highest = 1000, .per_si = 1000,
                     .meaning = "[x, y] of B, right end of the base line"},
};

constexpr std::array kObject{
    Key<ObjectSpec>{.name = "name", .member = &ObjectSpec::name, .need = required,
                    .meaning = "names the object in the database"},
    Key<ObjectSpec>{.name = "curvature_per_m", .member = &ObjectSpec::curvature, .need = required, .lowest = -1000, .highest = 1000,
                    .meaning = "signed curvature of both curves: above 0 convex, 0 straight, below 0 concave"},
    Key<ObjectSpec>{.name = "pictured", .member = &ObjectSpec::pictured,
                    .meaning = "false: a catch object, felt but not among the pictures"},
};

constexpr std::array kFriction{
    Key<FrictionSpec>{.name = "name", .member = &FrictionSpec::name, .need = required,
                      .meaning = "names the friction in the database"},
    Key<FrictionSpec>{.name = "law", .member = &FrictionSpec::law, .need = required,
                      .meaning = "frictionless, or gos: stick and slip with the coefficients below"},
    Key<FrictionSpec>{.name = "mu_s", .member = &FrictionSpec::mu_s, .need = gos, .highest = 10, .above = true,
                      .meaning = "static coefficient"},
    Key<FrictionSpec>{.name = "mu_d", .member = &FrictionSpec::mu_d, .need = gos, .highest = 10,
                      .meaning = "dynamic coefficient, at most mu_s"},
    Key<FrictionSpec>{.name = "tau_slip_ms", .member = &FrictionSpec::tau_slip, .need = gos_optional, .highest = 10000, .per_si = 1000,
                      .meaning = "time constant from mu_s to mu_d while slipping; 0: at once"},
    Key<FrictionSpec>{.name = "tau_heal_ms", .member = &FrictionSpec::tau_heal, .need = gos_optional, .highest = 10000, .per_si = 1000,
                      .meaning = "time constant back to mu_s while stuck; 0: at once"},
};

constexpr std::array kSafety{
    Key<SafetySpec>{.name = "slew_limit_n_per_ms", .member = &SafetySpec::slew_limit, .highest = kMostSlew, .above = true, .per_si = 0.001,
                    .meaning = "how fast the force may change"},
    Key<SafetySpec>{.name = "speed_limit_m_per_s", .member = &SafetySpec::speed_limit, .highest = kMostSpeed, .above = true,
                    .meaning = "a faster handle switches the force off"},
    Key<SafetySpec>{.name = "late_in_a_row", .member = &SafetySpec::late_run, .highest = kLateWindow,
                    .meaning = "late ticks in a row that switch the force off; 0: none do"},
    Key<SafetySpec>{.name = "late_of_100", .member = &SafetySpec::late_share, .highest = kLateWindow,
                    .meaning = "late ticks among the last 100 that switch it off; 0: none do"},
    Key<SafetySpec>{.name = "energy_limit_j", .member = &SafetySpec::energy_limit, .highest = kMostEnergy, .above = true,
                    .meaning = "energy that the object may give beyond what it took"},
    Key<SafetySpec>{.name = "dead_man", .member = &SafetySpec::dead_man,
                    .meaning = "force only while the participant holds Space; Enter then ends the exploration"},
};

constexpr std::array kInvalid{
    Key<InvalidSpec>{.name = "late_share", .member = &InvalidSpec::late_share, .highest = 1,
                     .meaning = "share of late ticks above which a person's trial does not count; 1: never"},
    Key<InvalidSpec>{.name = "contact_min_s", .member = &InvalidSpec::contact_min, .highest = 3600,
                     .meaning = "a trial with less contact does not count; 0: all do"},
    Key<InvalidSpec>{.name = "path_min_mm", .member = &InvalidSpec::path_min, .highest = 100000, .per_si = 1000,
                     .meaning = "a trial with a shorter way of the handle does not count; 0: all do"},
    Key<InvalidSpec>{.name = "requeue_most", .member = &InvalidSpec::requeue_most, .highest = 100,
                     .meaning = "times that a trial which does not count or faulted is run again; 0: never"},
};

constexpr std::array kDesign{
    Key<DesignSpec>{.name = "repetitions", .member = &DesignSpec::repetitions, .need = factorial, .lowest = 1, .highest = 1000,
                    .meaning = "main trials of each object with each friction"},
    Key<DesignSpec>{.name = "max_run_object", .member = &DesignSpec::max_run_object, .highest = 1000,
                    .meaning = "same object in a row; 0: no limit"},
    Key<DesignSpec>{.name = "max_run_friction", .member = &DesignSpec::max_run_friction, .highest = 1000,
                    .meaning = "same friction in a row; 0: no limit"},
    Key<DesignSpec>{.name = "practice_repetitions", .member = &DesignSpec::practice_repetitions, .highest = 100,
                    .meaning = "practice trials of each condition; 0: none"},
    Key<DesignSpec>{.name = "catch_trials", .member = &DesignSpec::catch_trials, .highest = 1000,
                    .meaning = "trials with objects that are not pictured, among the main ones"},
    Key<DesignSpec>{.name = "break_every", .member = &DesignSpec::break_every, .highest = 10000,
                    .meaning = "trials between two breaks; 0: no breaks"},
    Key<DesignSpec>{.name = "blocks", .member = &DesignSpec::blocks, .lowest = 1, .highest = 1000, .late = true,
                    .meaning = "of the main trials, each balanced; a divisor of repetitions"},
    Key<DesignSpec>{.name = "order", .member = &DesignSpec::order, .late = true,
                    .meaning = "random within the run limits, or every condition after every condition once"},
};

constexpr std::array kTiming{
    Key<TimingSpec>{.name = "explore_min_s", .member = &TimingSpec::explore_min, .highest = 3600,
                    .meaning = "an answer is not taken before"},
    Key<TimingSpec>{.name = "explore_prompt_s", .member = &TimingSpec::explore_prompt, .highest = 3600, .above = true,
                    .meaning = "the screen asks for an answer"},
    Key<TimingSpec>{.name = "explore_timeout_s", .member = &TimingSpec::explore_timeout, .highest = 3600, .above = true,
                    .meaning = "the pictures come even without the done key"},
    Key<TimingSpec>{.name = "break_min_s", .member = &TimingSpec::break_min, .highest = 3600,
                    .meaning = "shortest break"},
    Key<TimingSpec>{.name = "gap_s", .member = &TimingSpec::gap, .highest = 60,
                    .meaning = "blank screen between two trials"},
};

constexpr std::array kObserver{
    Key<ObserverSpec>{.name = "noise_per_m", .member = &ObserverSpec::noise, .highest = 1000,
                      .meaning = "standard deviation of the felt curvature"},
    Key<ObserverSpec>{.name = "lapse", .member = &ObserverSpec::lapse, .highest = 1,
                      .meaning = "share of answers given at random"},
    Key<ObserverSpec>{.name = "force_weight", .member = &ObserverSpec::force_weight, .highest = 1,
                      .meaning = "weight of the force cue; the position cue has the rest"},
    Key<ObserverSpec>{.name = "bias_per_m_per_mu", .member = &ObserverSpec::bias_per_mu, .lowest = -1000, .highest = 1000,
                      .meaning = "curvature added per unit of felt friction"},
    Key<ObserverSpec>{.name = "noise_mu", .member = &ObserverSpec::noise_mu, .highest = 10, .late = true,
                      .meaning = "standard deviation of the felt friction coefficient"},
};
// clang-format on

/// What a key for an enumeration may say, nothing for other keys.
template <class Record>
std::span<const std::string_view> words_for(const Key<Record>& key) {
    return std::visit(
        [](auto member) -> std::span<const std::string_view> {
            using Member = std::decay_t<decltype(std::declval<Record>().*member)>;
            if constexpr (std::is_enum_v<Member>) {
                return words_of(Member{});
            } else {
                return {};
            }
        },
        key.member);
}

template <class Record>
std::string default_of(const Key<Record>& key) {
    if (key.need == required || key.need == factorial || key.need == gos) {
        return "required";
    }
    [[maybe_unused]] static const Record defaults{};
    return std::visit(
        [&key](auto member) -> std::string {
            const auto& value = defaults.*member;
            using Member = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<Member, engine::Vec2>) {
                return fmt::format("[{}, {}]", value.x * key.per_si, value.y * key.per_si);
            } else if constexpr (std::is_same_v<Member, double>) {
                return fmt::format("{}", value * key.per_si);
            } else if constexpr (std::is_enum_v<Member>) {
                return std::string(word_of(value));
            } else {
                return fmt::format("{}", value);
            }
        },
        key.member);
}

template <class Record>
std::string section(std::string_view heading) {
    std::string text = fmt::format("\n{}\n", heading);
    for (const Key<Record>& key : keys_of<Record>()) {
        text += fmt::format("    {:<22} {:<28} {:<11} {}\n", key.name, range_of(key),
                            default_of(key), key.meaning);
    }
    return text;
}

}  // namespace

template <>
std::span<const Key<Protocol>> keys_of() {
    return kStudy;
}
template <>
std::span<const Key<ApparatusSpec>> keys_of() {
    return kApparatus;
}
template <>
std::span<const Key<OutlineSpec>> keys_of() {
    return kOutline;
}
template <>
std::span<const Key<ObjectSpec>> keys_of() {
    return kObject;
}
template <>
std::span<const Key<FrictionSpec>> keys_of() {
    return kFriction;
}
template <>
std::span<const Key<SafetySpec>> keys_of() {
    return kSafety;
}
template <>
std::span<const Key<InvalidSpec>> keys_of() {
    return kInvalid;
}
template <>
std::span<const Key<DesignSpec>> keys_of() {
    return kDesign;
}
template <>
std::span<const Key<TimingSpec>> keys_of() {
    return kTiming;
}
template <>
std::span<const Key<ObserverSpec>> keys_of() {
    return kObserver;
}

template <class Record>
bool left_out(const Key<Record>& key, const Record& record) {
    static const Record defaults{};
    return key.late &&
           std::visit([&](auto member) { return record.*member == defaults.*member; }, key.member);
}
template bool left_out(const Key<Protocol>&, const Protocol&);
template bool left_out(const Key<ApparatusSpec>&, const ApparatusSpec&);
template bool left_out(const Key<OutlineSpec>&, const OutlineSpec&);
template bool left_out(const Key<ObjectSpec>&, const ObjectSpec&);
template bool left_out(const Key<FrictionSpec>&, const FrictionSpec&);
template bool left_out(const Key<SafetySpec>&, const SafetySpec&);
template bool left_out(const Key<InvalidSpec>&, const InvalidSpec&);
template bool left_out(const Key<DesignSpec>&, const DesignSpec&);
template bool left_out(const Key<TimingSpec>&, const TimingSpec&);
template bool left_out(const Key<ResponseSpec>&, const ResponseSpec&);
template bool left_out(const Key<AdaptiveSpec>&, const AdaptiveSpec&);
template bool left_out(const Key<RunSpec>&, const RunSpec&);
template bool left_out(const Key<ObserverSpec>&, const ObserverSpec&);

template <class Record>
std::string range_of(const Key<Record>& key) {
    if (std::holds_alternative<bool Record::*>(key.member)) {
        return "true or false";
    }
    if (std::holds_alternative<std::string Record::*>(key.member)) {
        return key.text == Text::name ? "letters a-z, digits and _" : "text";
    }
    if (const auto words = words_for(key); !words.empty()) {
        std::string text;
        for (std::size_t i = 0; i < words.size(); ++i) {
            text += fmt::format("{}\"{}\"",
                                i == 0                 ? ""
                                : i + 1 < words.size() ? ", "
                                                       : " or ",
                                words[i]);
        }
        return text;
    }
    if (key.highest == kMostSeed) {
        return "0 to 9223372036854775807";
    }
    return key.above ? fmt::format("above {}, at most {}", key.lowest, key.highest)
                     : fmt::format("{} to {}", key.lowest, key.highest);
}
template std::string range_of(const Key<Protocol>&);
template std::string range_of(const Key<ApparatusSpec>&);
template std::string range_of(const Key<OutlineSpec>&);
template std::string range_of(const Key<ObjectSpec>&);
template std::string range_of(const Key<FrictionSpec>&);
template std::string range_of(const Key<SafetySpec>&);
template std::string range_of(const Key<InvalidSpec>&);
template std::string range_of(const Key<DesignSpec>&);
template std::string range_of(const Key<TimingSpec>&);
template std::string range_of(const Key<ResponseSpec>&);
template std::string range_of(const Key<AdaptiveSpec>&);
template std::string range_of(const Key<RunSpec>&);
template std::string range_of(const Key<ObserverSpec>&);

std::string key_reference() {
    return fmt::format("format = {}\n", kFormat) + section<Protocol>("[study]") +
           section<ApparatusSpec>("[apparatus]") + section<OutlineSpec>("[outline]") +
           section<ObjectSpec>(fmt::format("[[object]]  once each, {} to {} of them pictured",
                                           kMinPictures, kMaxPictures)) +
           section<FrictionSpec>(fmt::format("[[friction]]  once each, 1 to {}", kMaxFrictions)) +
           section<SafetySpec>(
               "[safety]  left out of the study's hash as long as all are default") +
           section<InvalidSpec>("[invalid]  left out of the hash in the same way") +
           section<DesignSpec>("[design]") + section<TimingSpec>("[timing]") +
           section<ResponseSpec>("[response]  left out of the hash in the same way") +
           section<AdaptiveSpec>(
               "[procedure]  a rule that chooses by the answers, instead of [design]; beside these "
               "keys all "
               "of a procedure file\n             (palpate procedure --keys), with its tables as "
               "[procedure.model], [[procedure.staircase]], ...") +
           section<RunSpec>(fmt::format(
               "[[run]]  with [procedure]: the rule runs once for each, 1 to {}", kMaxRuns)) +
           section<ObserverSpec>("[observer]  of simulated sessions");
}

}  // namespace palpate::protocols
