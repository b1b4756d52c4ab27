#include "data/store/people.hpp"

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "data/store/secret.hpp"
#include "data/store/session_lock.hpp"

namespace palpate::data {
namespace {

/// The code without what people write now so, now so: cases, - and _, leading zeros of its numbers.
std::string heard(std::string_view code) {
    std::string out;
    for (const char c : code) {
        const bool digit = c >= '0' && c <= '9';
        if (c == '-' || c == '_') {
            continue;
        }
        if (digit && out.ends_with('0') &&
            (out.size() < 2 || out[out.size() - 2] < '0' || out[out.size() - 2] > '9')) {
            out.back() = c;  // a number does not begin with 0
            continue;
        }
        out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return out;
}

/// What was noted of a participant; the value of a detail stands nowhere else.
protocols::Event noted(const std::string& key, const std::string& value = {}) {
    return {.kind = protocols::EventKind::participant,
            .text = value.empty() ? "detail " + key : fmt::format("{} {}", key, value),
            .key = key,
            .value = value};
}

/// To each session of the participant of which something is left.
void tell_sessions(Database& database,
                   std::string_view code,
                   const protocols::Event& event,
                   std::string_view operator_name,
                   std::string_view utc) {
    for (const SessionRow& session : sessions_of(database, code, std::nullopt)) {
        if (!is_destroyed(database, session.id)) {
            add_event(database, session.id, event, operator_name, utc);
        }
    }
}

protocols::Event noted_handedness(std::int64_t score) {
    return noted("handedness", fmt::format("{}", score));
}

protocols::Event noted_consent(bool given) {
    return noted("consent", given ? "yes" : "no");
}

/// A trial that somebody wants to mark, or not any more.
struct Markable {
    std::string outcome;
    bool answered = false;
    std::optional<std::string> invalid{};
    bool finished = false;  ///< its session
    std::int64_t session = 0;
};

/// @throws std::invalid_argument if there is none, or while a program runs its session
Markable markable(Database& database, std::int64_t trial) {
    Statement row = database.prepare(
        "SELECT outcome, response.trial_id IS NOT NULL, invalid_reason, finished, "
        "session.session_id FROM trial JOIN session USING (session_id) LEFT JOIN response USING "
        "(trial_id) WHERE trial.trial_id = ?1",
        trial);
    refuse_if(!row.step(), "{}: there is no trial {}; SELECT trial_id FROM trial lists them",
              database.file(), trial);
    return {.outcome = row.text(0),
            .answered = row.integer(1) != 0,
            .invalid = row.text_or_none(2),
            .finished = row.integer(3) != 0,
            .session = row.integer(4)};
}

void refuse_running(Database& database, std::int64_t trial, std::int64_t session) {
    refuse_if(SessionLock::held(database, session),
              "{}: the session of trial {} runs now, and would not hear of it; mark its last trial "
              "at the participant's screen (Ctrl+Shift+M then Y), others when it has ended",
              database.file(), trial);
}

/// What the session did because of a mark and would not have done without it; empty: nothing.
std::string came_of_mark(Database& database, std::int64_t trial) {
    Statement row = database.first(
        "WITH own AS (SELECT session_id, plan_position, iif(phase = 'practice', 0, 1 + block) AS "
        "part, (SELECT count(*) FROM trial AS t WHERE t.session_id = trial.session_id AND "
        "t.trial_id <= trial.trial_id) AS number, run_number, (SELECT trials_begun FROM event "
        "WHERE event.trial_id = trial.trial_id AND event_kind = 'mark' ORDER BY event_id DESC "
        "LIMIT 1) AS marked FROM trial JOIN plan USING (session_id, plan_position) LEFT JOIN "
        "adaptive_plan USING (session_id, plan_position) WHERE trial_id = ?1) SELECT (SELECT "
        "'trial ' || trial_id || ' took its place and counts: mark that one first' FROM trial JOIN "
        "response USING (trial_id) WHERE trial.session_id = own.session_id AND trial.plan_position "
        "= own.plan_position AND invalid_reason IS NULL LIMIT 1), (SELECT 'its part of the session "
        "was run again' FROM event WHERE event.session_id = own.session_id AND event_kind = 'redo' "
        "AND event.part = own.part AND trials_begun >= number LIMIT 1), (SELECT 'its rule went on "
        "without it' FROM trial JOIN adaptive_step USING (trial_id) JOIN adaptive_plan USING "
        "(session_id, plan_position) WHERE trial.session_id = own.session_id AND "
        "adaptive_plan.run_number = own.run_number AND (SELECT count(*) FROM trial AS t WHERE "
        "t.session_id = own.session_id AND t.trial_id <= trial.trial_id) > marked LIMIT 1) FROM "
        "own",
        trial);
    for (int column = 0; column < row.columns(); ++column) {
        if (!row.null(column)) {
            return row.text(column);
        }
    }
    return {};
}

}  // namespace

std::optional<std::string> similar_participant(Database& database, std::string_view code) {
    Statement row =
        database.prepare("SELECT participant_code FROM participant ORDER BY participant_id");
    std::optional<std::string> found;
    while (row.step()) {
        const std::string other = row.text(0);
        if (other == code) {
            return std::nullopt;
        }
        if (!found && heard(other) == heard(code)) {
            found = other;
        }
    }
    return found;
}

std::optional<Participant> find_participant(Database& database, std::string_view code) {
    Statement row = database.prepare(
        "SELECT participant_id, handedness, consent, coalesce(consent_utc, ''), (SELECT count(*) "
        "FROM session WHERE session.participant_id = participant.participant_id), subject, "
        "coalesce(destroyed_utc, '') FROM participant WHERE participant_code = ?1",
        code);
    if (!row.step()) {
        return std::nullopt;
    }
    Participant found{.notes = {.handedness = row.integer_or_none(1)},
                      .consent_utc = row.text(3),
                      .destroyed_utc = row.text(6),
                      .sessions = row.integer(4),
                      .subject = row.integer(5)};
    if (!row.null(2)) {
        found.notes.consent = row.integer(2) != 0;
    }
    for (const Statement& detail : database.prepare(
             "SELECT key, value FROM participant_detail WHERE participant_id = ?1 ORDER BY key",
             row.integer(0))) {
        found.notes.details.emplace_back(detail.text(0), detail.text(1));
    }
    return found;
}

std::string newest_note(Database& database, std::string_view code) {
    return database
        .first(
            "SELECT coalesce(max(utc), '') FROM (SELECT max(coalesce(handedness_utc, ''), "
            "coalesce(consent_utc, ''), coalesce(destroyed_utc, '')) AS utc, participant_code FROM "
            "participant UNION ALL SELECT noted_utc, participant_code FROM participant_detail JOIN "
            "participant USING (participant_id)) WHERE ?1 IN ('', participant_code)",
            code)
        .text(0);
}

std::string note_time(Database& database, std::string_view code) {
    return database
        .first("SELECT max(?1, coalesce(strftime('%Y-%m-%dT%H:%M:%fZ', ?2, '+0.001 seconds'), ''))",
               database.utc_now(), newest_note(database, code))
        .text(0);
}

void note_participant(Database& database,
                      std::string_view code,
                      const ParticipantNotes& notes,
                      std::string_view operator_name) {
    Transaction all(database);
    participant_row(database, code, own_secret(database));
    const std::string utc = note_time(database, code);
    const auto note = [&](std::string_view sql, auto value, const protocols::Event& event) {
        database.run(sql, code, value, utc);
        tell_sessions(database, code, event, operator_name, utc);
    };
    if (notes.handedness) {
        note(
            "UPDATE participant SET handedness = ?2, handedness_utc = ?3 WHERE participant_code = "
            "?1",
            *notes.handedness, noted_handedness(*notes.handedness));
    }
    if (notes.consent) {
        note(
            "UPDATE participant SET consent = ?2, consent_utc = ?3, refusals_utc = iif(?2, "
            "refusals_utc, ltrim(coalesce(refusals_utc, '') || ' ' || ?3)) WHERE participant_code "
            "= ?1",
            *notes.consent, noted_consent(*notes.consent));
    }
    for (const auto& [key, value] : notes.details) {
        database.run(
            "INSERT INTO participant_detail SELECT participant_id, ?2, ?3, ?4 FROM participant "
            "WHERE participant_code = ?1 ON CONFLICT (participant_id, key) DO UPDATE SET value = "
            "excluded.value, noted_utc = excluded.noted_utc",
            code, key, value, utc);
        tell_sessions(database, code, noted(key), operator_name, utc);
    }
    all.commit();
}

void note_at_beginning(Database& database, std::int64_t session) {
    Statement row = database.first(
        "SELECT handedness, consent, coalesce(handedness_utc, ''), coalesce(consent_utc, '') FROM "
        "participant JOIN session USING (participant_id) WHERE session.session_id = ?1",
        session);
    std::vector<std::pair<protocols::Event, std::string>> events;
    if (!row.null(0)) {
        events.emplace_back(noted_handedness(row.integer(0)), row.text(2));
    }
    if (!row.null(1)) {
        events.emplace_back(noted_consent(row.integer(1) != 0), row.text(3));
    }
    row.reset();
    for (const auto& [event, utc] : events) {
        add_event(database, session, event, {}, utc);
    }
}

std::vector<NoteBreak> note_breaks(Database& database) {
    // A session's last word on each is what was noted last: a note goes to all sessions that are
    // there.
    Statement row = database.prepare(
        "SELECT DISTINCT participant_code, key, stored, value, coalesce(stored_utc > word_utc OR "
        "(stored = 'no' AND stored_utc <> word_utc), 0) AS later FROM (SELECT participant_id, "
        "participant_code, key, value, coalesce(noted_utc, at_utc) AS word_utc, iif(key = "
        "'handedness', CAST(handedness "
        "AS TEXT), iif(consent, 'yes', 'no')) AS stored, iif(key = 'handedness', handedness_utc, "
        "consent_utc) AS stored_utc, row_number() OVER (PARTITION BY session_id, key ORDER BY "
        "event_id DESC) AS back FROM event JOIN session USING (session_id) JOIN participant USING "
        "(participant_id) WHERE event_kind = 'participant' AND key IN ('handedness', 'consent') "
        "AND value IS NOT NULL AND event_id > (SELECT coalesce(max(moved.event_id), 0) FROM event "
        "AS moved WHERE moved.session_id = session.session_id AND moved.event_kind = 'participant' "
        "AND moved.key = ?1)) AS word WHERE back = 1 AND stored IS NOT value AND NOT (later AND "
        "EXISTS (SELECT 1 FROM event JOIN session USING (session_id) WHERE session.participant_id "
        "= word.participant_id AND event_kind = 'participant' AND event.key = word.key AND "
        "event.value = stored AND coalesce(noted_utc, at_utc) = stored_utc)) ORDER BY 1, 2",
        kIsReally);
    return row.all([](const Statement& one) {
        return NoteBreak{.what = fmt::format("participant {} {}", one.text(0), one.text(1)),
                         .stored = one.null(2) ? "NULL" : one.text(2),
                         .noted = one.text(3),
                         .later = one.integer(4) != 0};
    });
}

std::vector<SessionRow> sessions_of(Database& database,
                                    std::string_view code,
                                    std::optional<std::size_t> number,
                                    std::string_view study) {
    Statement row = database.prepare(
        "SELECT session.session_id, study_name, study_name || '@' || substr(protocol_sha256, 1, 8) "
        "AS version, session_number FROM session JOIN study USING (study_id) JOIN participant "
        "USING (participant_id) WHERE participant_code = ?1 AND (?2 IS NULL OR session_number = "
        "?2) AND ?3 IN ('', study_name, version) ORDER BY session.session_id DESC",
        code, number ? std::optional(static_cast<std::int64_t>(*number)) : std::nullopt, study);
    return row.all([](const Statement& one) {
        return SessionRow{.id = one.integer(0),
                          .study = one.text(1),
                          .version = one.text(2),
                          .number = one.integer(3)};
    });
}

bool is_destroyed(Database& database, std::int64_t session) {
    return database
        .prepare("SELECT 1 FROM event WHERE session_id = ?1 AND event_kind = 'mark' AND key = ?2",
                 session, kDestroyed)
        .step();
}

std::string add_note(Database& database,
                     std::int64_t session,
                     std::string_view text,
                     std::string_view operator_name) {
    Transaction all(database);
    refuse_if(is_destroyed(database, session),
              "{}: what is to be noted is of a session that was destroyed, where nothing may be "
              "added: name another session, or keep it elsewhere",
              database.file());
    std::string head =
        add_event(database, session,
                  {.kind = protocols::EventKind::note, .text = std::string(text)}, operator_name);
    all.commit();
    return head;
}

MarkResult mark_invalid(Database& database, std::int64_t trial, const Reason& why) {
    Transaction all(database);
    const Markable found = markable(database, trial);
    refuse_if(!found.answered, "{}: trial {} is {} and has no answer that could count",
              database.file(), trial, found.outcome);
    refuse_if(found.invalid.has_value(), "{}: trial {} does not count already: {}", database.file(),
              trial, found.invalid.value_or(""));
    refuse_running(database, trial, found.session);
    MarkResult marked{.finished = found.finished,
                      .head = add_mark(database, found.session, trial, why)};
    all.commit();
    return marked;
}

MarkResult undo_mark(Database& database, std::int64_t trial, const Reason& why) {
    Transaction all(database);
    const Markable found = markable(database, trial);
    refuse_if(!mark_reason(database, trial), "{}: trial {} {}: there is no mark to take back",
              database.file(), trial,
              found.invalid    ? "does not count by a rule: " + *found.invalid
              : found.answered ? "counts"
                               : "has no answer");
    const std::string kept = came_of_mark(database, trial);
    refuse_if(!kept.empty(), "{}: the mark of trial {} stays: {}", database.file(), trial, kept);
    refuse_running(database, trial, found.session);
    MarkResult undone{.finished = found.finished,
                      .head = add_mark(database, found.session, trial, why, true)};
    all.commit();
    return undone;
}

}  // namespace palpate::data
