#include <algorithm>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "data/export/csv_export.hpp"
#include "data/schema/catalogue.hpp"
#include "data/trace/columns.hpp"

namespace palpate::data {
namespace {

constexpr const char* kYesNo = "0 = no; 1 = yes";

/// What a device calls itself, without the port, the address or the file behind it.
std::string kind_of(const std::string& device) {
    return fmt::format(
        "iif({0} LIKE 'replay of %', 'replay', substr({0}, 1, min(instr({0} || ':', ':'), "
        "instr({0} || ' at ', ' at ')) - 1))",
        device);
}

/// Of the interval whose stimulus a rule chose, as it was felt; NULL without a rule.
std::string of_comparison(const char* column) {
    return fmt::format(
        "(SELECT presentation.{} FROM presentation WHERE presentation.trial_id = trial.trial_id "
        "AND presentation.interval = adaptive_plan.comparison_interval)",
        column);
}

/// Columns that the file does not have as they are: keys of an export, and what is said of a column
/// so that it tells nobody who somebody is. All others have name, type, unit, meaning and readers
/// from the catalogue.
const std::vector<ExportColumn> kComputed{
    {"subject", "text", "", "the participant, in every export: a number that says nothing",
     "chosen.subject"},
    {"study_label", "text", "",
     "the study: letters and digits of its id; where the file has several of these, with x and "
     "the first 8 digits of protocol_sha256",
     "chosen.label"},
    {"session_number", "integer", "1",
     "the participant's sessions of the study, counted from 1 among those of this export",
     "chosen.session_number"},
    {"lab_session_number", "integer", "1", "session.session_number of the database",
     "session.session_number", true},
    {"trial_number", "integer", "1",
     "attempts at trials of the session, counted from 1 in the order run", "numbered.trial_number"},
    {"handedness", "text", "", "by the Edinburgh score", kHandednessSql, false,
     "left = score -40 or less; right = 40 or more; both = between"},
    {"handedness_score", "integer", "1", "Edinburgh score, -100 left to 100 right",
     "participant.handedness", true},
    {"sessions", "integer", "1", "sessions in this export", "count(*)"},
    {"day", "integer", "d", "days since the participant's first session here, by UTC", "chosen.day",
     true},
    {"device", "text", "", "kind of device with which it began", kind_of("session.device")},
    {"trial_device", "text", "", "kind of device on which it was felt", kind_of("trial.device")},
    {"device_words", "text", "", "device as given", "session.device", true},
    {"exclusion", "text", "", "why the answer does not count; marked: somebody said so",
     "numbered.exclusion"},
    {"trials_since_break", "integer", "1",
     "attempts before it since the session's begin or last break; empty: it has not ended",
     "numbered.trials_since_break"},
    {"counts", "integer", "1", "1: answered, and the answer counts",
     "response.trial_id IS NOT NULL AND trial.invalid_reason IS NULL", false, kYesNo},
    {"stimulus", "real", "", "what the rule chose, in the protocol's unit; empty: no rule",
     of_comparison("stimulus")},
    {"comparison_curvature_per_m", "real", "1/m",
     "curvature of the interval with the rule's stimulus, as felt; empty: no rule, or a free form",
     of_comparison("curvature_per_m")},
    {"comparison_mu_s", "real", "1", "mu_s of the interval with the rule's stimulus, as felt",
     of_comparison("mu_s")},
    {"comparison_mu_d", "real", "1", "mu_d of the interval with the rule's stimulus, as felt",
     of_comparison("mu_d")},
    {"interval", "integer", "1", "of a trial with two things to feel: 1 or 2", ""},
    {"since_first_ns", "integer", "ns",
     "since the first attempt of the session, or after a pause of more than an hour",
     "trial.started_ns - numbered.zero_ns"},
    {"event_number", "integer", "1", "events of the session, counted from 1",
     "row_number() OVER (PARTITION BY event.session_id ORDER BY event.event_id)"},
    {"event_trial", "integer", "1", "trial_number of the attempt it belongs to",
     "(SELECT trial_number FROM numbered WHERE numbered.trial_id = event.trial_id)"},
    {"mark_undone", "integer", "1", "of a mark: 1 takes the one before of its trial back",
     "iif(event.event_kind = 'mark', event.key IS 'undone', NULL)", false, kYesNo},
    {"event_value", "text", "", "of key; fault, go on: the cause; device, operator: the new one",
     "iif(event.key IS 'is really', NULL, event.value)", true},
    {"event_text", "text", "", "what palpate noted itself",
     "iif(event.event_kind IN ('break', 'abort', 'gave up', 'timing', 'go on', 'fault', "
     "'interrupted'), event.text, NULL)"},
    {"event_since_first_ns", "integer", "ns",
     "as since_first_ns of trials; empty: no attempt is within an hour of it, or it was noted from "
     "outside",
     "iif(event.event_kind IN ('mark', 'note', 'participant'), NULL, (SELECT since_ns FROM "
     "happened WHERE happened.event_id = event.event_id))"},
};

/// A column of the catalogue as exports tell of it.
ExportColumn exported(const std::string& table, const ColumnManual& column) {
    const bool text = column.type == "TEXT";
    const bool chosen =
        column.name == "stimulus" || column.name == "estimate";  // the protocol's unit
    return {column.name,
            text                       ? "text"
            : column.type == "INTEGER" ? "integer"
                                       : "real",
            column.unit != "-" && column.unit != "UTC" ? column.unit
            : text || chosen                           ? ""
                                                       : "1",
            column.meaning,
            fmt::format("{}.{}", table, column.name),
            column.seen != Visibility::everybody,
            column.levels};
}

ExportColumn one_column(const std::string& word) {
    const auto computed = std::ranges::find(kComputed, word, &ExportColumn::name);
    if (computed != kComputed.end()) {
        return *computed;
    }
    const ColumnManual* column = find_column(word);
    refuse_if<std::logic_error>(column == nullptr, "the catalogue has no column {}", word);
    return exported(word.substr(0, word.find('.')), *column);
}

/// "trial.*": all of a table's columns that may leave the file and are not there yet.
/// "trial.phase": one of a table. "counts": a computed one. "text=event_text": one by another name.
std::vector<ExportColumn> columns_of(const std::string& words) {
    std::vector<ExportColumn> columns;
    std::istringstream list(words);
    for (std::string word; list >> word;) {
        const std::size_t equals = word.find('=');
        if (word.ends_with(".*")) {
            const std::string name = word.substr(0, word.size() - 2);
            for (const ColumnManual& column : find_table(name)->columns) {
                const bool there =
                    std::ranges::find(columns, column.name, &ExportColumn::name) != columns.end();
                if (column.seen != Visibility::file && !there) {
                    columns.push_back(exported(name, column));
                }
            }
        } else {
            ExportColumn column = one_column(word.substr(equals + 1));  // npos + 1 is 0
            column.name = equals == std::string::npos ? column.name : word.substr(0, equals);
            columns.push_back(column);
        }
    }
    return columns;
}

/// @param joined  to the sessions chosen
ExportTable table(const char* name,
                  const char* meaning,
                  const std::string& joined,
                  const std::string& order,
                  const std::string& columns,
                  bool detail = false) {
    return {name,
            meaning,
            "chosen JOIN session USING (session_id) JOIN study USING (study_id)"
            " JOIN participant USING (participant_id)" +
                joined,
            order,
            columns_of(columns),
            detail};
}

const std::string kSubject = "chosen.subject";
const std::string kSession = kSubject + ", chosen.label, chosen.session_number";
const std::string kKeys = "subject study_label session_number ";

std::vector<ExportTable> tables_of_sessions() {
    return {
        table("participants", "one row a participant", " GROUP BY participant.participant_id",
              kSubject,
              "subject handedness handedness_score participant.handedness_utc sessions "
              "participant.consent participant.consent_utc"),
        table("participant_details", "what else was asked of participants",
              " JOIN participant_detail USING (participant_id) GROUP BY"
              " participant_detail.participant_id, participant_detail.key",
              "chosen.subject, participant_detail.key", "subject participant_detail.*", true),
        table("sessions", "one row a session", "", kSession,
              kKeys + "session.session_kind day lab_session_number study.* device device_words "
                      "session.*"),
        table("provenance", "versions, machine, calibration",
              " JOIN session_provenance USING (session_id)", kSession + ", session_provenance.key",
              kKeys + "session_provenance.*", true),
        table("plan", "the whole order, complete before the first trial",
              " JOIN plan USING (session_id)", kSession + ", plan.plan_position", kKeys + "plan.*"),
        table("pictures", "which picture stood at which place", " JOIN picture USING (session_id)",
              kSession + ", picture.picture_place", kKeys + "picture.*"),
    };
}

constexpr const char* kTrialColumns =
    "session.session_kind trial_number trial.plan_position trial.attempt plan.phase plan.block "
    "plan.planned_object plan.curvature_per_m plan.friction plan.mu_s plan.mu_d trials_since_break "
    "trial.outcome counts exclusion response.answer_code response.chosen_object response.correct "
    "response.confidence response.reaction_s response.reaction_uncertainty_s "
    "adaptive_plan.run_name adaptive_plan.comparison_interval stimulus comparison_curvature_per_m "
    "comparison_mu_s comparison_mu_d since_first_ns trial_device trial.*";

std::vector<ExportTable> tables_of_trials() {
    const std::string trial = kSession + ", trial.trial_id";
    const std::string trials = " JOIN trial USING (session_id) JOIN numbered USING (trial_id)";
    const std::string adaptive = " adaptive_plan USING (session_id, plan_position)";
    return {
        table("trials", "one row an attempt at a planned trial, with its answer",
              trials +
                  " JOIN plan USING (session_id, plan_position) LEFT JOIN response USING (trial_id)"
                  " LEFT JOIN" +
                  adaptive,
              trial, kKeys + kTrialColumns),
        table("responses", "one row an answer", trials + " JOIN response USING (trial_id)", trial,
              kKeys + "trial_number response.*"),
        table("presentations", "one row an interval of an attempt: what was felt, and how",
              trials + " JOIN presentation USING (trial_id)", trial + ", presentation.interval",
              kKeys + "trial_number presentation.*"),
        table("adaptive_steps", "one row an answer that a rule took in",
              trials + " JOIN adaptive_step USING (trial_id) JOIN" + adaptive, trial,
              kKeys + "trial_number adaptive_plan.* adaptive_step.*"),
        table("events", "breaks, stops, resumes, faults", " JOIN event USING (session_id)",
              kSession + ", event.event_id",
              kKeys + "event_number trial_number=event_trial event.event_kind mark_undone "
                      "text=event_text words=event.text since_first_ns=event_since_first_ns "
                      "value=event_value event.*"),
    };
}

}  // namespace

const std::vector<ExportTable>& export_tables() {
    static const std::vector<ExportTable> all = [] {
        std::vector<ExportTable> made = tables_of_sessions();
        std::ranges::move(tables_of_trials(), std::back_inserter(made));
        return made;
    }();
    return all;
}

const std::vector<ExportColumn>& tick_columns() {
    static const std::vector<ExportColumn> all = [] {
        auto made = columns_of("subject study_label session_number trial_number interval");
        for (const TraceColumn& column : trace_columns()) {
            made.push_back({std::string(column.name), std::string(column.type),
                            std::string(column.unit), std::string(column.meaning), ""});
        }
        return made;
    }();
    return all;
}

const std::vector<ExportColumn>& code_columns() {
    static const std::vector<ExportColumn> all = columns_of("subject participant.participant_code");
    return all;
}

const ExportTable& export_table(std::string_view name) {
    const auto table = std::ranges::find(export_tables(), name, &ExportTable::name);
    refuse_if<std::logic_error>(table == export_tables().end(), "there is no table {}", name);
    return *table;
}

std::vector<std::pair<std::string_view, std::string_view>> levels_of(const ExportColumn& column) {
    std::vector<std::pair<std::string_view, std::string_view>> levels;
    for (std::string_view left(column.levels); !left.empty();) {
        const std::string_view one = left.substr(0, left.find("; "));
        left.remove_prefix(std::min(one.size() + 2, left.size()));
        const std::size_t sign = one.find(" = ");
        levels.emplace_back(one.substr(0, sign), one.substr(sign + 3));
    }
    return levels;
}

std::vector<ExportColumn> visible_columns(const ExportTable& table, bool details) {
    std::vector<ExportColumn> columns;
    for (const ExportColumn& column : table.columns) {
        if (details || !column.detail) {
            columns.push_back(column);
        }
    }
    return columns;
}

std::string select_sql(const ExportTable& table,
                       std::span<const ExportColumn> columns,
                       std::string_view where) {
    std::string names;
    for (const ExportColumn& column : columns) {
        names += fmt::format("{}{} AS {}", names.empty() ? "" : ", ", column.sql, column.name);
    }
    const std::size_t group = std::min(table.from.find(" GROUP BY "), table.from.size());
    return fmt::format("SELECT {} FROM {}{}{}{} ORDER BY {}", names, table.from.substr(0, group),
                       where.empty() ? "" : " WHERE ", where, table.from.substr(group),
                       table.order);
}

}  // namespace palpate::data
