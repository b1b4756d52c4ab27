#include "data/store/chain.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/sha256.hpp"
#include "protocols/session/progress.hpp"
#include "data/schema/catalogue.hpp"
#include "data/store/row.hpp"

namespace palpate::data {
namespace {

constexpr std::string_view kNotOfSession[] = {
    "session_id",  "study_id",    "participant_id", "finished", "seal",       "finished_utc",
    "seal_events", "newest_seal", "session_number", "run_code", "run_number", "withdrawn_reason"};
constexpr std::string_view kNotOfTrial[] = {"event_id", "session_id", "seal", "trial_id"};

/// "table;column:type:length:value;..." of each row.
std::string lines_of(Database& database,
                     std::string_view table,
                     const std::string& sql,
                     std::int64_t id,
                     std::span<const std::string_view> without) {
    std::string text;
    for (const Statement& row : database.prepare(sql, id)) {
        text += table;
        for (int i = 0; i < row.columns(); ++i) {
            if (row.null(i) || std::ranges::find(without, row.name(i)) != without.end()) {
                continue;
            }
            const std::string value = row.type(i) == 2 ? fmt::format("{}", row.real(i))
                                    : row.type(i) == 4 ? sha256_hex(row.blob(i))
                                                       : row.text(i);
            text += fmt::format(";{}:{}:{}:{}", row.name(i), row.type(i), value.size(), value);
        }
        text += '\n';
    }
    return text;
}

std::string first_head(Database& database, std::int64_t session) {
    std::string text = lines_of(
        database, "session",
        "SELECT session.*, protocol_sha256, coalesce(run_code, participant_code) AS run_as, "
        "coalesce(run_number, session_number) AS run_as_number FROM session JOIN study USING "
        "(study_id) JOIN participant USING (participant_id) WHERE session.session_id = ?1",
        session, kNotOfSession);
    for (const char* table : {"session_provenance", "plan", "picture", "adaptive_plan"}) {
        text += lines_of(database, table,
                         fmt::format("SELECT * FROM {} WHERE session_id = ?1 ORDER BY 1, 2", table),
                         session, kNotOfTrial);
    }
    return sha256_hex(text);
}

/// Tables with rows of trials, but for events: those of the catalogue, whatever else somebody
/// added.
const std::vector<std::string>& tables_of_trials() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all = tables_with("trial_id");
        std::erase_if(all, [](const auto& name) { return name == "event" || name == "trial"; });
        std::ranges::sort(all);
        return all;
    }();
    return names;
}

/// The link of a trial whose row says how many events came before.
std::string trial_head(Database& database, std::int64_t trial, const std::string& before) {
    std::string text = before + '\n';
    std::vector<std::string_view> without(std::begin(kNotOfTrial), std::end(kNotOfTrial));
    if (mark_reason(database, trial)) {  // later: at the end of the trial its answer counted
        without.emplace_back("invalid_reason");
    }
    text += lines_of(database, "trial", "SELECT * FROM trial WHERE trial_id = ?1", trial, without);
    for (const std::string& table : tables_of_trials()) {
        text +=
            lines_of(database, table,
                     fmt::format("SELECT * FROM {} WHERE trial_id = ?1 ORDER BY 1, 2, 3", table),
                     trial, kNotOfTrial);
    }
    return sha256_hex(text);
}

std::string event_head(Database& database, std::int64_t event, const std::string& before) {
    return sha256_hex(before + '\n' +
                      lines_of(database, "event",
                               "SELECT event.*, trial.plan_position AS at_position, attempt FROM "
                               "event LEFT JOIN trial USING (trial_id) WHERE event.event_id = ?1",
                               event, kNotOfTrial));
}

std::string session_head(Database& database, std::int64_t session, const std::string& before) {
    return sha256_hex(
        before + '\n' +
        lines_of(database, "session",
                 "SELECT finished, finished_utc, seal_events FROM session WHERE session_id = ?1",
                 session, {}));
}

/// The reason of the last mark of a trial or a session; none where that takes one back.
std::optional<std::string> last_mark(Database& database, std::string_view whose, std::int64_t id) {
    Statement row =
        database.prepare(fmt::format("SELECT text, key FROM event WHERE {} AND event_kind = 'mark' "
                                     "ORDER BY event_id DESC LIMIT 1",
                                     whose),
                         id);
    const bool marked = row.step() && row.text(1) != protocols::kUndone;
    return marked ? std::optional(row.text(0)) : std::nullopt;
}

/// What the next link begins with.
std::string head_now(Database& database, std::int64_t session) {
    const std::string head = chain_head(database, session);
    return head.empty() ? first_head(database, session) : head;
}

