#include "data/sync/push.hpp"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "data/schema/catalogue.hpp"
#include "data/store/chain.hpp"
#include "data/store/written_rows.hpp"
#include "data/sync/postgres.hpp"
#include "data/sync/session_version.hpp"

namespace palpate::data {
namespace {

class Push {
public:
    Push(Database& database, Postgres& server, PushChoice choice)
        : database_(database), server_(server), layout_(pushed_layout()), choice_(choice) {
        report_.way = server.way();
        for (PostgresTable& table : postgres_tables(layout_)) {
            sql_[table.name] = postgres_rows(table);
            tables_.push_back(std::move(table));
        }
    }

    PushReport run(const std::string& file) {
        require_trace_columns(database_, file);
        require_schema(server_, tables_);
        report_.rows += push_shared(database_, server_, sql_, report_.conflicts);
        push_people();
        for (const SessionVersion& session : session_versions(database_, layout_, file)) {
            ++report_.sessions;
            if (declined(session)) {
                continue;
            }
            if (!same_head(session) || !same_events(session) || destroyed_elsewhere(session)) {
                continue;
            }
            if (!chain_breaks(database_, session.id).empty()) {
                conflict(session,
                         "it is damaged or was changed since it was recorded; palpate verify says "
                         "where");
                continue;
            }
            report_.withdrawn += withdrawal(database_, session.id) ? 1U : 0U;
            push_head(session);
            push_trials(session);
            push_events(session);
            push_end(session);
        }
        return report_;
    }

private:
    void conflict(const SessionVersion& session, std::string_view what) {
        report_.conflicts.push_back(fmt::format("{}: {}", called(session), what));
    }

    /// Nothing of who does not consent goes on but which session it is, whichever file noted that
    /// they do not, this one or one before; what is there only an administrator can delete.
    [[nodiscard]] bool declined(const SessionVersion& session) {
        constexpr std::string_view kRefuses =
            "SELECT 1 FROM participant WHERE participant_code = ?1 AND consent = 0";
        const bool here = database_.prepare(kRefuses, session.participant).step();
        if (here || refusals_.hold(session.participant)) {
            send("participant_note", Refusals::note(session));
            flush();
        }
        if (choice_.including_refused || (!here && !refusals_.hold(session))) {
            return false;
        }
        ++report_.declined;
        if (!server_
                 .rows("SELECT 1 FROM palpate.session WHERE session_uuid = $1::uuid",
                       {session.uuid})
                 .empty()) {
            conflict(session,
                     "they do not consent, and the server has it: an administrator deletes the "
                     "rows of this session_uuid");
        } else if (!here) {
            conflict(session,
                     "they do not consent, says the server, and not this file: note it here, or "
                     "whose it really is, or an administrator deletes that note if it is wrong");
        }
        return true;
    }

    /// Something of theirs was destroyed in a file that was pushed, and this one may still have it.
    [[nodiscard]] bool forgets(const std::string& code) {
        constexpr std::string_view kKnows =
            "SELECT 1 FROM participant WHERE participant_code = ?1 AND destroyed_utc >= ?2";
        const std::string there = refusals_.destroyed(code);
        return !there.empty() && !database_.prepare(kKnows, code, there).step();
    }

    /// The score of whose session it is, or was, stands in its events.
    [[nodiscard]] bool destroyed_elsewhere(const SessionVersion& session) {
        for (const std::string& code : {session.participant, session.run_code}) {
            if (session.destructions == 0 && forgets(code)) {
                conflict(session,
                         fmt::format("what was noted of {} was destroyed, says the server, and not "
                                     "this file: palpate participant FILE {} --destroy details "
                                     "does it here, too",
                                     code, code));
                return true;
            }
        }
        return false;
    }

    void send(const std::string& table, const PostgresRow& row) {
        server_.send(sql_.at(table).insert, row);
    }

    /// One transaction.
    void flush() { report_.rows += server_.flush(); }

    /// Whether a score is of who refuses, or was destroyed: it is not sent, and named if it is
    /// there, or if this file does not know that it was.
    bool keeps_score(const Statement& note, bool is_there) {
        const bool here = note.integer(3) != 0;
        const bool refuses = here || refusals_.hold(note.text(0));
        const bool elsewhere = !note.null(2) && forgets(note.text(0));
        const bool destroyed = note.integer(4) != 0 || elsewhere;
        if (is_there && (destroyed || (refuses && !choice_.including_refused))) {
            report_.conflicts.push_back(
                fmt::format("participant {}: the server has their handedness, and {}: an "
                            "administrator deletes that row of participant_note",
                            note.text(0),
                            here      ? "they do not consent"
                            : refuses ? "they do not consent, says the server"
                                      : "it was destroyed"));
        } else if (elsewhere && !refuses) {
            report_.conflicts.push_back(fmt::format(
                "participant {0}: their handedness was destroyed, says the server, and not this "
                "file: palpate participant FILE {0} --destroy details does it here, too",
                note.text(0)));
        }
        return refuses || destroyed;
    }

