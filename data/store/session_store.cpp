#include "data/store/session_store.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "engine/commissioning/rig_record.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/session/trust.hpp"
#include "data/store/chain.hpp"
#include "data/store/people.hpp"
#include "data/store/row.hpp"
#include "data/store/secret.hpp"
#include "data/store/stored_progress.hpp"
#include "data/store/uuid.hpp"
#include "data/store/written_rows.hpp"

namespace palpate::data {
namespace {

std::int64_t study_row(Database& database, const SessionSpec& spec) {
    Row("study")
        .set("study_name", spec.protocol.id)
        .set("study_title", spec.protocol.title)
        .set("protocol_sha256", spec.protocol_hash)
        .set("protocol_toml", protocols::to_toml(spec.protocol))
        .insert(database, "ON CONFLICT (protocol_sha256) DO NOTHING");
    const std::int64_t id =
        database.first("SELECT study_id FROM study WHERE protocol_sha256 = ?1", spec.protocol_hash)
            .integer(0);
    require_study(database, id);
    return id;
}

Row session_row(Database& database, const SessionSpec& spec) {
    const std::int64_t study = study_row(database, spec);
    keep_secret(database, spec.key.secret);
    Row row("session");
    row.set("study_id", study)
        .set("participant_id", participant_row(database, spec.key.participant, spec.key.secret))
        .set("session_number", spec.key.session)
        .set("session_kind", to_string(spec.kind))
        .set("seed", std::to_string(spec.seed))
        .set("plan_sha256", spec.plan.hash)
        .set("shuffles", spec.plan.attempts)
        .set("device", spec.device)
        .set("rate_hz", spec.protocol.apparatus.rate_hz)
        .set("stiffness_n_per_m", spec.protocol.apparatus.stiffness)
        .set("started_utc", database.utc_now())
        .set("operator",
             spec.operator_name.empty() ? std::nullopt : std::optional(spec.operator_name))
        .set("secret", spec.key.secret);
    return row;
}

/// @param instead  of this session, whose plan is gone
std::int64_t create(Database& database,
                    const SessionSpec& spec,
                    std::optional<std::int64_t> instead = {}) {
    Row row = session_row(database, spec);
    std::int64_t session = instead.value_or(0);
    if (instead) {
        row.set("session_id", session).set("newest_seal", std::optional<std::string>());
        row.update(database, {"session_id"});
    } else {
        session = row.set("uuid", spec.uuid.empty() ? random_uuid() : spec.uuid).insert(database);
    }
    for (const auto& rows_of : {plan_rows, picture_rows, adaptive_plan_rows}) {
        for (Row& planned : rows_of(spec.protocol, spec.plan)) {
            planned.set("session_id", session).insert(database);
        }
    }
    for (const auto& [key, value] : spec.provenance) {
        Row("session_provenance")
            .set("session_id", session)
            .set("key", key)
            .set("value", value)
            .insert(database);
    }
    keep_trace_columns(database);
    note_at_beginning(database, session);
    return session;
}

/// What a session goes on with belongs to the trials from here on: the first trials keep theirs.
void note_changes(Database& database, const SessionState& there, const SessionSpec& spec) {
    const auto goes_on = [&](protocols::EventKind kind, const std::string& value) {
        add_event(database, there.id,
                  {.kind = kind, .text = "goes on with " + value, .value = value});
    };
    if (next_device(database, there.id).name != spec.device) {
        goes_on(protocols::EventKind::device, spec.device);
    }
    if (!spec.operator_name.empty() && there.operator_name != spec.operator_name) {
        goes_on(protocols::EventKind::experimenter, spec.operator_name);
    }
    const auto holds = [&](const std::string& key, const std::string& value) {
        add_event(database, there.id,
                  {.kind = protocols::EventKind::provenance,
                   .text = fmt::format("{}: {}", key, value.empty() ? "none" : value),
                   .key = key,
                   .value = value});
    };
    Provenance before = next_provenance(database, there.id);
    for (const auto& [key, value] : spec.provenance) {
        const auto said = before.extract(key);
        if ((said ? said.mapped() : "") != value) {
            holds(key, value);
        }
    }
    for (const auto& [key, value] : before) {  // what it goes on with has none
        holds(key, "");
    }
}

/// It was withdrawn, or run under another code or number.
bool is_over(const SessionState& there, const SessionSpec& spec) {
    return there.over == "was withdrawn" || there.run_as.participant != spec.key.participant ||
           there.run_as.session != spec.key.session;
}

void require_same(const Database& database, const SessionState& there, const SessionSpec& spec) {
    const auto refuse = [&](std::string_view what, std::string_view remedy) {
        throw StoreError(fmt::format("{}: session {} of {} in {} {}; {}", database.file(),
                                     spec.key.session, spec.key.participant, spec.protocol.id, what,
                                     remedy));
    };
    if (is_over(there, spec)) {
        refuse("was withdrawn, or run under another code", "begin a new session with --session");
    }
    if (there.protocol_hash != spec.protocol_hash) {
        refuse(fmt::format("was begun with another version of the protocol ({})",
                           protocols::differences_text(there.protocol_toml,
                                                       protocols::to_toml(spec.protocol))),
               "run the version it was begun with, or begin a new session with --session");
    }
    // The seed too: the order of a small plan can come from many seeds, the hand and the answers
    // not.
    if (there.plan_hash != spec.plan.hash || there.seed != spec.seed) {
        refuse(fmt::format("was begun with another plan (seed {})", there.seed),
               "give the same --seed, or begin a new session with --session");
    }
    if (there.kind != to_string(spec.kind)) {
        refuse(fmt::format("is a {} session", there.kind),
               fmt::format("it cannot go on as {}: begin a new session with --session",
                           to_string(spec.kind)));
    }
}

/// What was felt on one device is not to be mixed with another by accident.
void require_same_device(Database& database, const SessionState& there, const SessionSpec& spec) {
    const auto said = [&](std::string_view key) {
        const auto made =
            std::ranges::find(spec.provenance, key, &std::pair<std::string, std::string>::first);
        return made == spec.provenance.end() ? std::string() : made->second;
    };
    const TrialDevice now{spec.device, said(kCalibrationHashKey)};
    const auto before = last_device(database, there.id);
    const auto board = engine::board_id(said(protocols::kBoard));
    const auto last = engine::board_id(last_board(database, there.id));
    const bool same = before && same_rig(*before, now) && (!board || !last || board == last);
    if (before && !same && !spec.other_device && there.over.empty()) {
        const auto text = [](const TrialDevice& device, std::optional<std::uint32_t> id) {
            return device_text(device) + (id ? fmt::format(", the board with the id {}", *id) : "");
        };
        throw OtherDevice(
            fmt::format("session {} of {} in {} was felt on {} so far, and would go on with {}",
                        spec.key.session, spec.key.participant, spec.protocol.id,
                        text(*before, last), text(now, board)));
    }
}

/// Without a trial nothing was felt and no picture was seen: where the session would now be another
/// one (another row of the counterbalance, seed, kind or version of the protocol), it is planned
/// anew. Its events stay.
/// @return whether it was
bool planned_anew(Database& database, const SessionState& there, const SessionSpec& spec) {
    const bool stays =
        there.begun || is_over(there, spec) ||
        (there.protocol_hash == spec.protocol_hash && there.plan_hash == spec.plan.hash &&
         there.seed == spec.seed && there.kind == to_string(spec.kind));
    if (stays) {
        return false;
    }
    const std::string head = chain_head(database, there.id);
    for (const char* table : {"session_provenance", "adaptive_plan", "plan", "picture"}) {
        database.run(fmt::format("DELETE FROM {} WHERE session_id = ?1", table), there.id);
    }
    create(database, spec, there.id);
    chain_anew(database, there.id);
    database.run(
        "DELETE FROM study WHERE NOT EXISTS (SELECT 1 FROM session WHERE study_id = "
        "study.study_id)");
    add_event(database, there.id,
              {.kind = protocols::EventKind::planned_again,
               .text = fmt::format(
                   "no trial had begun of the {} session with seed {}, plan {} and seal {}",
                   there.kind, there.seed, there.plan_hash, head)});
    return true;
}

std::size_t mark_interrupted(Database& database, std::int64_t session) {
    const std::vector<std::int64_t> found = integers(database.prepare(
        "SELECT trial_id FROM trial WHERE session_id = ?1 AND outcome = 'running' ORDER BY 1",
        session));
    for (const std::int64_t trial : found) {
        add_event(database, session,
                  {.kind = protocols::EventKind::interrupted,
                   .text = "found running when the session was opened again",
                   .trial = trial});
    }
    database.run(
        "UPDATE trial SET outcome = 'interrupted' WHERE session_id = ?1 AND outcome = 'running'",
        session);
    for (const std::int64_t trial : found) {
        chain_trial(database, trial);
    }
    return found.size();
}

OpenedSession opened_session(Database& database, const SessionSpec& spec) {
    const auto there =
        find_session(database, spec.protocol.id, spec.key.participant, spec.key.session);
    const std::int64_t id = there ? there->id : create(database, spec);
    // Before anything changes: a trial that runs now is not interrupted.
    OpenedSession opened{.lock = SessionLock(database, id), .id = id, .resumed = there.has_value()};
    if (there && planned_anew(database, *there, spec)) {
        opened.resumed = false;
    } else if (there) {
        require_study(database, there->study);
        require_same(database, *there, spec);
        require_same_device(database, *there, spec);
        note_changes(database, *there, spec);
        opened.finished = !there->over.empty();
        opened.interrupted = mark_interrupted(database, id);
    }
    opened.progress = stored_progress(
        database, id, protocols::SessionProgress(spec.protocol, spec.plan, session_stream(spec)));
    if (opened.resumed && !opened.finished) {
        opened.progress = begin_again(database, id, spec.resume, std::move(opened.progress));
    }
    opened.next = opened.progress.pending().next();
    opened.last_trial =
        database.first("SELECT coalesce(max(trial_id), 0) FROM trial WHERE session_id = ?1", id)
            .integer(0);
    return opened;
}

RowsTaken rows_taken(Database& database, const SessionSpec& spec) {
    return rows_taken(database, spec.protocol, spec.key, to_string(spec.kind));
}

protocols::Plan planned(const SessionSpec& spec, const RowsTaken& rows) {
    return make_plan(spec.protocol, spec.protocol_hash, spec.key, spec.seed, rows.pictures,
                     rows.frictions);
}

}  // namespace

std::string_view to_string(RunKind kind) noexcept {
    return kind == RunKind::real ? "real" : kind == RunKind::pilot ? "pilot" : "simulated";
}

protocols::StreamKey session_stream(const SessionSpec& spec) {
    return session_stream(spec.protocol_hash, spec.key, spec.seed);
}

RowsTaken rows_taken(Database& database,
                     const protocols::Protocol& protocol,
                     const protocols::SessionKey& key,
                     std::string_view kind) {
    const auto [pictures, own] = orders_of(database, Balanced::pictures, protocol.id, key, kind);
    const auto [blocks, first] = orders_of(database, Balanced::frictions, protocol.id, key, kind);
    return {picture_history(protocol, pictures, own), friction_history(protocol, blocks, first)};
}

OpenedSession open_session(Database& database, const SessionSpec& spec) {
    Transaction all(database);
    OpenedSession opened = opened_session(database, spec);
    all.commit();
    return opened;
}

void check_session(Database& database, SessionSpec spec) {
    const Transaction undone(database);
    spec.plan = planned(spec, rows_taken(database, spec));
    static_cast<void>(opened_session(database, spec));
}

OpenedSession plan_and_open_session(Database& database,
                                    SessionSpec& spec,
                                    const std::function<void()>& asks) {
    const RowsTaken before = rows_taken(database, spec);
    spec.plan = planned(spec, before);
    Transaction all(database);
    if (asks) {
        asks();
    }
    if (const RowsTaken now = rows_taken(database, spec); now != before) {
        spec.plan = planned(spec, now);
    }
    OpenedSession opened = opened_session(database, spec);
    all.commit();
    return opened;
}

std::optional<SessionState> find_session(Database& database,
                                         std::string_view study,
                                         std::string_view participant,
                                         std::optional<std::size_t> number) {
    // What was withdrawn, or run as somebody else, is over: its orders were drawn for another key,
    // or are of no use.
    Statement row = database.prepare(
        "SELECT session_number, seed, CASE WHEN withdrawn_reason IS NOT NULL THEN 'was withdrawn' "
        "WHEN finished THEN 'is finished' WHEN run_code IS NOT NULL THEN 'was run under another "
        "code' ELSE '' END, secret, EXISTS (SELECT 1 FROM trial WHERE trial.session_id = "
        "session.session_id), session_kind, coalesce(run_code, participant_code), "
        "coalesce(run_number, session_number), plan_sha256, session.session_id, study_id, "
        "protocol_sha256, protocol_toml, coalesce(operator, '') FROM session JOIN study USING "
        "(study_id) JOIN participant USING (participant_id) WHERE study_name = ?1 AND "
        "participant_code = ?2 AND (?3 IS NULL OR session_number = ?3) ORDER BY session_number "
        "DESC LIMIT 1",
        study, participant, number);
    if (!row.step()) {
        return std::nullopt;
    }
    return SessionState{
        .number = static_cast<std::size_t>(row.integer(0)),
        .seed = std::stoull(row.text(1)),
        .over = row.text(2),
        .begun = row.integer(4) != 0,
        .kind = row.text(5),
        .run_as = {row.text(6), static_cast<std::size_t>(row.integer(7)), row.text(3)},
        .plan_hash = row.text(8),
        .id = row.integer(9),
        .study = row.integer(10),
        .protocol_hash = row.text(11),
        .protocol_toml = row.text(12),
        .operator_name = row.text(13)};
}

std::optional<OtherVersion> other_version(Database& database,
                                          std::string_view study,
                                          std::string_view protocol_sha256,
                                          RunKind kind) {
    Statement row = database.prepare(
        "SELECT protocol_sha256, protocol_toml, (SELECT count(DISTINCT participant_id) FROM "
        "session AS same WHERE same.study_id = session.study_id AND same.session_kind = ?2 AND "
        "EXISTS (SELECT 1 FROM trial WHERE trial.session_id = same.session_id)) FROM trial JOIN "
        "session USING (session_id) JOIN study USING (study_id) WHERE study_name = ?1 AND "
        "session_kind = ?2 ORDER BY trial_id DESC LIMIT 1",
        study, to_string(kind));
    const bool other = row.step() && row.text(0) != protocol_sha256;
    return other ? std::optional(OtherVersion{row.integer(2), row.text(1)}) : std::nullopt;
}

}  // namespace palpate::data
