#include "protocols/file/keys.hpp"

#include <array>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "engine/math/elementary.hpp"
#include "protocols/file/object_tables.hpp"

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

constexpr double kDegrees = 180.0 / engine::kPi;  // of a radian

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
    Key<ApparatusSpec>{.name = "device", .member = &ApparatusSpec::device, .late = true,
                       .meaning = "of real sessions; pilots and simulations may use another"},
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
    Key<ObjectSpec>{.name = "curvature_per_m", .member = &ObjectSpec::curvature, .need = two_curve, .lowest = -1000, .highest = 1000,
                    .meaning = "signed curvature of both curves: above 0 convex, 0 straight, below 0 concave"},
    Key<ObjectSpec>{.name = "pictured", .member = &ObjectSpec::pictured,
                    .meaning = "false: a catch object, felt but not among the pictures"},
    Key<ObjectSpec>{.name = "size", .member = &ObjectSpec::size, .lowest = 0.01, .highest = 100, .late = true,
                    .meaning = "factor about the origin; curvatures are divided by it"},
    Key<ObjectSpec>{.name = "turn_deg", .member = &ObjectSpec::turn, .lowest = -360, .highest = 360, .per_si = kDegrees, .late = true,
                    .meaning = "then turned about the origin, anticlockwise"},
    Key<ObjectSpec>{.name = "offset_mm", .member = &ObjectSpec::offset, .lowest = -1000, .highest = 1000, .per_si = 1000, .late = true,
                    .meaning = "then moved by [x, y]"},
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

constexpr std::array kExclusion{
    Key<ExclusionSpec>{.name = "catch_correct_min", .member = &ExclusionSpec::catch_correct_min, .highest = 1,
                       .meaning = "least share of catch trials answered with the outermost picture on their side"},
    Key<ExclusionSpec>{.name = "share_correct_min", .member = &ExclusionSpec::share_correct_min, .highest = 1,
                       .meaning = "least share of correct main trials"},
    Key<ExclusionSpec>{.name = "timed_out_share_max", .member = &ExclusionSpec::timed_out_share_max, .highest = 1,
                       .meaning = "largest share of main trials that timed out"},
    Key<ExclusionSpec>{.name = "invalid_share_max", .member = &ExclusionSpec::invalid_share_max, .highest = 1,
                       .meaning = "largest share of answers in main trials that do not count"},
    Key<ExclusionSpec>{.name = "sessions_finished", .member = &ExclusionSpec::sessions_finished,
                       .meaning = "leave out who has a session that is not finished"},
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
    Key<DesignSpec>{.name = "friction_blocks", .member = &DesignSpec::friction_blocks, .late = true,
                    .meaning = "all frictions in each block; or one a block, there and back (abba) or always alike"},
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
    Key<TimingSpec>{.name = "guard_s", .member = &TimingSpec::guard, .highest = 2,
                    .meaning = "presses earlier than this after a screen appeared are no answer to it; 0: all are"},
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

constexpr std::array kMasking{
    Key<MaskingSpec>{.name = "noise", .member = &MaskingSpec::noise, .late = true,
                     .meaning = "on the headphones from the ready screen until the answer, over the sound of the motors"},
    Key<MaskingSpec>{.name = "level_db", .member = &MaskingSpec::level_db, .lowest = -60, .highest = 0, .late = true,
                     .meaning = "root mean square against full scale; how loud that is, measure on your headphones"},
};

constexpr std::array kInstructions{
    Key<InstructionTexts>{.name = "welcome", .member = &InstructionTexts::welcome, .text = Text::lines, .late = true,
                          .meaning = "before the first trial"},
    Key<InstructionTexts>{.name = "ready", .member = &InstructionTexts::ready, .text = Text::lines, .late = true,
                          .meaning = "before every trial"},
    Key<InstructionTexts>{.name = "explore", .member = &InstructionTexts::explore, .text = Text::lines, .late = true,
                          .meaning = "while an object is felt"},
    Key<InstructionTexts>{.name = "choose", .member = &InstructionTexts::choose, .text = Text::lines, .late = true,
                          .meaning = "the question above the answers"},
    Key<InstructionTexts>{.name = "break", .member = &InstructionTexts::rest, .text = Text::lines, .late = true,
                          .meaning = "in a break"},
    Key<InstructionTexts>{.name = "end", .member = &InstructionTexts::end, .text = Text::lines, .late = true,
                          .meaning = "after the last trial"},
};
// clang-format on

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
std::span<const Key<ExclusionSpec>> keys_of() {
    return kExclusion;
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

template <>
std::span<const Key<MaskingSpec>> keys_of() {
    return kMasking;
}
template <>
std::span<const Key<InstructionTexts>> keys_of() {
    return kInstructions;
}

}  // namespace palpate::protocols
