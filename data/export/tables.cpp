#include "data/export/tables.hpp"

#include <array>
#include <stdexcept>

#include <fmt/format.h>

namespace palpate::data {
namespace {

constexpr ExportColumn kSubject{"subject", "text", "",
                                "the participant, in every export: a number that says nothing",
                                "chosen.subject"};
constexpr ExportColumn kStudy{"study_label", "text", "", "the study, as in sessions",
                              "chosen.label"};
constexpr ExportColumn kSession{
    "session_number", "integer", "1",
    "the participant's sessions of the study, counted from 1 among those of this export",
    "chosen.session_number"};
constexpr std::string_view kHands = "left = score -40 or less; right = 40 or more; both = between";
constexpr std::string_view kYesNo = "0 = no; 1 = yes";
constexpr std::string_view kPhases =
    "practice = before the main trials, not to be analysed; main = the study; catch = among the"
    " main ones, an object that no picture shows";
constexpr std::string_view kSure =
    "1 = a guess; 2 = nearer to a guess; 3 = nearer to sure; 4 = sure";
constexpr std::string_view kKinds =
    "real = a session of the study; pilot = to try it; simulated = computed hand and answers";
constexpr ExportColumn kKind{"session_kind",         "text", "",    "what the session is",
                             "session.session_kind", false,  kKinds};
constexpr ExportColumn kTrial{"trial_number", "integer", "1",
                              "attempts at trials of the session, counted from 1 in the order run",
                              "numbered.trial_number"};

constexpr ExportColumn kRunName{"run_name", "text", "", "of a rule that chooses: which run",
                                "adaptive_plan.run_name"};
constexpr ExportColumn kComparison{"comparison_interval", "integer", "1",
                                   "the interval with the rule's stimulus",
                                   "adaptive_plan.comparison_interval"};

constexpr std::array kParticipants{
    kSubject,
    ExportColumn{"handedness", "text", "", "by the Edinburgh score", kHandednessSql, false, kHands},
    ExportColumn{"handedness_score", "integer", "1", "Edinburgh score, -100 left to 100 right",
                 "participant.handedness", true},
    ExportColumn{"sessions", "integer", "1", "sessions in this export", "count(*)"},
    ExportColumn{"consent", "integer", "1", "1: consent to take part was noted",
                 "participant.consent", false, kYesNo},
    ExportColumn{"consent_utc", "text", "", "when that was noted", "participant.consent_utc", true},
};

constexpr std::array kDetails{
    kSubject, ExportColumn{"key", "text", "", "what was asked", "participant_detail.key"},
    ExportColumn{"value", "text", "", "the answer", "participant_detail.value"}};

constexpr std::array kSessions{
    kSubject,
    kStudy,
    kSession,
    kKind,
    ExportColumn{"day", "integer", "d", "days since the participant's first session here",
                 "chosen.day", true},
    ExportColumn{"lab_session_number", "integer", "1", "session.session_number of the database",
                 "session.session_number", true},
    ExportColumn{"finished", "integer", "1", "1: all planned trials were run", "session.finished",
                 false, kYesNo},
    ExportColumn{"study_name", "text", "", "the protocol's id", "study.study_name"},
    ExportColumn{"study_title", "text", "", "the protocol's title", "study.title"},
    ExportColumn{"protocol_sha256", "text", "", "SHA-256 of the protocol's canonical text",
                 "study.protocol_sha256"},
    ExportColumn{"device", "text", "", "kind of device",
                 "iif(session.device LIKE 'replay of %', 'replay',"
                 " substr(session.device, 1, instr(session.device || ':', ':') - 1))"},
    ExportColumn{"rate_hz", "real", "Hz", "servo ticks a second", "session.rate_hz"},
    ExportColumn{"stiffness_n_per_m", "real", "N/m", "stiffness of the object",
                 "session.stiffness_n_per_m"},
    ExportColumn{"device_words", "text", "", "device as given", "session.device", true},
    ExportColumn{"seed", "text", "", "study seed, unsigned 64 bit", "session.seed", true},
    ExportColumn{"plan_sha256", "text", "", "hash of the plan", "session.plan_sha256", true},
    ExportColumn{"shuffles", "integer", "1", "orders proposed until one kept the limits",
                 "session.shuffles", true},
    ExportColumn{"operator", "text", "", "who ran it", "session.operator", true},
    ExportColumn{"started_utc", "text", "", "begin, wall clock", "session.started_utc", true},
    ExportColumn{"finished_utc", "text", "", "end, wall clock", "session.finished_utc", true},
    ExportColumn{"uuid", "text", "", "the session's name wherever it is copied to", "session.uuid",
                 true},
};

constexpr std::array kProvenance{
    kSubject, kStudy, kSession, ExportColumn{"key", "text", "", "what", "session_provenance.key"},
    ExportColumn{"value", "text", "", "its version, text or hash", "session_provenance.value"}};

constexpr std::array kPlan{
    kSubject,
    kStudy,
    kSession,
    ExportColumn{"plan_position", "integer", "1", "place in the plan, from 0",
                 "plan.plan_position"},
    ExportColumn{"phase", "text", "", "part of the session", "plan.phase", false, kPhases},
    ExportColumn{"block", "integer", "1", "block of the main phase; 0 in practice", "plan.block"},
    ExportColumn{"planned_object", "text", "",
                 "what the plan says; of two intervals: the standard's", "plan.planned_object"},
    ExportColumn{"curvature_per_m", "real", "1/m", "> 0 convex, 0 straight, < 0 concave",
                 "plan.curvature_per_m"},
    ExportColumn{"friction", "text", "", "friction condition", "plan.friction"},
    ExportColumn{"mu_s", "real", "1", "static coefficient of friction", "plan.mu_s"},
    ExportColumn{"mu_d", "real", "1", "dynamic coefficient of friction", "plan.mu_d"},
    ExportColumn{"break_before", "integer", "1", "1: a break came before it", "plan.break_before",
                 false, kYesNo}};

constexpr std::array kPictures{
    kSubject, kStudy, kSession,
    ExportColumn{"picture_place", "integer", "1", "from left to right, from 0",
                 "picture.picture_place"},
    ExportColumn{"picture_object", "text", "", "which picture", "picture.picture_object"}};

constexpr std::array kTrials{
    kSubject,
    kStudy,
    kSession,
    kKind,
    kTrial,
    ExportColumn{"plan_position", "integer", "1", "place in the plan, from 0",
                 "trial.plan_position"},
    ExportColumn{"attempt", "integer", "1", "attempts at this position, from 1", "trial.attempt"},
    ExportColumn{"phase", "text", "", "part of the session", "plan.phase", false, kPhases},
    ExportColumn{"block", "integer", "1", "block of the main phase; 0 in practice", "plan.block"},
    ExportColumn{"planned_object", "text", "",
                 "what the plan says; of two intervals: the standard's", "plan.planned_object"},
    ExportColumn{"curvature_per_m", "real", "1/m", "> 0 convex, 0 straight, < 0 concave",
                 "plan.curvature_per_m"},
    ExportColumn{"friction", "text", "", "friction condition", "plan.friction"},
    ExportColumn{"mu_s", "real", "1", "static coefficient of friction", "plan.mu_s"},
    ExportColumn{"mu_d", "real", "1", "dynamic coefficient of friction", "plan.mu_d"},
    ExportColumn{
        "outcome", "text", "", "how the attempt ended", "trial.outcome", false,
        "complete = answered; timed_out = answered after the time to explore was over; "
        "aborted = the experimenter ended it; interrupted = the program or machine stopped; "
        "faulted = the force went off by itself; running = not ended when exported"},
    ExportColumn{"counts", "integer", "1", "1: answered, and the answer counts",
                 "response.trial_id IS NOT NULL AND trial.invalid_reason IS NULL", false, kYesNo},
    ExportColumn{"invalid_reason", "text", "",
                 "why the answer does not count; \"marked\": somebody said so",
                 "iif(EXISTS (SELECT 1 FROM event WHERE event.trial_id = trial.trial_id AND "
                 "event.event_kind ="
                 " 'mark'), 'marked', trial.invalid_reason)"},
    ExportColumn{"invalid_words", "text", "", "the same with the words of the mark",
                 "trial.invalid_reason", true},
    ExportColumn{"fault_cause", "text", "", "why the force went off", "trial.fault_cause"},
    ExportColumn{"chosen_object", "text", "", "the answer: the object of the picture chosen",
                 "response.chosen_object"},
    ExportColumn{"correct", "integer", "1", "1: the choice is the object", "response.correct",
                 false, kYesNo},
    ExportColumn{"answer_code", "integer", "1",
                 "picture from the left, from 0; interval - 1; 0 no, 1 yes; level of a rating",
                 "response.answer_code"},
    ExportColumn{"confidence", "integer", "1", "how sure", "response.confidence", false, kSure},
    kRunName,
    kComparison,
    ExportColumn{
        "stimulus", "real", "", "what the rule chose for it, in the protocol's unit",
        "(SELECT stimulus FROM presentation WHERE presentation.trial_id = trial.trial_id AND"
        " presentation.interval = adaptive_plan.comparison_interval)"},
    ExportColumn{"first_contact_s", "real", "s", "first tick to first contact",
                 "trial.first_contact_s"},
    ExportColumn{"done_s", "real", "s", "first tick to done", "trial.done_s"},
    ExportColumn{"done_uncertainty_s", "real", "s", "how late done may have been seen",
                 "trial.done_uncertainty_s"},
    ExportColumn{"reaction_s", "real", "s", "question shown to the press that gave this answer",
                 "response.reaction_s"},
    ExportColumn{"reaction_uncertainty_s", "real", "s", "how late the answer may have been seen",
                 "response.reaction_uncertainty_s"},
    ExportColumn{"ticks", "integer", "1", "servo ticks", "trial.ticks"},
    ExportColumn{"contact_ticks", "integer", "1", "of them in contact", "trial.contact_ticks"},
    ExportColumn{"slip_ticks", "integer", "1", "of them slipping", "trial.slip_ticks"},
    ExportColumn{"late_ticks", "integer", "1", "of them late", "trial.late_ticks"},
    ExportColumn{"saturated_ticks", "integer", "1", "of them with the force at its limit",
                 "trial.saturated_ticks"},
    ExportColumn{"force_slew_ticks", "integer", "1",
                 "of them with the force changing as fast as it may", "trial.force_slew_ticks"},
    ExportColumn{"stale_ticks", "integer", "1", "of them without a new reading",
                 "trial.stale_ticks"},
    ExportColumn{"skipped_ticks", "integer", "1", "of them out of reach", "trial.skipped_ticks"},
    ExportColumn{"before_vertex_ticks", "integer", "1",
                 "of them in contact with segment 0, before vertex 0", "trial.before_vertex_ticks"},
    ExportColumn{"after_vertex_ticks", "integer", "1",
                 "of them in contact with segment 1, after vertex 0", "trial.after_vertex_ticks"},
    ExportColumn{"path_length_m", "real", "m", "way of the handle", "trial.path_length_m"},
    ExportColumn{"strokes", "integer", "1", "along the surface, 5 mm or more in one direction",
                 "trial.strokes"},
    ExportColumn{"mean_speed_m_per_s", "real", "m/s", "of the handle in contact",
                 "trial.mean_speed_m_per_s"},
    ExportColumn{"mean_normal_force_n", "real", "N", "mean normal force in contact",
                 "trial.mean_normal_force_n"},
    ExportColumn{"max_normal_force_n", "real", "N", "largest normal force",
                 "trial.max_normal_force_n"},
    ExportColumn{"energy_j", "real", "J", "work done on the user", "trial.energy_j"},
    ExportColumn{"contact_episodes", "integer", "1", "times that contact began",
                 "trial.contact_episodes"},
    ExportColumn{"worst_episode_j", "real", "J",
                 "most energy an episode gave beyond K/2 sum |dh|^2; <= 0: passive",
                 "trial.worst_episode_j"},
    ExportColumn{
        "since_first_ns", "integer", "ns",
        "begin, since the first attempt of the session, or after a pause of more than an hour",
        "trial.started_ns - numbered.zero_ns"},
    ExportColumn{"started_ns", "integer", "ns", "begin, on the servo's clock", "trial.started_ns",
                 true},
    ExportColumn{"started_utc", "text", "", "begin, wall clock", "trial.started_utc", true},
    ExportColumn{"ended_utc", "text", "", "end, wall clock", "trial.ended_utc", true},
};

constexpr std::array kResponses{
    kSubject,
    kStudy,
    kSession,
    kTrial,
    ExportColumn{"chosen_place", "integer", "1", "place of the picture chosen, from 0",
                 "response.chosen_place"},
    ExportColumn{"chosen_object", "text", "", "the object of that picture",
                 "response.chosen_object"},
    ExportColumn{"correct", "integer", "1", "1: it is the object presented", "response.correct",
                 false, kYesNo},
    ExportColumn{"reaction_s", "real", "s", "question shown to the press that gave this answer",
                 "response.reaction_s"},
    ExportColumn{"reaction_uncertainty_s", "real", "s", "how late the answer may have been seen",
                 "response.reaction_uncertainty_s"},
    ExportColumn{"input", "text", "", "key, arrows, mouse or simulated", "response.input"},
    ExportColumn{"answer_code", "integer", "1",
                 "picture from the left, from 0; interval - 1; 0 no, 1 yes; level of a rating",
                 "response.answer_code"},
    ExportColumn{"confidence", "integer", "1", "how sure", "response.confidence", false, kSure},
    ExportColumn{"confidence_reaction_s", "real", "s", "scale shown to confidence",
                 "response.confidence_reaction_s"},
    ExportColumn{"early_presses", "integer", "1",
                 "presses within the guard time of question or scale, which were no answers",
                 "response.early_presses"},
    ExportColumn{"first_choice_s", "real", "s",
                 "question shown to the first answer marked, where answers are confirmed",
                 "response.first_choice_s"},
    ExportColumn{"confirmed_s", "real", "s", "question shown to the confirmation",
                 "response.confirmed_s"},
    ExportColumn{"changes", "integer", "1", "times that another answer was marked before",
                 "response.changes"},
    ExportColumn{"confidence_first_choice_s", "real", "s", "scale shown to the first level marked",
                 "response.confidence_first_choice_s"},
    ExportColumn{"confidence_confirmed_s", "real", "s", "scale shown to the confirmation",
                 "response.confidence_confirmed_s"},
    ExportColumn{"confidence_changes", "integer", "1", "times that another level was marked before",
                 "response.confidence_changes"},
};

constexpr std::array kPresentations{
    kSubject,
    kStudy,
    kSession,
    kTrial,
    ExportColumn{"interval", "integer", "1", "1 or 2", "presentation.interval"},
    ExportColumn{"stimulus", "real", "", "what the rule chose, in the protocol's unit",
                 "presentation.stimulus"},
    ExportColumn{"felt_object", "text", "", "what was felt", "presentation.felt_object"},
    ExportColumn{"curvature_per_m", "real", "1/m", "as felt", "presentation.curvature_per_m"},
    ExportColumn{"friction", "text", "", "friction condition", "presentation.friction"},
    ExportColumn{"mu_s", "real", "1", "as felt", "presentation.mu_s"},
    ExportColumn{"mu_d", "real", "1", "as felt", "presentation.mu_d"},
    ExportColumn{"slip_decay", "real", "1", "exp(-T/tau_slip) as computed on that machine",
                 "presentation.slip_decay"},
    ExportColumn{"heal_decay", "real", "1", "exp(-T/tau_heal) as computed on that machine",
                 "presentation.heal_decay"},
    ExportColumn{"done_s", "real", "s", "first tick to done", "presentation.done_s"},
    ExportColumn{"done_uncertainty_s", "real", "s", "how late done may have been seen",
                 "presentation.done_uncertainty_s"},
    ExportColumn{"first_contact_s", "real", "s", "first tick to first contact",
                 "presentation.first_contact_s"},
    ExportColumn{"ticks", "integer", "1", "servo ticks", "presentation.ticks"},
    ExportColumn{"contact_ticks", "integer", "1", "of them in contact",
                 "presentation.contact_ticks"},
    ExportColumn{"slip_ticks", "integer", "1", "of them slipping", "presentation.slip_ticks"},
    ExportColumn{"late_ticks", "integer", "1", "of them late", "presentation.late_ticks"},
    ExportColumn{"saturated_ticks", "integer", "1", "of them with the force at its limit",
                 "presentation.saturated_ticks"},
    ExportColumn{"path_length_m", "real", "m", "way of the handle", "presentation.path_length_m"},
    ExportColumn{"mean_normal_force_n", "real", "N", "mean normal force in contact",
                 "presentation.mean_normal_force_n"},
    ExportColumn{"max_normal_force_n", "real", "N", "largest normal force",
                 "presentation.max_normal_force_n"}};

constexpr std::array kSteps{
    kSubject,
    kStudy,
    kSession,
    kTrial,
    ExportColumn{"run_number", "integer", "1", "one rule with its own answers, from 0",
                 "adaptive_plan.run_number"},
    kRunName,
    kComparison,
    ExportColumn{"standard_friction", "text", "", "friction of the other interval",
                 "adaptive_plan.standard_friction"},
    ExportColumn{"rule_outcome", "integer", "1", "as the rule took it: 1 the comparison was named",
                 "adaptive_step.rule_outcome"},
    ExportColumn{"estimate", "real", "", "mean of the first estimate with this answer",
                 "adaptive_step.estimate"},
    ExportColumn{"estimates", "text", "", "all of them, as JSON", "adaptive_step.estimates"},
    ExportColumn{"state_sha256", "text", "", "hash of the rule's state with this answer",
                 "adaptive_step.state_sha256"}};

constexpr std::array kEvents{
    kSubject,
    kStudy,
    kSession,
    ExportColumn{"event_number", "integer", "1", "events of the session, counted from 1",
                 "row_number() OVER (PARTITION BY event.session_id ORDER BY event.event_id)"},
    ExportColumn{"trial_number", "integer", "1", "the attempt it belongs to",
                 "(SELECT trial_number FROM numbered WHERE numbered.trial_id = event.trial_id)"},
    ExportColumn{"event_kind", "text", "", "break, abort, fault, go on, timing, mark, ...",
                 "event.event_kind"},
    ExportColumn{"text", "text", "", "what palpate noted itself",
                 "iif(event.event_kind IN ('break', 'abort', 'gave up', 'timing', 'go on', 'fault',"
                 " 'interrupted'), event.text, NULL)"},
    ExportColumn{"words", "text", "", "the same, with notes, names and versions", "event.text",
                 true},
    ExportColumn{"trials_begun", "integer", "1", "attempts of the session by then",
                 "event.trials_begun"},
    ExportColumn{"plan_position", "integer", "1", "what it is about, or what comes next",
                 "event.plan_position"},
    ExportColumn{"part", "integer", "1", "redo: 0 practice, else 1 + block", "event.part"},
    ExportColumn{"count", "integer", "1",
                 "ticks lost; redo: answers; gave up, reconnect: tries in vain", "event.count"},
    ExportColumn{"duration_s", "real", "s", "go on: of the pause; masking: without noise",
                 "event.duration_s"},
    ExportColumn{"key", "text", "", "provenance, participant: what", "event.key", true},
    ExportColumn{"value", "text", "", "of key; the cause; the new one", "event.value", true},
    ExportColumn{"operator", "text", "", "who noted it", "event.operator", true},
    ExportColumn{"since_first_ns", "integer", "ns",
                 "as in trials; empty: no attempt is within an hour of it",
                 "(SELECT since_ns FROM happened WHERE happened.event_id = event.event_id)"},
    ExportColumn{"at_ns", "integer", "ns", "on the clock of the trials' started_ns", "event.at_ns",
                 true},
    ExportColumn{"at_utc", "text", "", "wall clock", "event.at_utc", true}};

constexpr std::array kTickKeys{
    kSubject, kStudy, kSession, kTrial,
    ExportColumn{"interval", "integer", "1", "of a trial with two things to feel: 1 or 2", ""}};

// Joins that several tables share: string literals cannot be joined at compile time.
#define PALPATE_SESSIONS                                                 \
    "chosen JOIN session USING (session_id) JOIN study USING (study_id)" \
    " JOIN participant USING (participant_id)"
#define PALPATE_TRIALS \
    PALPATE_SESSIONS   \
    " JOIN trial USING (session_id) JOIN numbered USING (trial_id)"
#define PALPATE_ORDER "chosen.subject, chosen.label, chosen.session_number"

constexpr std::array kTables{
    ExportTable{"participants", "one row a participant",
                PALPATE_SESSIONS " GROUP BY participant.participant_id", "chosen.subject",
                kParticipants},
    ExportTable{"participant_details", "what else was asked of participants",
                "(SELECT DISTINCT subject, participant_id FROM chosen JOIN session USING "
                "(session_id)) AS chosen"
                " JOIN participant_detail USING (participant_id)",
                "chosen.subject, participant_detail.key", kDetails, true},
    ExportTable{"sessions", "one row a session", PALPATE_SESSIONS, PALPATE_ORDER, kSessions},
    ExportTable{"provenance", "versions, machine, calibration",
                PALPATE_SESSIONS " JOIN session_provenance USING (session_id)",
                PALPATE_ORDER ", session_provenance.key", kProvenance, true},
    ExportTable{"plan", "the whole order, complete before the first trial",
                PALPATE_SESSIONS " JOIN plan USING (session_id)",
                PALPATE_ORDER ", plan.plan_position", kPlan},
    ExportTable{"pictures", "which picture stood at which place",
                PALPATE_SESSIONS " JOIN picture USING (session_id)",
                PALPATE_ORDER ", picture.picture_place", kPictures},
    ExportTable{
        "trials", "one row an attempt at a planned trial, with its answer",
        PALPATE_TRIALS
        " JOIN plan USING (session_id, plan_position) LEFT JOIN response USING (trial_id) LEFT JOIN"
        " adaptive_plan USING (session_id, plan_position)",
        PALPATE_ORDER ", trial.trial_id", kTrials},
    ExportTable{"responses", "one row an answer", PALPATE_TRIALS " JOIN response USING (trial_id)",
                PALPATE_ORDER ", trial.trial_id", kResponses},
    ExportTable{"presentations", "one row an interval of an attempt: what was felt, and how",
                PALPATE_TRIALS " JOIN presentation USING (trial_id)",
                PALPATE_ORDER ", trial.trial_id, presentation.interval", kPresentations},
    ExportTable{"adaptive_steps", "one row an answer that a rule took in",
                PALPATE_TRIALS " JOIN adaptive_step USING (trial_id) JOIN adaptive_plan"
                               " USING (session_id, plan_position)",
                PALPATE_ORDER ", trial.trial_id", kSteps},
    ExportTable{"events", "breaks, stops, resumes, faults",
                PALPATE_SESSIONS " JOIN event USING (session_id)", PALPATE_ORDER ", event.event_id",
                kEvents},
};
#undef PALPATE_ORDER
#undef PALPATE_TRIALS
#undef PALPATE_SESSIONS
}  // namespace

std::span<const ExportTable> export_tables() noexcept {
    return kTables;
}

std::span<const ExportColumn> tick_keys() noexcept {
    return kTickKeys;
}

const ExportTable& export_table(std::string_view name) {
    for (const ExportTable& table : kTables) {
        if (table.name == name) {
            return table;
        }
    }
    throw std::logic_error(fmt::format("there is no table {}", name));
}

}  // namespace palpate::data