/// A row of `table` has a new head, and the session with it.
void keep_head(Database& database,
               std::string_view table,
               std::int64_t row,
               std::int64_t session,
               const std::string& head) {
    database.run(fmt::format("UPDATE {0} SET seal = ?2 WHERE {0}_id = ?1", table), row, head);
    database.run("UPDATE session SET newest_seal = ?2 WHERE session_id = ?1", session, head);
}

void keep_events(Database& database,
                 std::string_view table,
                 std::int64_t row,
                 std::int64_t session) {
    database.run(fmt::format("UPDATE {0} SET seal_events = (SELECT count(*) FROM event WHERE "
                             "session_id = ?2) WHERE {0}_id = ?1",
                             table),
                 row, session);
}

/// Follows the links of a session in their order, and notes where one does not follow, or makes all
/// anew.
class ChainWalk {
public:
    ChainWalk(Database& database, std::int64_t session, bool anew)
        : database_(database),
          session_(session),
          anew_(anew),
          head_(first_head(database, session)),
          breaks_(study_breaks(
              database,
              database.first("SELECT study_id FROM session WHERE session_id = ?1", session)
                  .integer(0))),
          events_(database.prepare("SELECT event.event_id, seal, event_kind, coalesce(trial_id, 0) "
                                   "FROM event WHERE session_id = ?1 ORDER BY event_id")) {
        events_.bind(1, session);
    }

    std::vector<ChainBreak> all() {
        for (const Statement& trial :
             database_.prepare("SELECT trial_id, seal, seal_events, outcome, invalid_reason FROM "
                               "trial WHERE session_id = ?1 ORDER BY trial_id",
                               session_)) {
            const std::int64_t id = trial.integer(0);
            check_mark(id, trial.text(4));
            if (trial.null(1)) {
                if (trial.text(3) != "running") {
                    breaks_.push_back({id, "trial.seal", "NULL", "the head after this trial"});
                }
                continue;
            }
            events_until(trial.integer(2));
            link("trial", id, {id, "trial.seal", trial.text(1), trial_head(database_, id, head_)});
        }
        check_session();
        return std::move(breaks_);
    }

private:
    void check_session() {
        Statement end = database_.first(
            "SELECT seal, seal_events, finished, newest_seal FROM session WHERE session_id = ?1",
            session_);
        if (!end.null(0)) {
            events_until(end.integer(1));
            link("session", session_,
                 {0, "session.seal", end.text(0), session_head(database_, session_, head_)});
        } else if (end.integer(2) != 0) {
            breaks_.push_back({0, "session.seal", "NULL", "the head after the last trial"});
        }
        events_until(std::nullopt);
        check_repairs();
        if (links_ > 0 ? end.text(3) != head_ : !end.null(3)) {
            breaks_.push_back({0, "session.newest_seal", end.null(3) ? "NULL" : end.text(3),
                               links_ > 0 ? head_ : "NULL"});
        }
    }

    void link(std::string_view table, std::int64_t row, const ChainBreak& at) {
        if (anew_) {
            keep_head(database_, table, row, session_, at.recomputed);
        } else if (at.stored != at.recomputed) {
            breaks_.push_back(at);
        }
        head_ = anew_ ? at.recomputed : at.stored;
        ++links_;
    }

    /// Those before the link that counted so many; none: all that are left.
    void events_until(std::optional<std::int64_t> count) {
        while ((!count || seen_ < *count) && events_.step()) {
            ++seen_;
            const std::string what = fmt::format("event.seal ({} {})", events_.text(2), seen_);
            link("event", events_.integer(0),
                 {events_.integer(3), what, events_.null(1) ? "NULL" : events_.text(1),
                  event_head(database_, events_.integer(0), head_)});
        }
    }

    void check_mark(std::int64_t trial, const std::string& invalid) {
        const auto mark = mark_reason(database_, trial);
        if (mark && *mark != invalid) {
            breaks_.push_back({trial, "trial.invalid_reason", invalid.empty() ? "NULL" : invalid,
                               *mark + ", as its mark says"});
        }
    }

    /// Whose session it is and whether analyses leave it out, against the events that say so.
    void check_repairs() {
        Statement row = database_.first(
            "SELECT participant_code, session_number, run_code IS NULL AND run_number IS NULL, "
            "coalesce(withdrawn_reason, 'NULL') FROM session JOIN participant USING "
            "(participant_id) WHERE session_id = ?1",
            session_);
        Statement moved = database_.prepare(
            "SELECT value, count FROM event WHERE session_id = ?1 AND event_kind = 'participant' "
            "AND key = ?2 ORDER BY event_id DESC LIMIT 1",
            session_, kIsReally);
        const bool said = moved.step();
        if (said ? moved.text(0) != row.text(0) || moved.integer(1) != row.integer(1)
                 : row.integer(2) == 0) {
            breaks_.push_back(
                {0, "session.participant_id", fmt::format("{} {}", row.text(0), row.integer(1)),
                 said ? fmt::format("{} {}, as an event says", moved.text(0), moved.integer(1))
                      : "as it was run: no event says otherwise"});
        }
        const std::string withdrawn = withdrawal(database_, session_).value_or("NULL");
        if (withdrawn != row.text(3)) {
            breaks_.push_back(
                {0, "session.withdrawn_reason", row.text(3), withdrawn + ", as its events say"});
        }
    }

