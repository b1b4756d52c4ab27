#include "data/store/people.hpp"

#include <charconv>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/realtime/clock.hpp"
#include "data/store/secret.hpp"

namespace palpate::data {

std::optional<Participant> find_participant(Database& database, std::string_view code) {
    Statement row = database.prepare(
        "SELECT id, handedness, consent, coalesce(consent_utc, ''),"
        " (SELECT count(*) FROM session WHERE session.participant = participant.id), subject"
        " FROM participant WHERE code = ?1");
    if (!row.bind(1, code).step()) {
        return std::nullopt;
    }
    Participant found{
        .consent_utc = row.text(3), .sessions = row.integer(4), .subject = row.integer(5)};
    if (!row.null(1)) {
        found.notes.handedness = row.integer(1);
    }
    if (!row.null(2)) {
        found.notes.consent = row.integer(2) != 0;
    }
    Statement detail = database.prepare(
        "SELECT key, value FROM participant_detail WHERE participant = ?1 ORDER BY key");
    detail.bind(1, row.integer(0));
    while (detail.step()) {
        found.notes.details.emplace_back(detail.text(0), detail.text(1));
    }
    return found;
}

void note_participant(Database& database, std::string_view code, const ParticipantNotes& notes) {
    Transaction all(database);
    participant_row(database, code, own_secret(database));
    if (notes.handedness) {
        database.prepare("UPDATE participant SET handedness = ?2 WHERE code = ?1")
            .bind(1, code)
            .bind(2, *notes.handedness)
            .run();
    }
    if (notes.consent) {
        database
            .prepare(
                "UPDATE participant SET consent = ?2, consent_utc = ?3"
                " WHERE code = ?1 AND consent IS NOT ?2")
            .bind(1, code)
            .bind(2, std::int64_t{*notes.consent ? 1 : 0})
            .bind(3, utc_now())
            .run();
    }
    Statement detail = database.prepare(
        "INSERT INTO participant_detail SELECT id, ?2, ?3 FROM participant WHERE code = ?1"
        " ON CONFLICT (participant, key) DO UPDATE SET value = excluded.value");
    for (const auto& [key, value] : notes.details) {
        detail.bind(1, code).bind(2, key).bind(3, value).run();
    }
    all.commit();
}

std::vector<SessionRow> sessions_of(Database& database,
                                    std::string_view code,
                                    std::optional<std::size_t> number) {
    Statement row = database.prepare(
        "SELECT session.id, name, number FROM session JOIN study ON study.id = study"
        " JOIN participant ON participant.id = participant"
        " WHERE code = ?1 AND (?2 IS NULL OR number = ?2) ORDER BY session.id DESC");
    row.bind(1, code).bind(
        2, number ? std::optional(static_cast<std::int64_t>(*number)) : std::nullopt);
    std::vector<SessionRow> all;
    while (row.step()) {
        all.push_back({.id = row.integer(0), .study = row.text(1), .number = row.integer(2)});
    }
    return all;
}

void add_note(Database& database, std::int64_t session, std::string_view text) {
    database
        .prepare(
            "INSERT INTO event (session, kind, text, at_utc, at_ns) VALUES (?1, 'note', ?2, ?3, "
            "?4)")
        .bind(1, session)
        .bind(2, text)
        .bind(3, utc_now())
        .bind(4, engine::monotonic_ns())
        .run();
}

bool mark_invalid(Database& database, std::int64_t trial, std::string_view reason) {
    Transaction all(database);
    Statement row = database.prepare(
        "SELECT outcome, response.trial IS NOT NULL, invalid, finished, session.id FROM trial"
        " JOIN session ON session.id = trial.session"
        " LEFT JOIN response ON response.trial = trial.id WHERE trial.id = ?1");
    if (!row.bind(1, trial).step()) {
        throw std::invalid_argument(fmt::format(
            "{}: there is no trial {}; SELECT id FROM trial lists them", database.file(), trial));
    }
    if (row.integer(1) == 0) {
        throw std::invalid_argument(
            fmt::format("{}: trial {} is {} and has no answer that could count", database.file(),
                        trial, row.text(0)));
    }
    if (!row.null(2)) {
        throw std::invalid_argument(fmt::format("{}: trial {} does not count already: {}",
                                                database.file(), trial, row.text(2)));
    }
    const bool finished = row.integer(3) != 0;
    const std::int64_t session = row.integer(4);
    row.reset();
    database.prepare("UPDATE trial SET invalid = ?2 WHERE id = ?1")
        .bind(1, trial)
        .bind(2, reason)
        .run();
    database
        .prepare(
            "INSERT INTO event (session, trial, kind, text, at_utc, at_ns)"
            " SELECT ?1, ?2, 'mark', 'after ' || count(*) || ' attempts: ' || ?3, ?4, ?5 FROM trial"
            " WHERE session = ?1")
        .bind(1, session)
        .bind(2, trial)
        .bind(3, reason)
        .bind(4, utc_now())
        .bind(5, engine::monotonic_ns())
        .run();
    all.commit();
    return finished;
}

std::optional<Mark> read_mark(Database& database, std::int64_t session, std::string_view text) {
    constexpr std::string_view kAfter = "after ";
    const std::size_t colon = text.find(" attempts: ");
    Mark mark;
    if (!text.starts_with(kAfter) || colon == std::string_view::npos ||
        std::from_chars(text.data() + kAfter.size(), text.data() + colon, mark.after).ptr !=
            text.data() + colon) {
        return std::nullopt;
    }
    mark.reason = text.substr(text.find(": ") + 2);
    Statement last = database.prepare(
        "SELECT coalesce(max(id), 0) FROM (SELECT id FROM trial WHERE session = ?1 ORDER BY id"
        " LIMIT ?2)");
    last.bind(1, session).bind(2, mark.after).step();
    mark.after = last.integer(0);
    return mark;
}

std::optional<Mark> find_mark(Database& database, std::int64_t trial) {
    Statement row =
        database.prepare("SELECT text, session FROM event WHERE trial = ?1 AND kind = 'mark'");
    if (!row.bind(1, trial).step()) {
        return std::nullopt;
    }
    return read_mark(database, row.integer(1), row.text(0));
}

}  // namespace palpate::data