    /// A refusal is sent whatever the server has; it stands there beside the yes before it.
    void push_people() {
        std::map<std::string, std::set<std::string>> there;
        for (const auto& row : server_.rows(
                 "SELECT participant_code || ' ' || key, value FROM palpate.participant_note")) {
            there[*row[0]].insert(*row[1]);
        }
        refusals_.read(server_);
        server_.send(std::string(kOneAtATime), {});
        Statement note = database_.prepare(
            "SELECT participant_code, 'handedness', CAST(handedness AS TEXT), consent IS 0, "
            "destroyed_utc IS NOT NULL AND handedness IS NULL FROM participant UNION ALL SELECT "
            "participant_code, 'consent', CAST(consent AS TEXT), 0, 0 FROM participant UNION ALL "
            "SELECT participant_code, 'destroyed', destroyed_utc, 0, 0 FROM participant WHERE "
            "consent IS NOT 0");
        while (note.step()) {
            const auto& found = there[note.text(0) + ' ' + note.text(1)];
            if (note.text(1) == "handedness" && keeps_score(note, !found.empty())) {
                continue;
            }
            if (note.null(2)) {
                continue;
            }
            const bool stands = note.text(1) == "destroyed" ||  // beside what was before
                                (note.text(1) == "consent" && note.text(2) == "0");
            if (!stands && !found.empty() && found != std::set{note.text(2)}) {
                report_.conflicts.push_back(
                    fmt::format("participant {}: {} is {} here and {} on the server, where an "
                                "administrator deletes the row if it is wrong",
                                note.text(0), note.text(1), note.text(2), *found.begin()));
                continue;
            }
            send("participant_note", {note.text(0), note.text(1), note.text(2)});
        }
        flush();
    }

    /// Compares how the session began, if it is there. @return nothing in conflict
    bool same_head(const SessionVersion& session) {
        const auto there = server_.rows(
            "SELECT began_sha256, file_schema FROM palpate.session WHERE session_uuid = $1::uuid",
            {session.uuid});
        if (there.empty()) {
            return !under_another_uuid(session);
        }
        if (*there[0][0] != session.head && same_schema(*there[0][1])) {
            conflict(session, "it began otherwise on the server");
            return false;
        }
        begun_.insert(session.uuid);
        return true;
    }

    /// Whose a session on the server is, its last event of that says. One that the file has too, as
    /// another's or of another number, is another one.
    bool under_another_uuid(const SessionVersion& session) {
        for (const auto& row : server_.rows(
                 "SELECT session_uuid FROM palpate.session LEFT JOIN LATERAL (SELECT value, count "
                 "FROM palpate.event WHERE event.session_uuid = session.session_uuid AND key = $4 "
                 "ORDER BY event_number DESC LIMIT 1) AS moved ON true WHERE protocol_sha256 = $1 "
                 "AND coalesce(moved.value, participant_code) = $2 AND coalesce(moved.count, "
                 "session_number) = $3",
                 {session.study, session.participant, session.number, std::string(kIsReally)})) {
            if (!database_.prepare("SELECT 1 FROM session WHERE uuid = ?1", *row[0]).step()) {
                conflict(session, "the server has it under the uuid " + *row[0]);
                return true;
            }
        }
        return false;
    }

    /// How many rows the server has of a session, by table and `place`: a trial's number, or 0.
    using Counts = std::map<std::pair<std::string, std::int64_t>, std::int64_t>;
    Counts counts(const SessionVersion& session,
                  const std::vector<OwnedTable>& tables,
                  const char* place) {
        std::string sql;
        for (const OwnedTable& table : tables) {
            sql += fmt::format(
                "{}SELECT '{}', {}, count(*) FROM palpate.{} WHERE session_uuid = $1::uuid GROUP "
                "BY 2",
                sql.empty() ? "" : " UNION ALL ", table.name, place, quoted_name(table.name));
        }
        Counts there;
        for (const auto& row : server_.rows(sql, {session.uuid})) {
            there[{*row[0], std::stoll(*row[1])}] = std::stoll(*row[2]);
        }
        return there;
    }

    /// The session as it began, as far as it is not there.
    void push_head(const SessionVersion& session) {
        const Counts there = counts(session, layout_.of_session, "0");
        if (!begun_.contains(session.uuid)) {
            push_session(session);
        }
        for (const OwnedTable& table : layout_.of_session) {
            push_owned(table, "session_id", session.id, {session.uuid}, there, 0);
        }
        flush();
    }

    void push_session(const SessionVersion& session) {
        Statement line = database_.first(layout_.session.select("session_id"), session.id);
        PostgresRow row = with_row({session.uuid}, line);
        row.insert(row.end(), {session.study, session.run_code, session.run_number, session.head,
                               kSchemaVersion});
        send("session", row);
    }

