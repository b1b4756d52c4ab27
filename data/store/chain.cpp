#include "data/store/chain.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "protocols/design/sha256.hpp"
#include "data/store/people.hpp"

namespace palpate::data {
namespace {

constexpr std::string_view kNotOfSession[] = {"id",    "study",        "participant", "finished",
                                              "chain", "finished_utc", "chain_events"};
constexpr std::string_view kNotOfTrial[] = {"id", "session", "chain", "trial"};

/// "table;column:type:length:value;..." of the row that `row` is at.
std::string line_of(std::string_view table,
                    const Statement& row,
                    std::span<const std::string_view> without) {
    std::string text(table);
    for (int i = 0; i < row.columns(); ++i) {
        if (row.null(i) || std::ranges::find(without, row.name(i)) != without.end()) {
            continue;
        }
        const std::string value = row.type(i) == 2 ? fmt::format("{}", row.real(i))
                                : row.type(i) == 4 ? protocols::sha256_hex(row.blob(i))
                                                   : row.text(i);
        text += fmt::format(";{}:{}:{}:{}", row.name(i), row.type(i), value.size(), value);
    }
    return text + '\n';
}

std::string lines_of(Database& database,
                     std::string_view table,
                     const std::string& sql,
                     std::int64_t id,
                     std::span<const std::string_view> without) {
    std::string text;
    Statement row = database.prepare(sql);
    row.bind(1, id);
    while (row.step()) {
        text += line_of(table, row, without);
    }
    return text;
}

std::string first_head(Database& database, std::int64_t session) {
    std::string text = lines_of(
        database, "session",
        "SELECT session.*, protocol_sha256, code FROM session JOIN study ON study.id = study"
        " JOIN participant ON participant.id = participant WHERE session.id = ?1",
        session, kNotOfSession);
    for (const char* table : {"session_provenance", "plan", "picture", "adaptive_plan"}) {
        text += lines_of(database, table,
                         fmt::format("SELECT * FROM {} WHERE session = ?1 ORDER BY 1, 2", table),
                         session, kNotOfTrial);
    }
    return protocols::sha256_hex(text);
}

/// Tables with rows of trials, but for events.
std::vector<std::string> tables_of_trials(Database& database) {
    std::vector<std::string> names;
    Statement row = database.prepare(
        "SELECT s.name FROM sqlite_schema AS s, pragma_table_info(s.name) AS c WHERE s.type = "
        "'table'"
        " AND c.name = 'trial' AND s.name <> 'event' ORDER BY s.name");
    while (row.step()) {
        names.push_back(row.text(0));
    }
    return names;
}

/// The session's events from the first to the last of these numbers, by their order.
std::string events_between(Database& database,
                           std::int64_t session,
                           std::int64_t before,
                           std::int64_t last) {
    Statement row = database.prepare(
        "SELECT event.*, position, attempt FROM event LEFT JOIN trial ON trial.id = trial"
        " WHERE event.session = ?1 ORDER BY event.id LIMIT ?3 OFFSET ?2");
    row.bind(1, session).bind(2, before).bind(3, std::max<std::int64_t>(0, last - before));
    std::string text;
    while (row.step()) {
        text += line_of("event", row, kNotOfTrial);
    }
    return text;
}

std::int64_t events_now(Database& database, std::int64_t session) {
    Statement row = database.prepare("SELECT count(*) FROM event WHERE session = ?1");
    row.bind(1, session).step();
    return row.integer(0);
}

struct Link {
    std::string head;
    std::int64_t events = 0;  ///< of the session that it covers
};

/// The link of a trial whose row says how many events it covers.
std::string trial_head(Database& database,
                       std::int64_t session,
                       std::int64_t trial,
                       const Link& before,
                       std::int64_t events) {
    std::string text = before.head + '\n';
    // A mark came later: at the end of the trial its answer counted.
    const bool marked = find_mark(database, trial).has_value();
    std::vector<std::string_view> without(std::begin(kNotOfTrial), std::end(kNotOfTrial));
    if (marked) {
        without.emplace_back("invalid");
    }
    text += lines_of(database, "trial", "SELECT * FROM trial WHERE id = ?1", trial, without);
    for (const std::string& table : tables_of_trials(database)) {
        text += lines_of(database, table,
                         fmt::format("SELECT * FROM {} WHERE trial = ?1 ORDER BY 1, 2, 3", table),
                         trial, kNotOfTrial);
    }
    return protocols::sha256_hex(text + events_between(database, session, before.events, events));
}

std::string session_head(Database& database,
                         std::int64_t session,
                         const Link& before,
                         std::int64_t events) {
    const std::string text =
        before.head + '\n' +
        lines_of(database, "session",
                 "SELECT finished, finished_utc, chain_events FROM session WHERE id = ?1", session,
                 {});
    return protocols::sha256_hex(text + events_between(database, session, before.events, events));
}

Link last_link(Database& database, std::int64_t session) {
    Statement row = database.prepare(
        "SELECT chain, chain_events FROM trial WHERE session = ?1 AND chain IS NOT NULL"
        " ORDER BY id DESC LIMIT 1");
    row.bind(1, session);
    if (row.step()) {
        return {.head = row.text(0), .events = row.integer(1)};
    }
    return {.head = first_head(database, session)};
}

}  // namespace

void chain_trial(Database& database, std::int64_t trial) {
    Statement whose = database.prepare("SELECT session FROM trial WHERE id = ?1");
    whose.bind(1, trial).step();
    const std::int64_t session = whose.integer(0);
    whose.reset();
    const Link before = last_link(database, session);
    const std::int64_t events = events_now(database, session);
    database.prepare("UPDATE trial SET chain_events = ?2 WHERE id = ?1")
        .bind(1, trial)
        .bind(2, events)
        .run();
    database.prepare("UPDATE trial SET chain = ?2 WHERE id = ?1")
        .bind(1, trial)
        .bind(2, trial_head(database, session, trial, before, events))
        .run();
}

void chain_session(Database& database, std::int64_t session) {
    const Link before = last_link(database, session);
    const std::int64_t events = events_now(database, session);
    database.prepare("UPDATE session SET chain_events = ?2 WHERE id = ?1")
        .bind(1, session)
        .bind(2, events)
        .run();
    database.prepare("UPDATE session SET chain = ?2 WHERE id = ?1")
        .bind(1, session)
        .bind(2, session_head(database, session, before, events))
        .run();
}

std::string chain_head(Database& database, std::int64_t session) {
    Statement row = database.prepare(
        "SELECT coalesce(chain, (SELECT chain FROM trial WHERE session = ?1 AND chain IS NOT NULL"
        " ORDER BY id DESC LIMIT 1), '') FROM session WHERE id = ?1");
    row.bind(1, session);
    return row.step() ? row.text(0) : std::string();
}

std::vector<ChainBreak> chain_breaks(Database& database, std::int64_t session) {
    std::vector<ChainBreak> breaks;
    Link link{.head = first_head(database, session)};
    Statement row = database.prepare(
        "SELECT id, chain, chain_events, outcome FROM trial WHERE session = ?1 ORDER BY id");
    row.bind(1, session);
    while (row.step()) {
        const std::int64_t trial = row.integer(0);
        if (row.null(1)) {
            if (row.text(3) != "running") {
                breaks.push_back({trial, "NULL", "the head after this trial"});
            }
            continue;
        }
        const std::string head = trial_head(database, session, trial, link, row.integer(2));
        if (head != row.text(1)) {
            breaks.push_back({trial, row.text(1), head});
        }
        link = {.head = row.text(1), .events = row.integer(2)};
    }
    Statement end =
        database.prepare("SELECT chain, chain_events, finished FROM session WHERE id = ?1");
    end.bind(1, session);
    if (end.step() && !end.null(0)) {
        const std::string head = session_head(database, session, link, end.integer(1));
        if (head != end.text(0)) {
            breaks.push_back({0, end.text(0), head});
        }
    } else if (end.integer(2) != 0) {
        breaks.push_back({0, "NULL", "the head after the last trial"});
    }
    return breaks;
}

}  // namespace palpate::data
