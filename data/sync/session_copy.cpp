#include "data/sync/session_copy.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "data/store/chain.hpp"
#include "data/store/repairs.hpp"
#include "data/store/secret.hpp"
#include "data/store/written_rows.hpp"

namespace palpate::data {
namespace {

using Ids = std::vector<std::int64_t>;

void copy_owned(const SessionVersion& from,
                Database& out,
                const OwnedTable& table,
                std::string_view owner,
                std::int64_t from_id,
                std::int64_t to_id) {
    Statement add = out.prepare(table.insert(owner));
    for (const Statement& row : from.database->prepare(table.select(owner), from_id)) {
        bind_row(row, add.bind(1, to_id), 2).run();
    }
}

std::int64_t study_of(const SessionVersion& from, Database& out) {
    Statement row = from.database->first(
        "SELECT study_name, study_title, protocol_sha256, protocol_toml FROM study WHERE "
        "protocol_sha256 = ?1",
        from.study);
    Statement add = out.prepare(
        "INSERT INTO study (study_name, study_title, protocol_sha256, protocol_toml) VALUES (?1, "
        "?2, ?3, ?4) ON CONFLICT (protocol_sha256) DO UPDATE SET (study_name, study_title, "
        "protocol_toml) = (?1, ?2, ?4)");
    bind_row(row, add, 1).run();
    return out.first("SELECT study_id FROM study WHERE protocol_sha256 = ?1", from.study)
        .integer(0);
}

std::int64_t copy_session_row(const SessionVersion& from, Database& out, const Layout& layout) {
    const OwnedTable& table = layout.session;
    const std::int64_t study = study_of(from, out);
    Statement row = from.database->first(table.select("session_id"), from.id);
    Statement add = out.prepare(
        fmt::format(
            "INSERT INTO session (study_id, participant_id, session_number, {}) VALUES (?1, "
            "(SELECT participant_id FROM participant WHERE participant_code = ?2), ?3, {})",
            table.list(), table.places(4)),
        study, from.participant, from.number);
    bind_row(row, add, 4).run();
    return out.last_row();
}

/// Insert of a whole trial, or an update of one that is there (not 0).
std::int64_t copy_trial(const SessionVersion& from,
                        const TrialVersion& trial,
                        Database& out,
                        const Layout& layout,
                        std::int64_t session,
                        std::int64_t there) {
    OwnedTable whole = layout.trial;
    whole.columns.emplace_back("invalid_reason");
    Statement row = from.database->first(whole.select("trial_id"), trial.id);
    const bool is_new = there == 0;
    Statement write =
        out.prepare(is_new ? whole.insert("session_id") : whole.update(), is_new ? session : there);
    bind_row(row, write, 2).run();
    const std::int64_t id = is_new ? out.last_row() : there;
    for (const OwnedTable& table : layout.of_trial) {
        if (!is_new) {
            out.run(fmt::format("DELETE FROM {} WHERE trial_id = ?1", table.name), there);
        }
        copy_owned(from, out, table, "trial_id", trial.id, id);
    }
    return id;
}

void copy_events(const SessionVersion& from,
                 Database& out,
                 const Layout& layout,
                 std::int64_t session,
                 const Ids& trials,
                 std::size_t already) {
    const OwnedTable& event = layout.event;
    Statement row =
        from.database->prepare(fmt::format("SELECT trial_id, {} FROM event WHERE session_id = ?1 "
                                           "ORDER BY event_id LIMIT -1 OFFSET ?2",
                                           event.list()),
                               from.id, already);
    OwnedTable with_trial = event;
    with_trial.columns.insert(with_trial.columns.begin(), "trial_id");
    Statement add = out.prepare(with_trial.insert("session_id"));
    while (row.step()) {
        bind_row(row, add.bind(1, session), 2).bind(2, std::monostate());
        const auto at = std::ranges::find(from.trials, row.integer(0), &TrialVersion::id);
        if (!row.null(0) && at != from.trials.end()) {
            add.bind(2, trials.at(static_cast<std::size_t>(at - from.trials.begin())));
        }
        add.run();
    }
}

void copy_end(const SessionVersion& from,
              Database& out,
              const Layout& layout,
              std::int64_t session) {
    OwnedTable end = layout.session_end;
    end.columns.insert(end.columns.end(), layout.session_repairs.columns.begin(),
                       layout.session_repairs.columns.end());
    Statement row = from.database->first(end.select("session_id"), from.id);
    Statement write = out.prepare(end.update(), session);
    const std::string head = chain_head(*from.database, from.id);
    // Whose it is first: its number there is one that nobody has.
    out.run(
        "UPDATE session SET newest_seal = nullif(?2, ''), participant_id = (SELECT participant_id "
        "FROM participant WHERE participant_code = ?3) WHERE session_id = ?1",
        session, head, from.participant);
    bind_row(row, write, 2).run();
}

}  // namespace

void add_session(const SessionVersion& from, Database& out, const Layout& layout) {
    const std::int64_t session = copy_session_row(from, out, layout);
    for (const OwnedTable& table : layout.of_session) {
        copy_owned(from, out, table, "session_id", from.id, session);
    }
    Ids trials;
    for (const TrialVersion& trial : from.trials) {
        trials.push_back(copy_trial(from, trial, out, layout, session, 0));
    }
    copy_events(from, out, layout, session, trials, 0);
    copy_end(from, out, layout, session);
}

void extend_session(const SessionVersion& from,
                    const SessionVersion& own,
                    Database& out,
                    const Layout& layout) {
    Ids trials;
    for (std::size_t i = 0; i < from.trials.size(); ++i) {
        const TrialVersion& trial = from.trials[i];
        const std::int64_t there = i < own.trials.size() ? own.trials[i].id : 0;
        const bool same = there != 0 && own.trials[i].content == trial.content &&
                          own.trials[i].invalid == trial.invalid;
        trials.push_back(same ? there : copy_trial(from, trial, out, layout, own.id, there));
    }
    copy_events(from, out, layout, own.id, trials, own.events.size());
    copy_end(from, out, layout, own.id);
}

void replace_session(const SessionVersion& from,
                     const SessionVersion& own,
                     Database& out,
                     const Layout& layout) {
    clear_session(out, own.id);
    out.run("DELETE FROM session WHERE session_id = ?1", own.id);
    add_session(from, out, layout);
}

void copy_shared(Database& from, Database& out, const std::string& file) {
    require_trace_columns(from, file);
    keep_trace_columns(out);
    Statement add = out.prepare("INSERT OR IGNORE INTO secret (hex) VALUES (?1)");
    for (const Statement& row : from.prepare("SELECT hex FROM secret")) {
        bind_row(row, add, 1).run();
    }
}

void append_session(Database& from, Database& out, const Layout& layout) {
    const SessionVersion session = session_versions(from, layout, from.file(), false).at(0);
    participant_row(out, session.participant, own_secret(from));
    add_session(session, out, layout);
    copy_shared(from, out, from.file());
}

}  // namespace palpate::data
