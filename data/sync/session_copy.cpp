#include <algorithm>

#include <fmt/format.h>

#include "data/store/chain.hpp"
#include "data/store/people.hpp"
#include "data/store/row.hpp"
#include "data/store/secret.hpp"
#include "data/store/written_rows.hpp"
#include "data/sync/session_version.hpp"

namespace palpate::data {
namespace {

using Ids = std::vector<std::int64_t>;

/// Of a session, from its file into `out`.
class Copy {
public:
    Copy(const SessionVersion& from, Database& out, const Layout& layout)
        : from_(from), out_(out), layout_(layout) {}

    void whole() const {
        SessionVersion own;  // with nothing yet
        own.id = session_row();
        for (const OwnedTable& table : layout_.of_session) {
            owned(table, "session_id", from_.id, own.id);
        }
        rest(own);
    }

    /// What came since, to `own`.
    void rest(const SessionVersion& own) const {
        Ids trials;
        for (std::size_t i = 0; i < from_.trials.size(); ++i) {
            const TrialVersion& one = from_.trials[i];
            const std::int64_t there = i < own.trials.size() ? own.trials[i].id : 0;
            const bool same = there != 0 && own.trials[i].content == one.content &&
                              own.trials[i].invalid == one.invalid;
            trials.push_back(same ? there : trial(one, own.id, there));
        }
        events(own.id, trials, own.events.size());
        end(own.id);
    }

private:
    void owned(const OwnedTable& table,
               std::string_view owner,
               std::int64_t from_id,
               std::int64_t to_id) const {
        for (const Statement& row : from_.database->prepare(table.select(owner), from_id)) {
            Row(table.name, row).set(owner, to_id).insert(out_);
        }
    }

    [[nodiscard]] std::int64_t participant() const {
        return out_
            .first("SELECT participant_id FROM participant WHERE participant_code = ?1",
                   from_.participant)
            .integer(0);
    }

    [[nodiscard]] std::int64_t study() const {
        Row("study", from_.database->first("SELECT study_name, study_title, protocol_sha256, "
                                           "protocol_toml FROM study WHERE protocol_sha256 = ?1",
                                           from_.study))
            .insert(out_,
                    "ON CONFLICT (protocol_sha256) DO UPDATE SET (study_name, study_title, "
                    "protocol_toml) = (excluded.study_name, excluded.study_title, "
                    "excluded.protocol_toml)");
        return out_.first("SELECT study_id FROM study WHERE protocol_sha256 = ?1", from_.study)
            .integer(0);
    }

    [[nodiscard]] std::int64_t session_row() const {
        const std::int64_t of_study = study();
        return Row("session", from_.database->first(layout_.session.select("session_id"), from_.id))
            .set("study_id", of_study)
            .set("participant_id", participant())
            .set("session_number", from_.number)
            .insert(out_);
    }

    /// Insert of a whole trial, or an update of one that is there (not 0).
    [[nodiscard]] std::int64_t trial(const TrialVersion& one,
                                     std::int64_t session,
                                     std::int64_t there) const {
        OwnedTable whole = layout_.trial;
        whole.columns.emplace_back("invalid_reason");
        Row row("trial", from_.database->first(whole.select("trial_id"), one.id));
        std::int64_t id = there;
        if (there == 0) {
            id = row.set("session_id", session).insert(out_);
        } else {
            row.set("trial_id", there).update(out_, {"trial_id"});
        }
        for (const OwnedTable& table : layout_.of_trial) {
            if (there != 0) {
                out_.run(fmt::format("DELETE FROM {} WHERE trial_id = ?1", table.name), there);
            }
            owned(table, "trial_id", one.id, id);
        }
        return id;
    }

    void events(std::int64_t session, const Ids& trials, std::size_t already) const {
        for (const Statement& row : from_.database->prepare(
                 fmt::format("SELECT trial_id, {} FROM event WHERE session_id = ?1 ORDER BY "
                             "event_id LIMIT -1 OFFSET ?2",
                             layout_.event.list()),
                 from_.id, already)) {
            const auto at = std::ranges::find(from_.trials, row.integer(0), &TrialVersion::id);
            const bool of_trial = !row.null(0) && at != from_.trials.end();
            const auto place = static_cast<std::size_t>(at - from_.trials.begin());
            Row("event", row)
                .set("session_id", session)
                .set("trial_id", of_trial ? std::optional(trials.at(place)) : std::nullopt)
                .insert(out_);
        }
    }

    void end(std::int64_t session) const {
        OwnedTable at_end = layout_.session_end;
        at_end.columns.insert(at_end.columns.end(), layout_.session_repairs.columns.begin(),
                              layout_.session_repairs.columns.end());
        const std::string head = chain_head(*from_.database, from_.id);
        Row("session", from_.database->first(at_end.select("session_id"), from_.id))
            .set("session_id", session)
            .set("participant_id", participant())
            .set("newest_seal", head.empty() ? std::nullopt : std::optional(head))
            .update(out_, {"session_id"});
    }

    const SessionVersion& from_;
    Database& out_;
    const Layout& layout_;
};

}  // namespace

void add_session(const SessionVersion& from, Database& out, const Layout& layout) {
    Copy(from, out, layout).whole();
}

void extend_session(const SessionVersion& from,
                    const SessionVersion& own,
                    Database& out,
                    const Layout& layout) {
    Copy(from, out, layout).rest(own);
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
    for (const std::string& hex : texts(from.prepare("SELECT hex FROM secret"))) {
        out.run("INSERT OR IGNORE INTO secret (hex) VALUES (?1)", hex);
    }
}

void append_session(Database& from, Database& out, const Layout& layout) {
    const SessionVersion session = session_versions(from, layout, from.file(), false).at(0);
    participant_row(out, session.participant, own_secret(from));
    add_session(session, out, layout);
    copy_shared(from, out, from.file());
}

}  // namespace palpate::data
