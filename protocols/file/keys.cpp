#include "protocols/file/keys.hpp"

namespace palpate::protocols {
namespace {

/// N/ms: at 10 kHz this lets the largest force come in one tick; a higher limit would limit
/// nothing.
constexpr double kMaxSlew = 500;
/// m/s: a hand throws a ball like this. Faster, and the next reading counts as a jump anyway.
constexpr double kMaxSpeed = 10;
/// J: 1 kg fallen from 1 m, no longer something to call passive.
constexpr double kMaxEnergy = 10;
/// Ticks that are looked back on: more of them cannot be late.
constexpr double kLateWindow = 100;

/// Of what is varied, as the rule counts.
constexpr double kMaxStimulus = 1e10;

using engine::LawSpec;
using enum Need;

/// A number of a law of its own.
template <auto Member>
constexpr auto own = at<&FrictionSpec::own, Member>;

/// Rows of a table by the struct that it fills.
template <class Record>
constexpr int kRows = 0;

// clang-format off
template <>
constexpr Key kRows<Protocol>[]{
    {.name = "id", .slot = at<&Protocol::id>, .need = required,
     .meaning = "names the study in the database"},
    {.name = "title", .slot = at<&Protocol::title>, .need = required, .form = Form::free,
     .meaning = "of the study in reports and exports; the participant sees none, which might tell what is compared"},
    {.name = "seed", .slot = at<&Protocol::seed>, .need = required, .range = {0, kMaxSeed},
     .meaning = "the one seed: every order and every simulated number follows from it"},
    {.name = "participants", .slot = at<&Protocol::participants>, .range = {1, 10000},
     .meaning = "planned number of participants"},
    {.name = "consent_required", .slot = at<&Protocol::consent_required>,
     .meaning = "no real session without a noted consent"},
    {.name = "handedness", .slot = at<&Protocol::handedness>,
     .meaning = "of the participants asked for"},
    {.name = "reveal", .slot = at<&Protocol::reveal>,
     .meaning = "whether the experimenter may see what is felt while a session runs: ask is an event in it"},
    {.name = "language", .slot = at<&Protocol::language>,
     .meaning = "of the participant's screen"},
};

template <>
constexpr Key kRows<ApparatusSpec>[]{
    {.name = "device", .slot = at<&ApparatusSpec::device>,
     .meaning = "of real sessions; pilots and simulations may use another"},
    {.name = "rate_hz", .slot = at<&ApparatusSpec::rate_hz>, .range = {1000, 10000},
     .meaning = "rate of the force loop"},
    {.name = "stiffness_n_per_m", .slot = at<&ApparatusSpec::stiffness>, .range = {0, 20000, true},
     .meaning = "how hard the object is"},
    {.name = "damping_n_s_per_m", .slot = at<&ApparatusSpec::damping>, .range = {0, 100},
     .meaning = "damper of the contact beside its spring; the device must damp more"},
    {.name = "force_limit_n", .slot = at<&ApparatusSpec::force_limit>, .range = {0, 50, true},
     .meaning = "largest force; more is scaled down, its direction kept"},
    {.name = "force_ramp_s", .slot = at<&ApparatusSpec::force_ramp>, .range = {0, 5},
     .meaning = "time for the force to come in and go out"},
    {.name = "vertex_slew_mm_per_s", .slot = at<&ApparatusSpec::vertex_slew>, .range = {0, 10000}, .per_si = 1000,
     .meaning = "how fast the contact may turn around a vertex; 0: at once"},
    {.name = "vertex_radius_mm", .slot = at<&ApparatusSpec::vertex_radius>, .range = {0, 20, true}, .per_si = 1000,
     .meaning = "radius that a vertex counts as for that speed"},
    {.name = "start_mm", .slot = at<&ApparatusSpec::start>, .range = {-1000, 1000}, .per_si = 1000,
     .meaning = "[x, y] where every trial starts, outside all objects"},
    {.name = "start_radius_mm", .slot = at<&ApparatusSpec::start_radius>, .range = {0, 1000}, .per_si = 1000,
     .meaning = "how near to it the handle of a device has to be for a person's trial to begin; 0: anywhere"},
};

template <>
constexpr Key kRows<OutlineSpec>[]{
    {.name = "a_mm", .slot = at<&OutlineSpec::a>, .range = {-1000, 1000}, .per_si = 1000,
     .meaning = "[x, y] of A, left end of the base line"},
    {.name = "vertex_mm", .slot = at<&OutlineSpec::vertex>, .range = {-1000, 1000}, .per_si = 1000,
     .meaning = "[x, y] of the vertex V, where the curves A-V and V-B meet"},
    {.name = "b_mm", .slot = at<&OutlineSpec::b>, .range = {-1000, 1000}, .per_si = 1000,
     .meaning = "[x, y] of B, right end of the base line"},
};

template <>
constexpr Key kRows<SurfaceSpec>[]{
    {.name = "size_mm", .slot = at<&SurfaceSpec::size>, .range = {5, 200}, .per_si = 1000,
     .meaning = "side of every patch, which a level rim surrounds"},
    {.name = "start_height_mm", .slot = at<&SurfaceSpec::start_height>, .range = {1, 200}, .per_si = 1000,
     .meaning = "how high above the middle of the patches start_mm is"},
};

template <>
constexpr Key kRows<ObjectSpec>[]{
    {.name = "name", .slot = at<&ObjectSpec::name>, .need = required,
     .meaning = "names the object in the database"},
    {.name = "curvature_per_m", .slot = at<&ObjectSpec::curvature>, .need = two_curve, .range = {-1000, 1000},
     .meaning = "signed curvature of both curves: above 0 convex, 0 straight, below 0 concave"},
    {.name = "pictured", .slot = at<&ObjectSpec::pictured>,
     .meaning = "false: a catch object, felt but not among the pictures"},
    {.name = "size", .slot = at<&ObjectSpec::size>, .range = {0.01, 100},
     .meaning = "factor about the origin; curvatures are divided by it"},
    {.name = "turn_deg", .slot = at<&ObjectSpec::turn>, .range = {-360, 360}, .per_si = kDegrees,
     .meaning = "then turned about the origin, anticlockwise"},
    {.name = "offset_mm", .slot = at<&ObjectSpec::offset>, .range = {-1000, 1000}, .per_si = 1000,
     .meaning = "then moved by [x, y]"},
    {.name = "compliance_mm_per_n", .slot = at<&ObjectSpec::compliance>, .range = {0, 5}, .per_si = 1000,
     .meaning = "how far the vertex of two curves gives way to a force that rests on it; 0: rigid"},
    {.name = "cross_curvature_per_m", .slot = at<&ObjectSpec::cross_curvature>, .range = {-1000, 1000},
     .meaning = "with [surface]: curvature along y, where curvature_per_m is that along x; opposite signs are a saddle"},
};

template <>
constexpr Key kRows<FrictionSpec>[]{
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

template <>
constexpr Key kRows<SafetySpec>[]{
    {.name = "slew_limit_n_per_ms", .slot = at<&SafetySpec::slew_limit>, .range = {0, kMaxSlew, true}, .per_si = 0.001,
     .meaning = "how fast the force may change"},
    {.name = "speed_limit_m_per_s", .slot = at<&SafetySpec::speed_limit>, .range = {0, kMaxSpeed, true},
     .meaning = "a faster handle switches the force off"},
    {.name = "late_in_a_row", .slot = at<&SafetySpec::late_run>, .range = {0, kLateWindow},
     .meaning = "late ticks in a row that switch the force off; 0: none do"},
    {.name = "late_of_100", .slot = at<&SafetySpec::late_share>, .range = {0, kLateWindow},
     .meaning = "late ticks among the last 100 that switch it off; 0: none do"},
    {.name = "energy_limit_j", .slot = at<&SafetySpec::energy_limit>, .range = {0, kMaxEnergy, true},
     .meaning = "energy that the object may give beyond what it took"},
    {.name = "dead_man", .slot = at<&SafetySpec::dead_man>,
     .meaning = "force only while the participant holds Space; Enter then ends the exploration"},
};

template <>
constexpr Key kRows<InvalidSpec>[]{
    {.name = "late_share", .slot = at<&InvalidSpec::late_share>, .range = {0, 1},
     .meaning = "share of late ticks above which a person's trial does not count; 1: never"},
    {.name = "stale_share", .slot = at<&InvalidSpec::stale_share>, .range = {0, 1},
     .meaning = "share of ticks without a new reading above which a person's trial does not count; 1: never"},
    {.name = "contact_min_s", .slot = at<&InvalidSpec::contact_min>, .range = {0, 3600},
     .meaning = "a trial with less contact does not count; 0: all do"},
    {.name = "path_min_mm", .slot = at<&InvalidSpec::path_min>, .range = {0, 100000}, .per_si = 1000,
     .meaning = "a trial with a shorter way of the handle does not count; 0: all do"},
    {.name = "max_requeues", .slot = at<&InvalidSpec::max_requeues>, .range = {0, 100},
     .meaning = "times that a trial which does not count or faulted is run again; 0: never"},
};

template <>
constexpr Key kRows<ExclusionSpec>[]{
    {.name = "catch_correct_min", .slot = at<&ExclusionSpec::catch_correct_min>, .range = {0, 1},
     .meaning = "least share of catch trials answered with the outermost picture on their side"},
    {.name = "share_correct_min", .slot = at<&ExclusionSpec::share_correct_min>, .range = {0, 1},
     .meaning = "least share of correct main trials, of those that are right or wrong"},
    {.name = "timed_out_share_max", .slot = at<&ExclusionSpec::timed_out_share_max>, .range = {0, 1},
     .meaning = "largest share of main trials that timed out"},
    {.name = "invalid_share_max", .slot = at<&ExclusionSpec::invalid_share_max>, .range = {0, 1},
     .meaning = "largest share of answers in main trials that do not count"},
    {.name = "sessions_finished", .slot = at<&ExclusionSpec::sessions_finished>,
     .meaning = "leave out who has a session that is not finished"},
};

template <>
constexpr Key kRows<AnalysisSpec>[]{
    {.name = "primary", .slot = at<&AnalysisSpec::primary>,
     .meaning = "the test by which friction's effect on the share of right answers is judged, within people: what palpate "
                "stats names first, and palpate power counts"},
};

template <>
constexpr Key kRows<DesignSpec>[]{
    {.name = "repetitions", .slot = at<&DesignSpec::repetitions>, .need = factorial, .range = {1, 1000},
     .meaning = "main trials of each object with each friction"},
    {.name = "max_run_object", .slot = at<&DesignSpec::max_run_object>, .range = {0, 1000},
     .meaning = "same object in a row; 0: no limit"},
    {.name = "max_run_friction", .slot = at<&DesignSpec::max_run_friction>, .range = {0, 1000},
     .meaning = "same friction in a row; 0: no limit"},
    {.name = "practice_repetitions", .slot = at<&DesignSpec::practice_repetitions>, .range = {0, 100},
     .meaning = "practice trials of each condition; 0: none"},
    {.name = "catch_trials", .slot = at<&DesignSpec::catch_trials>, .range = {0, 1000},
     .meaning = "trials with objects that are not pictured, among the main ones"},
    {.name = "break_every", .slot = at<&DesignSpec::break_every>, .range = {0, 10000},
     .meaning = "trials between two breaks; 0: none but the one after practice"},
    {.name = "blocks", .slot = at<&DesignSpec::blocks>, .range = {1, 1000},
     .meaning = "of the main trials, each balanced; a divisor of repetitions"},
    {.name = "order", .slot = at<&DesignSpec::order>,
     .meaning = "random within the run limits, or every condition after every condition once, after a practice trial that leads in"},
    {.name = "friction_blocks", .slot = at<&DesignSpec::friction_blocks>,
     .meaning = "all frictions in each block; or one a block, there and back (abba) or always alike"},
};

template <>
constexpr Key kRows<TimingSpec>[]{
    {.name = "explore_min_s", .slot = at<&TimingSpec::explore_min>, .range = {0, 3600},
     .meaning = "an answer is not taken before"},
    {.name = "explore_prompt_s", .slot = at<&TimingSpec::explore_prompt>, .range = {0, 3600, true},
     .meaning = "the screen asks for an answer"},
    {.name = "explore_timeout_s", .slot = at<&TimingSpec::explore_timeout>, .range = {0, 3600, true},
     .meaning = "the pictures come even without the done key"},
    {.name = "break_min_s", .slot = at<&TimingSpec::break_min>, .range = {0, 3600},
     .meaning = "shortest break"},
    {.name = "gap_s", .slot = at<&TimingSpec::gap>, .range = {0, 60},
     .meaning = "blank screen between two trials, and between the two intervals of one"},
    {.name = "guard_s", .slot = at<&TimingSpec::guard>, .range = {0, 2},
     .meaning = "presses earlier than this after a screen appeared are no answer to it; 0: all are"},
    {.name = "answer_timeout_s", .slot = at<&TimingSpec::answer_timeout>, .range = {0, 3600},
     .meaning = "a question that nobody answers ends, and its trial runs again; 0: it waits"},
};

template <>
constexpr Key kRows<ResponseSpec>[]{
    {.name = "kind", .slot = at<&ResponseSpec::kind>,
     .meaning = "what is asked after feeling; two_interval needs [procedure]"},
    {.name = "question", .slot = at<&ResponseSpec::question>, .form = Form::free,
     .meaning = "what the screen asks; left out: a sentence of its own"},
    {.name = "levels", .slot = at<&ResponseSpec::levels>, .range = {2, 9},
     .meaning = "of a rating"},
    {.name = "low", .slot = at<&ResponseSpec::low>, .form = Form::free,
     .meaning = "label of a rating's first level, or of no"},
    {.name = "high", .slot = at<&ResponseSpec::high>, .form = Form::free,
     .meaning = "label of a rating's last level, or of yes"},
    {.name = "confidence", .slot = at<&ResponseSpec::confidence>,
     .meaning = "after the answer: how sure, 1 to 4"},
    {.name = "confirm", .slot = at<&ResponseSpec::confirm>,
     .meaning = "answers can be changed until Enter, or the same one again, confirms them"},
    {.name = "feedback", .slot = at<&ResponseSpec::feedback>,
     .meaning = "after which answers the screen says right or wrong"},
};

template <>
constexpr Key kRows<AdaptiveSpec>[]{
    {.name = "varies", .slot = at<&AdaptiveSpec::varies>, .need = required,
     .meaning = "what the rule chooses: the curvature, mu_s (mu_d keeps its share), or the compliance"},
    {.name = "stimulus_as", .slot = at<&AdaptiveSpec::stimulus_as>,
     .meaning = "log10: what is felt is 10 to the power of what the rule chooses"},
    {.name = "object", .slot = at<&AdaptiveSpec::object>, .need = required,
     .meaning = "name of the object that is felt; as it stands it is the standard"},
    {.name = "practice_trials", .slot = at<&AdaptiveSpec::practice_trials>, .range = {0, 100},
     .meaning = "before the others, in turn of all runs"},
    {.name = "practice_stimulus", .slot = at<&AdaptiveSpec::practice_stimulus>, .range = {-kMaxStimulus, kMaxStimulus},
     .meaning = "of the comparison in all practice trials"},
    {.name = "practice_balanced", .slot = at<&AdaptiveSpec::practice_balanced>,
     .meaning = "true: of every run's practice one half has the comparison in each interval; false: drawn"},
    {.name = "max_run", .slot = at<&AdaptiveSpec::max_run>, .range = {0, 1000},
     .meaning = "trials of the same run in a row; 0: no limit"},
    {.name = "max_run_interval", .slot = at<&AdaptiveSpec::max_run_interval>, .range = {0, 1000},
     .meaning = "comparisons in the same interval in a row; 0: no limit"},
};

template <>
constexpr Key kRows<RunSpec>[]{
    {.name = "name", .slot = at<&RunSpec::name>, .need = required,
     .meaning = "names the run in the database"},
    {.name = "friction", .slot = at<&RunSpec::friction>, .need = required,
     .meaning = "name of the comparison's friction"},
    {.name = "standard_friction", .slot = at<&RunSpec::standard_friction>,
     .meaning = "name of the standard's friction; left out: the same"},
};

template <>
constexpr Key kRows<ObserverSpec>[]{
    {.name = "noise_per_m", .slot = at<&ObserverSpec::noise>, .range = {0, 1000},
     .meaning = "standard deviation of the felt curvature"},
    {.name = "lapse", .slot = at<&ObserverSpec::lapse>, .range = {0, 1},
     .meaning = "share of answers given at random"},
    {.name = "force_weight", .slot = at<&ObserverSpec::force_weight>, .range = {0, 1},
     .meaning = "weight of the force cue; the position cue has the rest"},
    {.name = "bias_per_m_per_mu", .slot = at<&ObserverSpec::bias_per_mu>, .range = {-1000, 1000},
     .meaning = "curvature added per unit of felt friction"},
    {.name = "noise_mu", .slot = at<&ObserverSpec::noise_mu>, .range = {0, 10},
     .meaning = "standard deviation of the felt friction coefficient"},
    {.name = "noise_softness_log10", .slot = at<&ObserverSpec::noise_softness>, .range = {0, 10},
     .meaning = "standard deviation of the decadic logarithm of the felt softness"},
};

template <>
constexpr Key kRows<MaskingSpec>[]{
    {.name = "noise", .slot = at<&MaskingSpec::noise>,
     .meaning = "on the headphones from the ready screen until the question, over the sound of the motors"},
    {.name = "level_db", .slot = at<&MaskingSpec::level_db>, .range = {-60, 0},
     .meaning = "root mean square against full scale; how loud that is, measure on your headphones"},
};

template <>
constexpr Key kRows<InstructionTexts>[]{
    {.name = "welcome", .slot = at<&InstructionTexts::welcome>, .form = Form::lines,
     .meaning = "before the first trial"},
    {.name = "ready", .slot = at<&InstructionTexts::ready>, .form = Form::lines,
     .meaning = "before every trial"},
    {.name = "explore", .slot = at<&InstructionTexts::explore>, .form = Form::lines,
     .meaning = "while an object is felt"},
    {.name = "choose", .slot = at<&InstructionTexts::choose>, .form = Form::lines,
     .meaning = "the question above the answers"},
    {.name = "break", .slot = at<&InstructionTexts::rest>, .form = Form::lines,
     .meaning = "in a break"},
    {.name = "end", .slot = at<&InstructionTexts::end>, .form = Form::lines,
     .meaning = "after the last trial"},
};
// clang-format on

}  // namespace

template <class Record>
Keys keys_of() {
    return kRows<Record>;
}
template Keys keys_of<Protocol>();
template Keys keys_of<ApparatusSpec>();
template Keys keys_of<OutlineSpec>();
template Keys keys_of<SurfaceSpec>();
template Keys keys_of<ObjectSpec>();
template Keys keys_of<FrictionSpec>();
template Keys keys_of<SafetySpec>();
template Keys keys_of<InvalidSpec>();
template Keys keys_of<ExclusionSpec>();
template Keys keys_of<AnalysisSpec>();
template Keys keys_of<DesignSpec>();
template Keys keys_of<TimingSpec>();
template Keys keys_of<ResponseSpec>();
template Keys keys_of<AdaptiveSpec>();
template Keys keys_of<RunSpec>();
template Keys keys_of<ObserverSpec>();
template Keys keys_of<MaskingSpec>();
template Keys keys_of<InstructionTexts>();

}  // namespace palpate::protocols