    Database& database_;
    std::int64_t session_;
    bool anew_;
    std::string head_;
    std::vector<ChainBreak> breaks_;
    Statement events_;
    std::int64_t seen_ = 0;
    std::size_t links_ = 0;
};

}  // namespace

void chain_trial(Database& database, std::int64_t trial) {
    const std::int64_t session =
        database.first("SELECT session_id FROM trial WHERE trial_id = ?1", trial).integer(0);
    keep_events(database, "trial", trial, session);
    keep_head(database, "trial", trial, session,
              trial_head(database, trial, head_now(database, session)));
}

void chain_session(Database& database, std::int64_t session) {
    keep_events(database, "session", session, session);
    keep_head(database, "session", session, session,
              session_head(database, session, head_now(database, session)));
}

std::string add_event(Database& database,
                      std::int64_t session,
                      const protocols::Event& event,
                      std::string_view operator_name,
                      std::string_view noted_utc) {
    const std::string before = head_now(database, session);
    const auto said = [](std::string_view text) {
        return text.empty() ? std::nullopt : std::optional(text);
    };
    const std::int64_t id =
        Row("event")
            .set("session_id", session)
            .set("trial_id", event.trial)
            .set("event_kind", to_string(event.kind))
            .set("text", event.text)
            .set("at_utc", database.utc_now(event.when_ns))
            .set("at_ns", database.steady_now(event.when_ns))
            .set("operator", said(operator_name))
            .set("trials_begun",
                 database.first("SELECT count(*) FROM trial WHERE session_id = ?1", session)
                     .integer(0))
            .set("plan_position", event.position)
            .set("part", event.part)
            .set("count", event.count)
            .set("duration_s", event.duration_s)
            .set("key", said(event.key))
            .set("value", said(event.value))
            .set("noted_utc", said(noted_utc))
            .insert(database);
    std::string head = event_head(database, id, before);
    keep_head(database, "event", id, session, head);
    return head;
}

std::string add_mark(
    Database& database, std::int64_t session, std::int64_t trial, const Reason& why, bool undone) {
    database.run("UPDATE trial SET invalid_reason = ?2 WHERE trial_id = ?1", trial,
                 undone ? std::nullopt : std::optional(why.text));
    return add_event(database, session,
                     {.kind = protocols::EventKind::mark,
                      .text = std::string(why.text),
                      .trial = trial,
                      .key = std::string(undone ? protocols::kUndone : "")},
                     why.operator_name);
}

std::optional<std::string> mark_reason(Database& database, std::int64_t trial) {
    return last_mark(database, "trial_id = ?1", trial);
}

std::optional<std::string> withdrawal(Database& database, std::int64_t session) {
    return last_mark(database, "session_id = ?1 AND trial_id IS NULL", session);
}

void chain_anew(Database& database, std::int64_t session) {
    (void)ChainWalk(database, session, true).all();
}

std::string chain_head(Database& database, std::int64_t session) {
    Statement row = database.prepare(
        "SELECT coalesce(newest_seal, '') FROM session WHERE session_id = ?1", session);
    return row.step() ? row.text(0) : std::string();
}

std::vector<ChainBreak> chain_breaks(Database& database, std::int64_t session) {
    return ChainWalk(database, session, false).all();
}

std::string kept_head(Database& database, std::int64_t session, std::size_t breaks) {
    std::string head = chain_head(database, session);
    if (database.in_memory()) {
        return head;
    }
    std::string why = "the session is another one there";
    try {
        Database anew(database.file(), Access::read);
        if (chain_head(anew, session) == head && chain_breaks(anew, session).size() <= breaks) {
            return head;
        }
    } catch (const StoreError& e) {
        why = e.what();
        refuse_if<StoreError>(why.find("unable to open") != std::string::npos,
                              "{}: what was recorded could not be looked at again ({}): palpate "
                              "verify says whether it is there",
                              database.file(), why);
    }
    throw StoreError(fmt::format(
        "{}: something wrote over it while it was in use ({}): what was recorded may not be there; "
        "palpate verify says what is",
        database.file(), why));
}

}  // namespace palpate::data