    static bool same_schema(const std::string& there) {
        return there == fmt::format("{}", kSchemaVersion);
    }

    /// All rows of an owner, if the server lacks any.
    void push_owned(const OwnedTable& table,
                    std::string_view owner,
                    std::int64_t id,
                    const PostgresRow& key,
                    const Counts& there,
                    std::int64_t place) {
        const auto found = there.find({table.name, place});
        const std::string rows =
            fmt::format("SELECT count(*) FROM {} WHERE {} = ?1", table.name, owner);
        if (found != there.end() && found->second >= database_.first(rows, id).integer(0)) {
            return;
        }
        for (const Statement& line : database_.prepare(table.select(owner), id)) {
            send(table.name, with_row(key, line));
        }
    }

    void push_trials(const SessionVersion& session) {
        std::map<std::string, std::pair<std::string, std::string>> there;
        for (const auto& row : server_.rows("SELECT trial_number, content, file_schema FROM "
                                            "palpate.trial WHERE session_uuid = $1::uuid",
                                            {session.uuid})) {
            there[*row[0]] = {*row[1], *row[2]};
        }
        const Counts rows = counts(session, layout_.of_trial, "trial_number");
        std::int64_t number = 0;
        for (const TrialVersion& trial : session.trials) {
            const auto found = there.find(fmt::format("{}", ++number));
            if (trial.outcome == "running") {
                continue;  // it comes when it has ended
            }
            const bool is_there = found != there.end();
            if (is_there && found->second.first != trial.content &&
                same_schema(found->second.second)) {
                conflict(session, fmt::format("attempt {} is another on the server", number));
                continue;
            }
            const PostgresRow key{session.uuid, number};
            for (const OwnedTable& table : layout_.of_trial) {
                push_owned(table, "trial_id", trial.id, key, rows, number);
            }
            if (!is_there) {
                push_trial(trial, key);
            }
            if (!trial.invalid.empty()) {
                send("trial_invalid", {session.uuid, number, trial.invalid});
            }
            flush();
        }
    }

    void push_trial(const TrialVersion& trial, const PostgresRow& key) {
        Statement line = database_.first(layout_.trial.select("trial_id"), trial.id);
        PostgresRow row = with_row(key, line);
        row.insert(row.end(), {trial.content, kSchemaVersion});
        send("trial", row);
    }

    /// Compares the events that are there. @return nothing in conflict
    bool same_events(const SessionVersion& session) {
        const auto there = server_.rows(
            "SELECT event_number, content FROM palpate.event WHERE session_uuid = $1::uuid",
            {session.uuid});
        for (const auto& row : there) {
            const auto number = static_cast<std::size_t>(std::stoull(*row[0]));
            if (number <= session.events.size() && session.events[number - 1] != *row[1]) {
                conflict(session, fmt::format("event {} is another on the server", number));
                return false;
            }
        }
        return true;
    }

    void push_events(const SessionVersion& session) {
        Statement trial = database_.prepare(
            "SELECT event_id, trial_id FROM event WHERE session_id = ?1 ORDER BY event_id");
        Statement line = database_.prepare(layout_.event.select("event_id"));
        trial.bind(1, session.id);
        for (std::int64_t number = 1; trial.step(); ++number) {
            PostgresRow row{session.uuid, number};
            const std::int64_t place = place_of(session, trial.integer(1));
            row.push_back(trial.null(1) || place == 0 ? ColumnValue() : ColumnValue(place));
            line.bind(1, trial.integer(0)).step();
            row = with_row(std::move(row), line);
            row.emplace_back(session.events.at(static_cast<std::size_t>(number - 1)));
            send("event", row);
            line.reset();
        }
        flush();
    }

    static std::int64_t place_of(const SessionVersion& session, std::int64_t id) {
        const auto at = std::ranges::find(session.trials, id, &TrialVersion::id);
        return at == session.trials.end() ? 0 : at - session.trials.begin() + 1;
    }

    void push_end(const SessionVersion& session) {
        if (session.finished) {
            Statement line = database_.first(layout_.session_end.select("session_id"), session.id);
            send("session_end", with_row({session.uuid}, line));
            flush();
        }
    }

    Database& database_;
    Postgres& server_;
    Layout layout_;
    std::vector<PostgresTable> tables_;
    std::map<std::string, PostgresRows> sql_;
    PushChoice choice_;
    std::set<std::string> begun_;  ///< uuids of sessions that the server has
    Refusals refusals_;            ///< by the server's notes before
    PushReport report_;
};

}  // namespace

PushReport push_file(const std::string& file, const std::string& url, PushChoice choice) {
    Database database(file, Access::read);
    Postgres server(url, choice.insecure);
    const Snapshot now(database);
    return Push(database, server, choice).run(file);
}

std::string push_setup() {
    return "SET client_min_messages = warning;\n" +
           postgres_schema(postgres_tables(pushed_layout())) + postgres_roles();
}

}  // namespace palpate::data
